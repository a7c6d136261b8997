//! The wire of a page. What the board sends, and the state of the port, are the lines of one response that does
//! not end, each JSON: `{"page": ID}` first, `{"bytes": HEX}`, `{"port": "open"}`, `{"port": "lost", "why": ..}`,
//! and `{"end": WHY}` last. What the page sends are requests with that ID, unchanged.

use std::io::Read;
use std::net::TcpStream;
use std::sync::atomic::Ordering;
use std::sync::mpsc::TryRecvError;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::access::Token;
use super::http::{self, HttpResponse, Request};
use super::port::{News, Seat, Unsent};
use super::refusal::PageRefusal;
use super::shared::Shared;
use crate::link::is_timeout;

/// Longest time that bytes to a page wait.
const POLL_INTERVAL: Duration = Duration::from_millis(5);
/// Most bytes in a request: more than a page sends at a time.
const LONGEST: usize = 4096;
/// Time after which a second page is refused. During this time the first page may leave, for instance if it
/// is reloaded.
const QUEUE_TIMEOUT: Duration = Duration::from_millis(500);

/// Sends the bytes of a page to the board; waits as long as too many are waiting.
///
/// # Errors
/// The response if the request has too many bytes, or if the page has not the board.
pub(super) fn send(
    request: &mut Request<'_>,
    page: &str,
    shared: &Shared,
) -> Result<HttpResponse, HttpResponse> {
    let mut bytes = request.body(LONGEST)?;
    let end = Instant::now() + http::TIMEOUT;
    loop {
        bytes = match shared.seats.send(page, bytes) {
            Ok(()) => return Ok(HttpResponse::empty()),
            Err(Unsent::Full(bytes)) => bytes,
            Err(Unsent::NoPage) => return Err(PageRefusal::Gone.into()),
        };
        if Instant::now() > end || shared.over.load(Ordering::Relaxed) {
            return Err(PageRefusal::Gone.into());
        }
        thread::sleep(POLL_INTERVAL);
    }
}

/// Carries the wire to a page until the page or the server ends it.
///
/// # Errors
/// The response if another page has the board.
pub(super) fn carry(
    stream: &TcpStream,
    origin: Option<&str>,
    shared: &Shared,
) -> Result<(), HttpResponse> {
    let seat = seat(shared)?;
    let begun = HttpResponse::new("200 OK", "application/x-ndjson", String::new())
        .readable_by(origin)
        .begin(stream);
    if begun.is_err() || stream.set_read_timeout(Some(POLL_INTERVAL)).is_err() {
        return Ok(());
    }
    (shared.report)("a page is connected");
    let why = Page { stream, seat, shared }.carry();
    (shared.report)("the page is gone");
    // If it has gone by itself, nobody reads this.
    if why.is_some_and(|why| line(stream, &json!({ "end": why })).is_some()) {
        http::finish(stream);
    }
    Ok(())
}

/// Takes the port as soon as no other page has it.
fn seat(shared: &Shared) -> Result<Seat, HttpResponse> {
    let id = Token::random().map_err(|error| {
        HttpResponse::refusal("503 Service Unavailable", format!("no random numbers: {error}"))
    })?;
    let end = Instant::now() + QUEUE_TIMEOUT;
    loop {
        match shared.seats.take(&id) {
            Some(seat) => return Ok(seat),
            None if Instant::now() > end => return Err(PageRefusal::InUse.into()),
            None => thread::sleep(POLL_INTERVAL),
        }
    }
}

/// A page that has the port.
struct Page<'p> {
    stream: &'p TcpStream,
    seat: Seat,
    shared: &'p Shared,
}

impl Page<'_> {
    /// The reason for the end; none if the page has gone.
    fn carry(&mut self) -> Option<String> {
        self.tell(&json!({ "page": self.seat.id.to_string() }))?;
        loop {
            if self.shared.over.load(Ordering::Relaxed) {
                return Some("haptic serve was ended".to_owned());
            }
            match self.seat.news() {
                Ok(News::Bytes(bytes)) => self.tell(&json!({ "bytes": hex(&bytes) }))?,
                Ok(News::Open) => self.tell(&json!({ "port": "open" }))?,
                Ok(News::Lost(why)) => self.tell(&json!({ "port": "lost", "why": why }))?,
                Err(TryRecvError::Empty) => self.wait()?,
                Err(TryRecvError::Disconnected) => return Some(PageRefusal::TooSlow.to_string()),
            }
        }
    }

    /// Waits a little; none if the page closes its connection, on which it has nothing more to send.
    fn wait(&mut self) -> Option<()> {
        match self.stream.read(&mut [0; LONGEST]) {
            Ok(1..) => Some(()),
            Err(error) if is_timeout(&error) => Some(()),
            _ => None,
        }
    }

    fn tell(&self, news: &Value) -> Option<()> {
        line(self.stream, news)
    }
}

fn line(stream: &TcpStream, news: &Value) -> Option<()> {
    http::write(stream, format!("{news}\n").as_bytes()).ok()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
