//! Access to the page and to the wire.

use std::fmt;
use std::hint::black_box;
use std::net::SocketAddr;

use super::http::{HttpResponse, Request};
use super::refusal::PageRefusal;

/// Bytes of a token: 128 bits cannot be guessed.
const BYTES: usize = 16;

/// A secret of one run of the server.
#[derive(Clone)]
pub struct Token(String);

impl Token {
    /// A new token, from the system's random numbers.
    pub fn random() -> Result<Self, getrandom::Error> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes)?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// Whether it equals this token, in a time that does not depend on the number of equal bytes.
    pub fn is(&self, given: &str) -> bool {
        let (ours, given) = (self.0.as_bytes(), given.as_bytes());
        let differences = ours.iter().zip(given).fold(0, |all, (a, b)| black_box(all | (a ^ b)));
        differences == 0 && ours.len() == given.len()
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The requirements on a request.
pub struct Access {
    token: Token,
    /// The host names of this server.
    hosts: Vec<String>,
}

impl Access {
    /// The requirements of a server at this address.
    pub fn new(address: SocketAddr, token: Token) -> Self {
        let hosts = vec![address.to_string(), format!("localhost:{}", address.port())];
        Self { token, hosts }
    }

    /// Checks that the request names this machine by its own address: a foreign name may point here.
    pub fn check_host(&self, request: &Request<'_>) -> Result<(), HttpResponse> {
        let host = request.header("host")?.unwrap_or_default();
        if self.hosts.iter().any(|own| own.eq_ignore_ascii_case(host)) {
            return Ok(());
        }
        let (host, own) = (host.to_owned(), self.hosts[0].clone());
        Err(PageRefusal::Host { host, own }.into())
    }

    /// The origin of the requesting page, if it is a page: of this server, or from a file.
    ///
    /// # Errors
    /// The response to another page.
    pub fn origin<'r>(&self, request: &'r Request<'_>) -> Result<Option<&'r str>, HttpResponse> {
        let is_own = |origin: &str| {
            origin
                .strip_prefix("http://")
                .is_some_and(|host| self.hosts.iter().any(|own| own.eq_ignore_ascii_case(host)))
        };
        match request.header("origin")? {
            // The origin that browsers send for a page from a file.
            Some("null") => Ok(Some("null")),
            Some(origin) if is_own(origin) => Ok(Some(origin)),
            // A browser always sends the origin of a page that sends anything.
            None if request.path() != "/wire" => Ok(None),
            origin => {
                let origin = origin.unwrap_or("nobody").to_owned();
                Err(PageRefusal::Origin { origin }.into())
            }
        }
    }

    /// Checks that the client has sent the token.
    pub fn check_token(&self, request: &Request<'_>) -> Result<(), HttpResponse> {
        if request.query("token").is_some_and(|given| self.token.is(given)) {
            return Ok(());
        }
        Err(PageRefusal::Token.into())
    }
}
