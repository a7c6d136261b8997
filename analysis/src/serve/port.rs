//! The port of a board, which is always read, and the page that uses it.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

use haptic_model::board::timing::RETRY;

use super::access::Token;
use crate::link::{Address, LinkError, Transport, open, read_within};

/// Longest time that bytes to the board wait.
const POLL_INTERVAL: Duration = Duration::from_millis(5);
/// Bytes that are read at a time.
const BYTES: usize = 4096;
/// Bytes that are written between two reads, and the rest of a page's message: a page that sends without pause
/// must not keep the board's bytes from being read.
const WRITTEN: usize = 256;
/// Largest number of reads waiting for a page; with more, the page is too slow.
const READS: usize = 256;
/// Largest number of a page's messages waiting for the port.
const MESSAGES: usize = 64;

/// Reports events as text to the user who started the server.
pub type Report = Box<dyn Fn(&str) + Send + Sync>;

/// The port of a board.
pub struct Port {
    address: Address,
    transport: Box<dyn Transport>,
}

/// News for a page.
#[derive(Debug)]
pub enum News {
    /// The board has sent bytes.
    Bytes(Vec<u8>),
    /// The port is lost, and is being opened again.
    Lost(String),
    /// The port is open.
    Open,
}

/// The right to use the port: one page at a time.
#[derive(Clone)]
pub struct Seats {
    shared: Arc<Mutex<State>>,
    to_board: SyncSender<Vec<u8>>,
}

struct State {
    /// The page's name while it is there, and the channel to it.
    client: Option<(Weak<Token>, SyncSender<News>)>,
    /// The reason if the port is not open.
    lost: Option<String>,
}

/// The page that uses the port; releases it when dropped.
pub struct Seat {
    /// The name that only this page knows.
    pub id: Arc<Token>,
    news: Receiver<News>,
}

/// Why bytes of a page were not sent.
pub enum Unsent {
    /// The bytes: too many are waiting.
    Full(Vec<u8>),
    /// The page has not the port.
    NoPage,
}

/// Seats, and the bytes from their pages to the board.
pub fn seats() -> (Seats, Receiver<Vec<u8>>) {
    let (to_board, wire) = sync_channel(MESSAGES);
    let shared = Arc::new(Mutex::new(State { client: None, lost: None }));
    (Seats { shared, to_board }, wire)
}

impl Seats {
    /// Takes the port for a page of this name, if no page has it.
    pub fn take(&self, id: &Token) -> Option<Seat> {
        self.with(|state| {
            if state.client.as_ref().is_some_and(|(page, _)| page.strong_count() > 0) {
                return None;
            }
            let (client, news) = sync_channel(READS);
            let first = state.lost.clone().map_or(News::Open, News::Lost);
            // There is room for one.
            let _ = client.try_send(first);
            let id = Arc::new(id.clone());
            state.client = Some((Arc::downgrade(&id), client));
            Some(Seat { id, news })
        })
    }

    /// Sends bytes of the page of this name to the board.
    ///
    /// # Errors
    /// If too many bytes are waiting, or if that page has not the port.
    pub fn send(&self, page: &str, bytes: Vec<u8>) -> Result<(), Unsent> {
        let own = self.with(|state| state.client.as_ref().and_then(|(id, _)| id.upgrade()));
        if !own.is_some_and(|own| own.is(page)) {
            return Err(Unsent::NoPage);
        }
        match self.to_board.try_send(bytes) {
            Err(TrySendError::Full(bytes)) => Err(Unsent::Full(bytes)),
            // Without the port's thread the server ends.
            Ok(()) | Err(TrySendError::Disconnected(_)) => Ok(()),
        }
    }

    /// Sends to the page that uses the port. A page that is too slow loses the port; the port does not wait.
    fn tell(&self, news: News) {
        self.with(|state| {
            if let Some((_, client)) = &state.client
                && client.try_send(news).is_err()
            {
                state.client = None;
            }
        });
    }

    fn with<T>(&self, of: impl FnOnce(&mut State) -> T) -> T {
        // The state is valid after a panic, too: every change of it is complete.
        of(&mut self.shared.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Seat {
    /// The next news; `Disconnected` if the page has lost the port.
    ///
    /// # Errors
    /// If there is no news.
    pub fn news(&self) -> Result<News, TryRecvError> {
        self.news.try_recv()
    }
}

impl Port {
    /// Opens the port.
    pub fn open(address: &Address) -> Result<Self, LinkError> {
        let address = address.clone();
        match open(&address) {
            Ok(transport) => Ok(Self { address, transport }),
            Err(source) => Err(LinkError::Open { address, source }),
        }
    }

    /// Carries bytes until the end of the server, and opens the port again if it is lost.
    pub(super) fn carry(
        self,
        seats: &Seats,
        wire: &Receiver<Vec<u8>>,
        over: &AtomicBool,
        report: &Report,
    ) {
        let Self { address, transport } = self;
        let mut transport = Some(transport);
        while !over.load(Ordering::Relaxed) {
            let lost = match &mut transport {
                Some(transport) => match carry(transport.as_mut(), seats, wire, over) {
                    Ok(()) => return,
                    Err(source) => LinkError::Lost { address: address.clone(), source },
                },
                None => match Self::open(&address) {
                    Ok(port) => {
                        transport = Some(port.transport);
                        report(&format!("{address} is open again"));
                        seats.with(|state| state.lost = None);
                        seats.tell(News::Open);
                        continue;
                    }
                    Err(error) => error,
                },
            };
            // Closed, so that it can be opened again.
            if transport.take().is_some() {
                report(&format!("{lost}; trying again"));
            }
            seats.with(|state| state.lost = Some(lost.to_string()));
            seats.tell(News::Lost(lost.to_string()));
            wait(wire, over);
        }
    }
}

/// Waits before the next try. Bytes from a page meanwhile are lost, as on a line without a board.
fn wait(wire: &Receiver<Vec<u8>>, over: &AtomicBool) {
    let end = Instant::now() + RETRY;
    while !over.load(Ordering::Relaxed) && Instant::now() < end {
        while wire.try_recv().is_ok() {}
        thread::sleep(POLL_INTERVAL);
    }
}

/// Carries bytes in both directions until the end of the server, or until the port is lost.
fn carry(
    transport: &mut dyn Transport,
    seats: &Seats,
    wire: &Receiver<Vec<u8>>,
    over: &AtomicBool,
) -> io::Result<()> {
    let mut bytes = [0; BYTES];
    while !over.load(Ordering::Relaxed) {
        let mut written = 0;
        while written < WRITTEN
            && let Ok(bytes) = wire.try_recv()
        {
            transport.write_all(&bytes)?;
            transport.flush()?;
            written += bytes.len().max(1);
        }
        let read = read_within(transport, &mut bytes, POLL_INTERVAL)?;
        if read > 0 {
            seats.tell(News::Bytes(bytes[..read].to_vec()));
        }
    }
    Ok(())
}
