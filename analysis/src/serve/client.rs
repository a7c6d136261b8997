//! The socket of a page: the wire's bytes, unchanged, in binary messages, and the state of the port in text
//! messages, as JSON: `{"port": "open"}`, and `{"port": "lost", "why": ..}`.

use std::net::TcpStream;
use std::sync::atomic::Ordering;
use std::sync::mpsc::TryRecvError;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::json;
use tungstenite::handshake::server::{Response, create_response, write_response};
use tungstenite::http::{StatusCode, header};
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Message, WebSocket};

use super::http::{Head, HttpResponse};
use super::port::{News, Seat};
use super::refusal::PageRefusal;
use super::shared::Shared;
use crate::link::is_timeout;

/// Longest time that bytes to a page wait.
const POLL_INTERVAL: Duration = Duration::from_millis(5);
/// Longest message of a page, in bytes: more than a page sends at a time.
const LONGEST: usize = 4096;
/// Largest number of bytes waiting in the socket of a page; with more, the page is too slow.
const WAITING: usize = 1 << 20;
/// Time after which a second page is refused. During this time the first page may leave, for instance if it
/// is reloaded.
const QUEUE_TIMEOUT: Duration = Duration::from_millis(500);
/// Time in which a refused page may confirm that the socket is closed.
const GOODBYE: Duration = Duration::from_secs(1);

/// Checks that the request is an upgrade to a WebSocket; returns the response.
pub fn check_upgrade(head: &Head) -> Result<Response, HttpResponse> {
    create_response(&head.request).map_err(|error| {
        let why = format!("/wire is a WebSocket: {error}");
        HttpResponse::refusal(StatusCode::UPGRADE_REQUIRED, why)
            .with(header::UPGRADE, "websocket")
            .with(header::SEC_WEBSOCKET_VERSION, "13")
    })
}

/// Carries the wire of a page until the page or the server ends it.
pub(super) fn carry(stream: &TcpStream, rest: Vec<u8>, accepted: &Response, shared: &Shared) {
    let is_open = write_response(stream, accepted).is_ok()
        && stream.set_read_timeout(Some(POLL_INTERVAL)).is_ok();
    if !is_open {
        return;
    }
    let config = WebSocketConfig::default()
        .max_message_size(Some(LONGEST))
        .max_frame_size(Some(LONGEST))
        .max_write_buffer_size(WAITING);
    let mut socket = WebSocket::from_partially_read(stream, rest, Role::Server, Some(config));
    let Some(seat) = seat(shared) else {
        return close(&mut socket, &PageRefusal::InUse.into());
    };
    (shared.report)("a page is connected");
    let end = Page { socket: &mut socket, seat, shared }.carry();
    (shared.report)("the page is gone");
    if let Some(frame) = end {
        close(&mut socket, &frame);
    }
}

/// Takes the port as soon as no other page has it.
fn seat(shared: &Shared) -> Option<Seat> {
    let end = Instant::now() + QUEUE_TIMEOUT;
    loop {
        let seat = shared.seats.take();
        if seat.is_some() || Instant::now() > end {
            return seat;
        }
        thread::sleep(POLL_INTERVAL);
    }
}

/// A page that has the port.
struct Page<'p, 's> {
    socket: &'p mut WebSocket<&'s TcpStream>,
    seat: Seat,
    shared: &'s Shared,
}

/// The reason for closing a page's socket.
type End = Option<CloseFrame>;

impl From<PageRefusal> for CloseFrame {
    fn from(refusal: PageRefusal) -> Self {
        Self { code: refusal.close_code().into(), reason: refusal.to_string().into() }
    }
}

fn frame(code: CloseCode, reason: &'static str) -> CloseFrame {
    CloseFrame { code, reason: reason.into() }
}

impl Page<'_, '_> {
    fn carry(&mut self) -> End {
        let mut waiting = None;
        loop {
            if self.shared.over.load(Ordering::Relaxed) {
                return Some(frame(CloseCode::Away, "haptic serve was ended"));
            }
            if let Err(end) = self.pass_news() {
                return end;
            }
            if let Some(bytes) = waiting.take() {
                waiting = self.seat.send(bytes).err();
            }
            if waiting.is_some() {
                // If a page sends more than the port takes, it is read at the port's rate.
                thread::sleep(POLL_INTERVAL);
                continue;
            }
            match self.socket.read() {
                Ok(Message::Binary(bytes)) => waiting = Some(bytes.to_vec()),
                Ok(Message::Text(_)) => {
                    let why = "the wire's bytes are binary messages";
                    return Some(frame(CloseCode::Unsupported, why));
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if is_timeout(&error) => {}
                Err(_) => return None,
            }
        }
    }

    /// Forwards new bytes of the port.
    fn pass_news(&mut self) -> Result<(), End> {
        let mut bytes = Vec::new();
        loop {
            let text = match self.seat.news() {
                Ok(News::Bytes(more)) => {
                    bytes.extend(more);
                    continue;
                }
                Ok(News::Open) => Some(json!({ "port": "open" })),
                Ok(News::Lost(why)) => Some(json!({ "port": "lost", "why": why })),
                Err(TryRecvError::Empty) => None,
                Err(TryRecvError::Disconnected) => {
                    return Err(Some(PageRefusal::TooSlow.into()));
                }
            };
            if !bytes.is_empty() {
                self.write(Message::binary(std::mem::take(&mut bytes)))?;
            }
            match text {
                Some(text) => self.write(Message::text(text.to_string()))?,
                None => break,
            }
        }
        self.socket.flush().map_err(|_| None)
    }

    fn write(&mut self, message: Message) -> Result<(), End> {
        self.socket.write(message).map_err(|_| None)
    }
}

/// Closes a socket, and waits a little until the page has read the reason.
fn close(socket: &mut WebSocket<&TcpStream>, frame: &CloseFrame) {
    if socket.close(Some(frame.clone())).is_err() {
        return;
    }
    let end = Instant::now() + GOODBYE;
    while Instant::now() < end {
        match socket.read() {
            Ok(_) => {}
            Err(tungstenite::Error::Io(error)) if is_timeout(&error) => {}
            Err(_) => return,
        }
    }
}
