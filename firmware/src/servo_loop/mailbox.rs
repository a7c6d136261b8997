//! Between the servo's interrupt and the task below it: requests down, notices up, and neither
//! ever waits for the other.

use core::sync::atomic::{AtomicU32, Ordering};

use heapless::spsc::{Consumer, Producer, Queue};

use super::Notice;

/// Bits of the word of requests.
const ARM: u32 = 1;
const DISARM: u32 = 2;
const STATUS: u32 = 4;
const SET: u32 = 8;
const HEARD: u32 = 16;

/// Sets that wait: one, and the place that a queue keeps free.
const SETS: usize = 2;
/// Notices that wait, and that place.
const NOTICES: usize = 6;

/// The place where both meet; `R` is what is swapped in, a [`PreparedServo`](crate::servo::PreparedServo).
#[derive(Debug)]
pub struct Mailbox<R> {
    sets: Queue<R, SETS>,
    notices: Queue<Notice, NOTICES>,
    /// What is asked for; the interrupt looks at nothing else in an ordinary tick.
    asked: AtomicU32,
}

impl<R> Mailbox<R> {
    /// An empty mailbox.
    pub const fn new() -> Self {
        Self { sets: Queue::new(), notices: Queue::new(), asked: AtomicU32::new(0) }
    }

    /// The task's end and the interrupt's end.
    pub fn split(&mut self) -> (Requests<'_, R>, Inbox<'_, R>) {
        let (submit, sets) = self.sets.split();
        let (tell, notices) = self.notices.split();
        let asked = &self.asked;
        (Requests { submit, notices, asked }, Inbox { sets, tell, asked })
    }
}

impl<R> Default for Mailbox<R> {
    fn default() -> Self {
        Self::new()
    }
}

/// The low-priority end.
pub struct Requests<'a, R> {
    submit: Producer<'a, R>,
    notices: Consumer<'a, Notice>,
    asked: &'a AtomicU32,
}

impl<R> Requests<'_, R> {
    /// Asks for the servo to be armed; [`Notice::Armed`] or [`Notice::NotArmed`] answers.
    pub fn arm(&self) {
        self.ask(ARM);
    }

    /// Asks for the clamp to be closed and the amplifier switched off; [`Notice::Disarmed`]
    /// answers. Asked for together with arming, disarming wins.
    pub fn disarm(&self) {
        self.ask(DISARM);
    }

    /// Asks for a [`Notice::Status`].
    pub fn ask_status(&self) {
        self.ask(STATUS);
    }

    /// Says that the host was heard.
    pub fn heard(&self) {
        self.ask(HEARD);
    }

    /// Gives a set to be swapped in as a whole; [`Notice::Applied`] answers. It has to be of the
    /// period that the board's timer has, which [`tuning`](crate::tuning) leaves as it is.
    ///
    /// # Errors
    /// The set itself, where the one before it is still waiting.
    pub fn submit(&mut self, set: R) -> Result<(), R> {
        self.submit.enqueue(set)?;
        self.ask(SET);
        Ok(())
    }

    /// The next notice.
    pub fn notice(&mut self) -> Option<Notice> {
        self.notices.dequeue()
    }

    fn ask(&self, request: u32) {
        self.asked.fetch_or(request, Ordering::Release);
    }
}

/// The interrupt's end.
pub struct Inbox<'a, R> {
    sets: Consumer<'a, R>,
    tell: Producer<'a, Notice>,
    asked: &'a AtomicU32,
}

/// What was asked for since the last tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub arm: bool,
    pub disarm: bool,
    pub status: bool,
    pub heard: bool,
}

impl<R> Inbox<'_, R> {
    /// What is asked for, as a word; zero where it is nothing.
    #[inline(always)]
    pub(super) fn asked(&self) -> u32 {
        self.asked.load(Ordering::Relaxed)
    }

    /// What is asked for, once.
    pub(super) fn take(&self) -> Asked {
        let asked = self.asked.swap(0, Ordering::Acquire);
        Asked {
            arm: asked & (ARM | DISARM) == ARM,
            disarm: asked & DISARM != 0,
            status: asked & STATUS != 0,
            heard: asked & HEARD != 0,
        }
    }

    /// Whether a set waits.
    pub(super) fn has_set(&self) -> bool {
        self.sets.ready()
    }

    /// The set that waits.
    pub(super) fn set(&mut self) -> Option<R> {
        self.sets.dequeue()
    }

    /// Tells the low-priority side; where it has left too many notices unread, this one is lost.
    pub(super) fn tell(&mut self, notice: Notice) {
        let _ = self.tell.enqueue(notice);
    }
}
