//! What a board says, as it comes in, from a thread that keeps asking and connects again when the
//! link is lost.

use std::num::NonZeroU32;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, SendError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use firmware::cycle::Frame;
use firmware::wire::Discarded;
use firmware::wire::message::{Board, Remembered, Running, Status, ToBoard, ToHost};

use crate::link::{Link, LinkError};

/// Time between two questions how it is going; also what the board hears of us, where it stops
/// without a host.
const BEAT: Duration = Duration::from_millis(100);
/// Time between two tries to connect again.
const RETRY: Duration = Duration::from_millis(500);
/// Silence after which a link that gives no error counts as lost all the same.
const SILENCE: Duration = Duration::from_secs(3);

/// What a board says.
#[derive(Clone, Debug)]
pub enum Event {
    /// A board has said who it is.
    Connected {
        /// Name of its program.
        program: String,
        /// What its numbers mean.
        board: Board,
        /// What stopped it before it was last started.
        remembered: Option<Remembered>,
    },
    /// Ticks.
    Ticks(Vec<Frame>),
    /// How it is going, and the frames that the host could not read.
    Status(Status, Discarded),
    /// The numbers that run.
    Running(Running),
    /// The link is lost, and a new one is tried.
    Lost(String),
}

/// A running feed; ends when dropped.
#[derive(Debug)]
pub struct Feed {
    events: Receiver<Event>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Feed {
    /// Asks the board behind this link for every so many ticks.
    pub fn start(link: Link, every: NonZeroU32) -> Self {
        let (events, receiver) = mpsc::channel();
        let ended = Arc::new(AtomicBool::new(false));
        let feeder = Feeder { events, ended: ended.clone(), every };
        let thread = thread::spawn(move || feeder.run(link));
        Self { events: receiver, ended, thread: Some(thread) }
    }

    /// The next event, if there is one within that time.
    pub fn next(&self, patience: Duration) -> Option<Event> {
        self.events.recv_timeout(patience).ok()
    }
}

impl Drop for Feed {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic in the thread has been printed; there is nothing left to do about it.
            let _ = thread.join();
        }
    }
}

/// The thread's side of a feed.
struct Feeder {
    events: Sender<Event>,
    ended: Arc<AtomicBool>,
    every: NonZeroU32,
}

/// Why following a board ended.
enum End {
    /// Nobody listens any more.
    Over,
    /// The link.
    Lost(LinkError),
    /// The board has forgotten what it was asked for.
    Restarted,
}

impl From<LinkError> for End {
    fn from(error: LinkError) -> Self {
        Self::Lost(error)
    }
}

impl From<SendError<Event>> for End {
    fn from(_: SendError<Event>) -> Self {
        Self::Over
    }
}

impl Feeder {
    fn run(&self, first: Link) {
        let address = first.address().clone();
        let mut link = Some(first);
        while !self.is_over() {
            let end = match link.take() {
                Some(mut link) => self.follow(&mut link),
                None => match Link::open(&address) {
                    Ok(again) => {
                        link = Some(again);
                        continue;
                    }
                    Err(error) => Err(error.into()),
                },
            };
            match end {
                Ok(()) | Err(End::Over) => return,
                Err(End::Restarted) => self.lost("the board was started again".to_owned()),
                Err(End::Lost(error)) => {
                    self.lost(error.to_string());
                    self.rest();
                }
            }
        }
    }

    fn lost(&self, why: String) {
        // Nobody may be listening any more, which the next look tells.
        let _ = self.events.send(Event::Lost(why));
    }

    /// Waits a while before the next try.
    fn rest(&self) {
        let end = Instant::now() + RETRY;
        while !self.is_over() && Instant::now() < end {
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Passes on what the board says, until the link is lost or nobody listens.
    fn follow(&self, link: &mut Link) -> Result<(), End> {
        let (program, board) = (link.program().to_owned(), *link.board());
        self.events.send(Event::Connected { program, board, remembered: link.remembered() })?;
        link.send(&ToBoard::Stream(Some(self.every)))?;
        link.send(&ToBoard::Get)?;
        let (mut beat, mut heard) = (Instant::now(), Instant::now());
        let mut last: Option<Status> = None;
        while !self.is_over() {
            if beat <= Instant::now() {
                link.send(&ToBoard::Status)?;
                beat = Instant::now() + BEAT;
            }
            let Some(message) = link.receive(beat)? else {
                if heard.elapsed() > SILENCE {
                    return Err(End::Lost(link.silent("for its status", SILENCE)));
                }
                continue;
            };
            heard = Instant::now();
            match message {
                ToHost::Telemetry(batch) => {
                    self.events.send(Event::Ticks(batch.ticks().collect()))?;
                }
                ToHost::Status(status) => {
                    if let Some(last) = last.replace(status) {
                        if status.tick.wrapping_sub(last.tick) > u32::MAX / 2 {
                            return Err(End::Restarted);
                        }
                        // Somebody else has changed the numbers.
                        if status.sets != last.sets {
                            link.send(&ToBoard::Get)?;
                        }
                    }
                    self.events.send(Event::Status(status, link.discarded()))?;
                }
                ToHost::Running(running) => self.events.send(Event::Running(running))?,
                // Of a greeting that was asked for twice, or of somebody else's question.
                ToHost::Welcome { .. }
                | ToHost::Remembered(_)
                | ToHost::Board(_)
                | ToHost::Described(_)
                | ToHost::Answer { .. } => {}
            }
        }
        link.send(&ToBoard::Stream(None))?;
        Ok(())
    }

    fn is_over(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }
}
