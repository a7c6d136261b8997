//! Requests and responses of HTTP, only as far as a page and its wire need them: one per connection.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::link::is_timeout;

/// Longest head of a request in bytes: much longer than that of a browser.
const LONGEST: usize = 16_384;
/// Longest time that a request or its answer may take.
pub const TIMEOUT: Duration = Duration::from_secs(5);
/// Longest time between two checks whether the server ends.
const POLL_INTERVAL: Duration = Duration::from_millis(50);
/// The end of a head.
const END: &str = "\r\n\r\n";

/// A request.
#[derive(Debug)]
pub struct Request<'s> {
    stream: &'s TcpStream,
    over: &'s AtomicBool,
    /// When all of it must be there.
    end: Instant,
    /// The first line and the headers.
    head: String,
    /// Bytes received after the head.
    rest: Vec<u8>,
}

impl<'s> Request<'s> {
    /// Reads a request up to its body.
    ///
    /// # Errors
    /// The response to a malformed request.
    pub fn read(stream: &'s TcpStream, over: &'s AtomicBool) -> Result<Self, HttpResponse> {
        let (head, rest) = (String::new(), Vec::new());
        let mut request = Self { stream, over, end: Instant::now() + TIMEOUT, head, rest };
        let head_of = |bytes: &[u8]| bytes.windows(END.len()).position(|it| it == END.as_bytes());
        let length = loop {
            match head_of(&request.rest) {
                Some(length) => break length + END.len(),
                None if request.rest.len() > LONGEST => return Err(too_long()),
                None => request.receive()?,
            }
        };
        let body = request.rest.split_off(length);
        let head = std::mem::replace(&mut request.rest, body);
        let not_text = |_| bad("this is not a request: its head is not text");
        request.head = String::from_utf8(head).map_err(not_text)?;
        request.checked()
    }

    fn checked(self) -> Result<Self, HttpResponse> {
        let first: Vec<_> = self.head.lines().next().unwrap_or_default().split(' ').collect();
        let [_, target, version] = first[..] else {
            return Err(bad("this is not a request: its first line has no three words"));
        };
        if !target.starts_with('/') || !version.starts_with("HTTP/1.") {
            return Err(bad("this is not a request for a path by HTTP/1.1"));
        }
        let (method, is_wire) = (self.method(), self.path() == "/wire");
        let allowed = if is_wire { "POST" } else { "GET" };
        if method != allowed {
            let why = format!("only {allowed} is served here");
            let refusal = HttpResponse::refusal("405 Method Not Allowed", why);
            return Err(refusal.with("allow", allowed));
        }
        Ok(self)
    }

    /// Waits for more bytes.
    fn receive(&mut self) -> Result<(), HttpResponse> {
        let (mut stream, mut chunk) = (self.stream, [0; 4096]);
        let cut_off = |_| bad("the request is cut off");
        stream.set_read_timeout(Some(POLL_INTERVAL)).map_err(cut_off)?;
        while Instant::now() < self.end && !self.over.load(Ordering::Relaxed) {
            match stream.read(&mut chunk) {
                Ok(0) => return Err(bad("the request is cut off")),
                Ok(read) => {
                    self.rest.extend_from_slice(&chunk[..read]);
                    return Ok(());
                }
                Err(error) if is_timeout(&error) => {}
                Err(error) => return Err(cut_off(error)),
            }
        }
        let why = format!("the request has not ended within {} s", TIMEOUT.as_secs());
        Err(HttpResponse::refusal("408 Request Timeout", why))
    }

    /// The bytes of the body, at most so many.
    ///
    /// # Errors
    /// The response to a request whose body is longer, or incomplete.
    pub fn body(&mut self, longest: usize) -> Result<Vec<u8>, HttpResponse> {
        let stated = self.header("content-length")?.map(str::parse::<usize>);
        let Some(Ok(length)) = stated else {
            let why = "the request has no content-length".to_owned();
            return Err(HttpResponse::refusal("411 Length Required", why));
        };
        if length > longest {
            let why = format!("the request has {length} bytes, and at most {longest} are allowed");
            return Err(HttpResponse::refusal("413 Content Too Large", why));
        }
        while self.rest.len() < length {
            self.receive()?;
        }
        self.rest.truncate(length);
        Ok(std::mem::take(&mut self.rest))
    }

    fn method(&self) -> &str {
        self.head.split(' ').next().unwrap_or_default()
    }

    fn target(&self) -> (&str, &str) {
        let target = self.head.split(' ').nth(1).unwrap_or_default();
        target.split_once('?').unwrap_or((target, ""))
    }

    /// The path.
    pub fn path(&self) -> &str {
        self.target().0
    }

    /// The value of a query parameter.
    pub fn query(&self, name: &str) -> Option<&str> {
        let mut each = self.target().1.split('&').filter_map(|pair| pair.split_once('='));
        each.find(|(given, _)| *given == name).map(|(_, value)| value)
    }

    /// A header.
    ///
    /// # Errors
    /// The response if it occurs twice, because readers differ in whether the first or the last counts.
    pub fn header(&self, name: &str) -> Result<Option<&str>, HttpResponse> {
        let headers = self.head.lines().skip(1).filter_map(|line| line.split_once(':'));
        let mut all = headers.filter(|(given, _)| given.eq_ignore_ascii_case(name));
        match (all.next(), all.next()) {
            (_, Some(_)) => Err(bad(&format!("the header {name} is there twice"))),
            (one, None) => Ok(one.map(|(_, value)| value.trim())),
        }
    }
}

fn bad(why: &str) -> HttpResponse {
    HttpResponse::refusal("400 Bad Request", why.to_owned())
}

fn too_long() -> HttpResponse {
    let why = format!("the head of the request is longer than {LONGEST} bytes");
    HttpResponse::refusal("431 Request Header Fields Too Large", why)
}

/// A response, after which the connection is closed.
#[derive(Debug)]
pub struct HttpResponse {
    head: String,
    body: String,
}

impl HttpResponse {
    /// A response that nothing keeps, and whose address is not sent as a referrer. Its end is that of the
    /// connection.
    pub fn new(status: &str, kind: &str, body: String) -> Self {
        let head = format!("HTTP/1.1 {status}\r\n");
        Self { head, body }
            .with("content-type", kind)
            .with("cache-control", "no-store")
            .with("referrer-policy", "no-referrer")
            .with("x-content-type-options", "nosniff")
            .with("connection", "close")
    }

    /// A response without a body.
    pub fn empty() -> Self {
        Self::new("204 No Content", "text/plain", String::new())
    }

    /// A refusal as text.
    pub fn refusal(status: &str, sentence: String) -> Self {
        Self::new(status, "text/plain; charset=utf-8", sentence + "\n")
    }

    /// A page that no other page may embed.
    pub fn page(page: &str) -> Self {
        Self::new("200 OK", "text/html; charset=utf-8", page.to_owned())
            .with("content-security-policy", "frame-ancestors 'none'")
            .with("x-frame-options", "DENY")
    }

    /// With one more header.
    pub fn with(mut self, name: &str, value: &str) -> Self {
        self.head += &format!("{name}: {value}\r\n");
        self
    }

    /// Readable by a page of this origin, which has been checked.
    pub fn readable_by(self, origin: Option<&str>) -> Self {
        match origin {
            Some(origin) => self.with("access-control-allow-origin", origin),
            None => self,
        }
    }

    /// Sends the response and leaves the connection open for the rest of its body.
    ///
    /// # Errors
    /// If the client does not take it.
    pub fn begin(&self, stream: &TcpStream) -> io::Result<()> {
        write(stream, format!("{}\r\n{}", self.head, self.body).as_bytes())
    }

    /// Sends the response. If a client does not take it, it has gone.
    pub fn send(&self, stream: &TcpStream) {
        if self.begin(stream).is_ok() {
            finish(stream);
        }
    }
}

/// Ends a response. Closing with bytes unread would reset the connection, and the answer with it.
pub fn finish(stream: &TcpStream) {
    if stream.shutdown(std::net::Shutdown::Write).is_ok() {
        drain(stream);
    }
}

/// Writes all bytes within the time that an answer may take, also to a client that takes few at a time.
pub fn write(mut stream: &TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    let end = Instant::now() + TIMEOUT;
    while !bytes.is_empty() {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        stream.set_write_timeout(Some(left))?;
        match stream.write(bytes) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(written) => bytes = &bytes[written..],
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Reads the remaining bytes, for a while.
fn drain(mut stream: &TcpStream) {
    let (end, mut chunk) = (Instant::now() + 4 * POLL_INTERVAL, [0; 4096]);
    if stream.set_read_timeout(Some(POLL_INTERVAL)).is_err() {
        return;
    }
    while Instant::now() < end {
        match stream.read(&mut chunk) {
            Ok(1..) => {}
            Err(error) if is_timeout(&error) && error.kind() != ErrorKind::Interrupted => {}
            _ => return,
        }
    }
}
