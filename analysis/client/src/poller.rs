//! Messages of a board, as they arrive, from a thread that polls it and reconnects when the link
//! is lost.

use std::num::NonZeroU32;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use haptic_model::board::client::Event;
use haptic_model::board::request::{Reply, Request};
use haptic_model::board::timing::RETRY;

use super::LinkError;
use super::link::{Link, Wire};

/// Longest time until a request is passed on.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

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
    ///
    /// # Panics
    /// If its thread has.
    pub fn next(&self, timeout: Duration) -> Option<Event> {
        match self.events.recv_timeout(timeout) {
            Err(RecvTimeoutError::Disconnected) => panic!("the poller of the board has ended"),
            event => event.ok(),
        }
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

impl PollerThread {
    fn run(&self, first: Link) {
        let address = first.address().clone();
        let mut link = Ok(first);
        loop {
            if let Err(error) = link.and_then(|link| self.poll_board(link)) {
                self.send(Event::Lost(error.to_string()));
                self.wait_before_retry();
            }
            if self.is_over() {
                return;
            }
            link = Link::open(&address);
            self.reject_requests();
        }
    }

    fn send(&self, event: Event) {
        // The receiver waits for this thread before it goes.
        let _ = self.events.send(event);
    }

    /// Waits a while before the next try.
    fn wait_before_retry(&self) {
        let end = Instant::now() + RETRY;
        while !self.is_over() && Instant::now() < end {
            self.reject_requests();
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Forwards the board's messages until the link is lost, the board has restarted without its settings, or
    /// the end.
    fn poll_board(&self, link: Link) -> Result<(), LinkError> {
        self.send(Event::Connected(link.board().clone()));
        let mut wire = link.into_wire();
        wire.watch(self.every);
        let polled = self.poll_until_lost(&mut wire);
        wire.client.give_up();
        self.forward(&mut wire);
        polled?;
        if self.is_over() { wire.unwatch() } else { Ok(()) }
    }

    fn poll_until_lost(&self, wire: &mut Wire) -> Result<(), LinkError> {
        let mut has_restarted = false;
        while !self.is_over() && !has_restarted {
            for request in self.requests.try_iter() {
                let now = wire.now();
                if let Err(reply) = wire.client.request(request.clone(), now) {
                    self.send(Event::Reply(request, reply));
                }
            }
            let carried = wire.carry(Instant::now() + POLL_INTERVAL);
            has_restarted = self.forward(wire);
            carried?;
        }
        Ok(())
    }

    /// Forwards the events so far; returns whether the board has restarted.
    fn forward(&self, wire: &mut Wire) -> bool {
        let mut has_restarted = false;
        while let Some(event) = wire.client.next_event() {
            has_restarted |= matches!(event, Event::Lost(_));
            self.send(event);
        }
        has_restarted
    }

    /// Drops requests without a link: a key that was pressed some time ago must not switch a motor
    /// on.
    fn reject_requests(&self) {
        for request in self.requests.try_iter() {
            self.send(Event::Reply(request, Reply::NoLink));
        }
    }

    fn is_over(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }
}
