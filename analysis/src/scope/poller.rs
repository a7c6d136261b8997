//! Messages of a board, as they arrive, from a thread that polls it and reconnects when the link
//! is lost.

use std::num::NonZeroU32;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, SendError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use haptic_model::board::timing::{REQUEST, RETRY, SILENCE, STATUS_INTERVAL};
use haptic_servo::servo_loop::Frame;
use haptic_servo::wire::Discarded;
use haptic_servo::wire::message::{
    ActiveParameters, BoardUnits, Id, PreviousFault, Status, ToBoard, ToHost,
};

use super::control::{Reply, Request};
use crate::link::{Link, LinkError};

/// Longest time until a request is passed on.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// A board's event.
#[derive(Clone, Debug)]
pub enum Event {
    /// A board has identified itself.
    Connected {
        /// Name of its program.
        program: String,
        /// The units of its numbers.
        board: BoardUnits,
        /// The fault that stopped it before its last start.
        previous_fault: Option<PreviousFault>,
    },
    /// Ticks.
    Ticks(Vec<Frame>),
    /// Its status, and the frames that the host could not read.
    Status(Status, Discarded),
    /// The active parameters.
    ActiveParameters(ActiveParameters),
    /// The result of a request.
    Reply(Request, Reply),
    /// The link is lost, and a new one is tried.
    Lost(String),
}

/// A running poller; ends when dropped.
#[derive(Debug)]
pub struct BoardPoller {
    events: Receiver<Event>,
    requests: Sender<Request>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl BoardPoller {
    /// Requests one of `every` ticks from the board behind this link.
    pub fn start(link: Link, every: NonZeroU32) -> Self {
        let (events, receiver) = mpsc::channel();
        let (requests, inbox) = mpsc::channel();
        let ended = Arc::new(AtomicBool::new(false));
        let poller = PollerThread { events, requests: inbox, ended: ended.clone(), every };
        let thread = thread::spawn(move || poller.run(link));
        Self { events: receiver, requests, ended, thread: Some(thread) }
    }

    /// Sends a request to the board; its result is an event.
    pub fn request(&self, request: Request) {
        // A thread that has ended has reported why.
        let _ = self.requests.send(request);
    }

    /// The next event, if there is one within that time.
    pub fn next(&self, timeout: Duration) -> Option<Event> {
        self.events.recv_timeout(timeout).ok()
    }
}

impl Drop for BoardPoller {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic in the thread has been printed; there is nothing left to do about it.
            let _ = thread.join();
        }
    }
}

/// The thread's side of a poller.
struct PollerThread {
    events: Sender<Event>,
    requests: Receiver<Request>,
    ended: Arc<AtomicBool>,
    every: NonZeroU32,
}

/// A request that the board has not answered yet.
struct PendingRequest {
    id: Id,
    request: Request,
    /// When it is sent again.
    again: Instant,
    /// When it counts as unanswered.
    end: Instant,
}

/// Why polling a board ended.
enum PollEnd {
    /// The receiver is gone.
    Over,
    /// The link.
    Lost(LinkError),
    /// The board has restarted without its settings.
    Restarted,
}

impl From<LinkError> for PollEnd {
    fn from(error: LinkError) -> Self {
        Self::Lost(error)
    }
}

impl From<SendError<Event>> for PollEnd {
    fn from(_: SendError<Event>) -> Self {
        Self::Over
    }
}

impl PollerThread {
    fn run(&self, first: Link) {
        let address = first.address().clone();
        let mut link = Some(first);
        while !self.is_over() {
            let end = match link.take() {
                Some(mut link) => self.poll_board(&mut link),
                None => match Link::open(&address) {
                    Ok(again) => {
                        self.reject_requests();
                        link = Some(again);
                        continue;
                    }
                    Err(error) => Err(error.into()),
                },
            };
            match end {
                Ok(()) | Err(PollEnd::Over) => return,
                Err(PollEnd::Restarted) => self.lost("the board was started again".to_owned()),
                Err(PollEnd::Lost(error)) => {
                    self.lost(error.to_string());
                    self.wait_before_retry();
                }
            }
        }
    }

    fn lost(&self, why: String) {
        // The receiver may be gone; the next check of `ended` tells.
        let _ = self.events.send(Event::Lost(why));
    }

    /// Waits a while before the next try.
    fn wait_before_retry(&self) {
        let end = Instant::now() + RETRY;
        while !self.is_over() && Instant::now() < end {
            self.reject_requests();
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Forwards the board's messages until the link or the receiver is lost.
    fn poll_board(&self, link: &mut Link) -> Result<(), PollEnd> {
        let (program, board) = (link.program().to_owned(), *link.board());
        self.events.send(Event::Connected {
            program,
            board,
            previous_fault: link.previous_fault(),
        })?;
        link.send(&ToBoard::Stream(Some(self.every)))?;
        link.send(&ToBoard::Get)?;
        let mut pending = None;
        let polled = self.poll_until_lost(link, &mut pending);
        if let Some(PendingRequest { request, .. }) = pending {
            self.events.send(Event::Reply(request, Reply::Unanswered))?;
        }
        polled?;
        link.send(&ToBoard::Stream(None))?;
        Ok(())
    }

    fn poll_until_lost(
        &self,
        link: &mut Link,
        pending: &mut Option<PendingRequest>,
    ) -> Result<(), PollEnd> {
        let (mut beat, mut heard) = (Instant::now(), Instant::now());
        let mut last: Option<Status> = None;
        while !self.is_over() {
            self.ask(link, pending)?;
            if beat <= Instant::now() {
                link.send(&ToBoard::Status)?;
                beat = Instant::now() + STATUS_INTERVAL;
            }
            let Some(message) = link.receive(beat.min(Instant::now() + POLL_INTERVAL))? else {
                if heard.elapsed() > SILENCE {
                    return Err(PollEnd::Lost(link.silent("the request for its status", SILENCE)));
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
                            return Err(PollEnd::Restarted);
                        }
                        // Another client changed the parameters.
                        if status.sets != last.sets {
                            link.send(&ToBoard::Get)?;
                        }
                    }
                    self.events.send(Event::Status(status, link.discarded()))?;
                }
                ToHost::ActiveParameters(parameters) => {
                    self.events.send(Event::ActiveParameters(parameters))?
                }
                ToHost::Answer { id, outcome } if pending.as_ref().is_some_and(|p| p.id == id) => {
                    let Some(PendingRequest { request, .. }) = pending.take() else { continue };
                    let answer = link.in_words(outcome, &request.changes())?;
                    self.events.send(Event::Reply(request, Reply::Answered(answer)))?;
                    link.send(&ToBoard::Get)?;
                }
                // Replies to a repeated hello or to another client's request.
                ToHost::Welcome { .. }
                | ToHost::PreviousFault(_)
                | ToHost::Board(_)
                | ToHost::Described(_)
                | ToHost::Answer { .. } => {}
            }
        }
        Ok(())
    }

    /// Passes on a request; one at a time, except that disarming does not wait. Repeats it, since bytes get
    /// lost.
    fn ask(&self, link: &mut Link, pending: &mut Option<PendingRequest>) -> Result<(), PollEnd> {
        let now = Instant::now();
        while let Ok(request) = self.requests.try_recv() {
            if pending.is_some() && request != Request::Disarm {
                self.events.send(Event::Reply(request, Reply::Busy))?;
                continue;
            }
            if let Some(PendingRequest { request, .. }) = pending.take() {
                self.events.send(Event::Reply(request, Reply::Unanswered))?;
            }
            let id = link.next_id();
            link.send(&request.message(id))?;
            self.events.send(Event::Reply(request.clone(), Reply::Asked))?;
            let (again, end) = (now + REQUEST.again, now + REQUEST.end);
            *pending = Some(PendingRequest { id, request, again, end });
        }
        if let Some(PendingRequest { request, .. }) = pending.take_if(|pending| now >= pending.end)
        {
            self.events.send(Event::Reply(request, Reply::Unanswered))?;
        }
        if let Some(PendingRequest { id, request, again, .. }) = pending
            && now >= *again
        {
            *again = now + REQUEST.again;
            link.send(&request.message(*id))?;
        }
        Ok(())
    }

    /// Drops requests without a link: a key that was pressed some time ago must not switch a motor
    /// on.
    fn reject_requests(&self) {
        for request in self.requests.try_iter() {
            // The receiver may be gone; the next check of `ended` tells.
            let _ = self.events.send(Event::Reply(request, Reply::NoLink));
        }
    }

    fn is_over(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }
}
