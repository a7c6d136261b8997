//! Requests and responses of HTTP, only as far as a page and its socket need them: one per connection.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use tungstenite::http::StatusCode;

use crate::link::is_timeout;

/// Longest head of a request in bytes: much longer than that of a browser.
const LONGEST: usize = 16_384;
/// Largest number of header lines.
const HEADERS: usize = 100;
/// Longest time that a request or its answer may take.
pub const TIMEOUT: Duration = Duration::from_secs(5);
/// Longest time between two checks whether the server ends.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// The head of a request.
#[derive(Debug)]
pub struct Head {
    /// Its method.
    pub method: String,
    target: String,
    headers: Vec<(String, String)>,
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
        let cut_off = || HttpResponse::refusal(400, "the request ends in its head".to_owned());
        stream.set_read_timeout(Some(POLL_INTERVAL)).map_err(|_| cut_off())?;
        loop {
            if let Some(head) = Self::parse(&bytes)? {
                return Ok(head);
            }
            if bytes.len() > LONGEST {
                let why = format!("the head of the request is longer than {LONGEST} bytes");
                return Err(HttpResponse::refusal(431, why));
            }
            if Instant::now() > end || over.load(Ordering::Relaxed) {
                let why = format!("the request has not ended within {} s", TIMEOUT.as_secs());
                return Err(HttpResponse::refusal(408, why));
            }
            match stream.read(&mut chunk) {
                Ok(0) => return Err(cut_off()),
                Ok(read) => bytes.extend_from_slice(&chunk[..read]),
                Err(error) if is_timeout(&error) => {}
                Err(_) => return Err(cut_off()),
            }
        }
    }

    /// The head at the beginning of these bytes; `None` if it is incomplete.
    fn parse(bytes: &[u8]) -> Result<Option<Self>, HttpResponse> {
        let mut headers = [httparse::EMPTY_HEADER; HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        let length = match request.parse(bytes) {
            Ok(httparse::Status::Complete(length)) => length,
            Ok(httparse::Status::Partial) => return Ok(None),
            Err(error) => {
                let status = if error == httparse::Error::TooManyHeaders { 431 } else { 400 };
                return Err(HttpResponse::refusal(
                    status,
                    format!("this is not a request: {error}"),
                ));
            }
        };
        let header = |header: &httparse::Header<'_>| {
            (header.name.to_ascii_lowercase(), String::from_utf8_lossy(header.value).into_owned())
        };
        Ok(Some(Self {
            method: request.method.unwrap_or_default().to_owned(),
            target: request.path.unwrap_or_default().to_owned(),
            headers: request.headers.iter().map(header).collect(),
            rest: bytes.get(length..).unwrap_or_default().to_vec(),
        }))
    }

    /// The path, without the query.
    pub fn path(&self) -> &str {
        self.target.split('?').next().unwrap_or_default()
    }

    /// The value of a query parameter.
    pub fn query(&self, name: &str) -> Option<&str> {
        let (_, query) = self.target.split_once('?')?;
        let mut each = query.split('&').filter_map(|pair| pair.split_once('='));
        each.find(|(given, _)| *given == name).map(|(_, value)| value)
    }

    /// A header by its name in small letters.
    ///
    /// # Errors
    /// The response if it occurs twice, because readers differ in whether the first or the last counts.
    pub fn header(&self, name: &str) -> Result<Option<&str>, HttpResponse> {
        let mut all = self.headers.iter().filter(|(given, _)| given == name);
        match (all.next(), all.next()) {
            (_, Some(_)) => {
                Err(HttpResponse::refusal(400, format!("the header {name} is there twice")))
            }
            (one, None) => Ok(one.map(|(_, value)| value.trim())),
        }
    }
}

/// An answer, after which the connection is closed.
#[derive(Debug)]
pub struct HttpResponse {
    status: u16,
    headers: Vec<String>,
    kind: &'static str,
    body: String,
}

impl HttpResponse {
    /// A refusal as text.
    pub fn refusal(status: u16, sentence: String) -> Self {
        let (headers, kind) = (Vec::new(), "text/plain; charset=utf-8");
        Self { status, headers, kind, body: sentence + "\n" }
    }

    /// A page that no other page may embed, and whose address is not sent as a referrer.
    pub fn page(page: &str) -> Self {
        let headers = ["Content-Security-Policy: frame-ancestors 'none'", "X-Frame-Options: DENY"];
        let (headers, kind) = (headers.map(str::to_owned).into(), "text/html; charset=utf-8");
        Self { status: 200, headers, kind, body: page.to_owned() }
    }

    /// An empty response.
    pub fn nothing() -> Self {
        let kind = "text/plain; charset=utf-8";
        Self { status: 204, headers: Vec::new(), kind, body: String::new() }
    }

    /// With one more header.
    pub fn with(mut self, header: &str) -> Self {
        self.headers.push(header.to_owned());
        self
    }

    /// Sends the response. If a client does not take it, it has gone.
    pub fn send(&self, stream: &TcpStream) {
        let Self { status, headers, kind, body } = self;
        let mut text = format!("HTTP/1.1 {status} {}\r\n", reason(*status));
        for header in headers {
            text += &format!("{header}\r\n");
        }
        text += &format!(
            "Content-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
             Referrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
            body.len()
        );
        text += body;
        let sent = write(stream, text.as_bytes());
        // Closing with bytes unread would reset the connection, and the answer with it.
        if sent.is_ok() && stream.shutdown(std::net::Shutdown::Write).is_ok() {
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

fn reason(status: u16) -> &'static str {
    let known = StatusCode::from_u16(status).ok().and_then(|status| status.canonical_reason());
    known.unwrap_or("Refused")
}
