//! Requests and responses of HTTP, only as far as a page and its socket need them: one per connection.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use tungstenite::Error;
use tungstenite::error::{CapacityError, ProtocolError};
use tungstenite::handshake::machine::TryParse;
use tungstenite::handshake::server::{Request, write_response};
use tungstenite::http::header::{HeaderName, HeaderValue};
use tungstenite::http::{Response, StatusCode, header};

use crate::link::is_timeout;

/// Longest head of a request in bytes: much longer than that of a browser.
const LONGEST: usize = 16_384;
/// Longest time that a request or its answer may take.
pub const TIMEOUT: Duration = Duration::from_secs(5);
/// Longest time between two checks whether the server ends.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// The head of a request.
#[derive(Debug)]
pub struct Head {
    /// The target and the headers.
    pub request: Request,
    /// Bytes received after the head.
    pub rest: Vec<u8>,
}

impl Head {
    /// Reads a head.
    ///
    /// # Errors
    /// The response to a malformed request.
    pub fn read(mut stream: &TcpStream, over: &AtomicBool) -> Result<Self, HttpResponse> {
        let (mut bytes, mut chunk) = (Vec::new(), [0; 4096]);
        let end = Instant::now() + TIMEOUT;
        let bad = |why: &str| HttpResponse::refusal(StatusCode::BAD_REQUEST, why.to_owned());
        let cut_off = || bad("the request ends in its head");
        stream.set_read_timeout(Some(POLL_INTERVAL)).map_err(|_| cut_off())?;
        loop {
            if let Some((length, request)) = Request::try_parse(&bytes).map_err(no_request)? {
                return Ok(Self { request, rest: bytes.split_off(length) });
            }
            if bytes.len() > LONGEST {
                let why = format!("the head of the request is longer than {LONGEST} bytes");
                return Err(HttpResponse::refusal(TOO_LONG, why));
            }
            if Instant::now() > end || over.load(Ordering::Relaxed) {
                let why = format!("the request has not ended within {} s", TIMEOUT.as_secs());
                return Err(HttpResponse::refusal(StatusCode::REQUEST_TIMEOUT, why));
            }
            match stream.read(&mut chunk) {
                Ok(0) => return Err(cut_off()),
                Ok(read) => bytes.extend_from_slice(&chunk[..read]),
                Err(error) if is_timeout(&error) => {}
                Err(_) => return Err(cut_off()),
            }
        }
    }

    /// The value of a query parameter.
    pub fn query(&self, name: &str) -> Option<&str> {
        let mut each =
            self.request.uri().query()?.split('&').filter_map(|pair| pair.split_once('='));
        each.find(|(given, _)| *given == name).map(|(_, value)| value)
    }

    /// A header.
    ///
    /// # Errors
    /// The response if it occurs twice, because readers differ in whether the first or the last counts.
    pub fn header(&self, name: HeaderName) -> Result<Option<&str>, HttpResponse> {
        let mut all = self.request.headers().get_all(&name).iter();
        match (all.next(), all.next()) {
            (_, Some(_)) => {
                let why = format!("the header {name} is there twice");
                Err(HttpResponse::refusal(StatusCode::BAD_REQUEST, why))
            }
            (one, None) => Ok(one.map(|value| value.to_str().unwrap_or_default().trim())),
        }
    }
}

const TOO_LONG: StatusCode = StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE;

/// The response to bytes that are not a request.
fn no_request(error: Error) -> HttpResponse {
    let why = format!("this is not a request: {error}");
    match error {
        Error::Protocol(ProtocolError::WrongHttpMethod) => {
            let why = "only GET is served here".to_owned();
            HttpResponse::refusal(StatusCode::METHOD_NOT_ALLOWED, why).with(header::ALLOW, "GET")
        }
        Error::Capacity(CapacityError::TooManyHeaders) => HttpResponse::refusal(TOO_LONG, why),
        _ => HttpResponse::refusal(StatusCode::BAD_REQUEST, why),
    }
}

/// An answer, after which the connection is closed.
#[derive(Debug)]
pub struct HttpResponse(Box<Response<String>>);

impl HttpResponse {
    /// A response that nothing keeps, and whose address is not sent as a referrer.
    pub fn new(status: StatusCode, kind: &'static str, body: String) -> Self {
        let length = body.len();
        let mut response = Response::new(body);
        *response.status_mut() = status;
        response.headers_mut().insert(header::CONTENT_LENGTH, length.into());
        Self(Box::new(response))
            .with(header::CONTENT_TYPE, kind)
            .with(header::CACHE_CONTROL, "no-store")
            .with(header::REFERRER_POLICY, "no-referrer")
            .with(header::X_CONTENT_TYPE_OPTIONS, "nosniff")
            .with(header::CONNECTION, "close")
    }

    /// A refusal as text.
    pub fn refusal(status: StatusCode, sentence: String) -> Self {
        Self::new(status, "text/plain; charset=utf-8", sentence + "\n")
    }

    /// A page that no other page may embed.
    pub fn page(page: &str) -> Self {
        Self::new(StatusCode::OK, "text/html; charset=utf-8", page.to_owned())
            .with(header::CONTENT_SECURITY_POLICY, "frame-ancestors 'none'")
            .with(header::X_FRAME_OPTIONS, "DENY")
    }

    /// With one more header.
    pub fn with(mut self, name: HeaderName, value: &'static str) -> Self {
        self.0.headers_mut().insert(name, HeaderValue::from_static(value));
        self
    }

    /// Sends the response. If a client does not take it, it has gone.
    pub fn send(&self, stream: &TcpStream) {
        let mut bytes = Vec::new();
        let written = write_response(&mut bytes, &self.0);
        bytes.extend_from_slice(self.0.body().as_bytes());
        // Closing with bytes unread would reset the connection, and the answer with it.
        if written.is_ok()
            && write(stream, &bytes).is_ok()
            && stream.shutdown(std::net::Shutdown::Write).is_ok()
        {
            drain(stream);
        }
    }
}

/// Writes all bytes within the time that an answer may take, also to a client that takes few at a time.
fn write(mut stream: &TcpStream, mut bytes: &[u8]) -> io::Result<()> {
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
