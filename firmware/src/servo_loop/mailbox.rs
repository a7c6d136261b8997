//! Connects the servo's interrupt and the task below it: requests to the interrupt, notices to the task.
//! Neither side ever waits for the other.

use core::sync::atomic::{AtomicU32, Ordering};

use heapless::spsc::{Consumer, Producer, Queue};

use super::Notice;
use interruption::may_interrupt;

/// Bits of the word of requests.
const ARM: u32 = 1;
const DISARM: u32 = 2;
const STATUS: u32 = 4;
const SET: u32 = 8;
const HOST_ALIVE: u32 = 16;
const ALIGN: u32 = 32;

/// Slots of the queue of sets: one set can wait, and a queue keeps one slot free.
const SETS: usize = 2;
/// Slots of the queue of notices, one of them kept free.
const NOTICES: usize = 6;

/// Shared by both ends; `R` is the swapped servo, a [`PreparedServo`](crate::servo::PreparedServo).
#[derive(Debug)]
pub struct Mailbox<R> {
    sets: Queue<R, SETS>,
    notices: Queue<Notice, NOTICES>,
    /// Pending requests; the interrupt reads nothing else in an ordinary tick.
    pending: AtomicU32,
}

impl<R> Mailbox<R> {
    /// An empty mailbox.
    pub const fn new() -> Self {
        Self { sets: Queue::new(), notices: Queue::new(), pending: AtomicU32::new(0) }
    }

    /// The task's end and the interrupt's end.
    pub fn split(&mut self) -> (Requests<'_, R>, Inbox<'_, R>) {
        let (submit, sets) = self.sets.split();
        let (notice_sender, notices) = self.notices.split();
        let pending = &self.pending;
        (Requests { submit, notices, pending }, Inbox { sets, notice_sender, pending })
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
    pending: &'a AtomicU32,
}

impl<R> Requests<'_, R> {
    /// Requests arming; [`Notice::Armed`] or [`Notice::NotArmed`] answers.
    pub fn arm(&self) {
        self.post(ARM);
    }

    /// Requests to close the clamp and to switch the amplifier off; [`Notice::Disarmed`] answers.
    /// If arming is requested as well, disarming wins.
    pub fn disarm(&self) {
        self.post(DISARM);
    }

    /// Requests the alignment of a brushless motor, which moves the handle; [`Notice::Aligning`] or
    /// [`Notice::NotAligning`] answers.
    pub fn align(&self) {
        self.post(ALIGN);
    }

    /// Requests a [`Notice::Status`].
    pub fn request_status(&self) {
        self.post(STATUS);
    }

    /// Reports a message from the host.
    pub fn host_alive(&self) {
        self.post(HOST_ALIVE);
    }

    /// Submits a set, which is swapped in as a whole; [`Notice::Applied`] answers. Its period must be that of
    /// the board's timer; [`tuning`](crate::tuning) never changes the period.
    ///
    /// # Errors
    /// Returns the set if the previous set is still waiting.
    pub fn submit(&mut self, set: R) -> Result<(), R> {
        may_interrupt();
        self.submit.enqueue(set)?;
        self.post(SET);
        Ok(())
    }

    /// The next notice.
    pub fn notice(&mut self) -> Option<Notice> {
        may_interrupt();
        let notice = self.notices.dequeue();
        may_interrupt();
        notice
    }

    fn post(&self, request: u32) {
        may_interrupt();
        self.pending.fetch_or(request, Ordering::Release);
        may_interrupt();
    }
}

/// The interrupt's end.
pub struct Inbox<'a, R> {
    sets: Consumer<'a, R>,
    notice_sender: Producer<'a, Notice>,
    pending: &'a AtomicU32,
}

/// Requests since the last tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingRequests {
    pub arm: bool,
    pub disarm: bool,
    pub align: bool,
    pub status: bool,
    pub host_alive: bool,
}

impl<R> Inbox<'_, R> {
    /// Pending requests as a word; zero if none.
    #[inline(always)]
    pub(super) fn pending(&self) -> u32 {
        self.pending.load(Ordering::Relaxed)
    }

    /// Takes the pending requests.
    pub(super) fn take(&self) -> PendingRequests {
        let pending = self.pending.swap(0, Ordering::Acquire);
        PendingRequests {
            arm: pending & (ARM | DISARM) == ARM,
            disarm: pending & DISARM != 0,
            align: pending & (ALIGN | DISARM) == ALIGN,
            status: pending & STATUS != 0,
            host_alive: pending & HOST_ALIVE != 0,
        }
    }

    /// Whether a set waits.
    pub(super) fn has_set(&self) -> bool {
        self.sets.ready()
    }

    /// Takes the waiting set.
    pub(super) fn set(&mut self) -> Option<R> {
        self.sets.dequeue()
    }

    /// Sends a notice to the task; the notice is lost if the queue is full.
    pub(super) fn notify(&mut self, notice: Notice) {
        let _ = self.notice_sender.enqueue(notice);
    }
}

/// The instants between two accesses of the task at which the interrupt may come.
#[cfg(not(all(test, feature = "wire")))]
mod interruption {
    /// The hardware interrupts where it likes.
    #[inline(always)]
    pub(super) const fn may_interrupt() {}
}

/// The same for tests, which have no interrupt: a test's own is called at each of these instants.
#[cfg(all(test, feature = "wire"))]
pub(crate) mod interruption {
    use core::cell::RefCell;
    use std::boxed::Box;

    std::thread_local! {
        static INTERRUPT: RefCell<Option<Box<dyn FnMut()>>> = const { RefCell::new(None) };
    }

    /// Calls `interrupt` at each instant of this thread from now on.
    pub(crate) fn set(interrupt: impl FnMut() + 'static) {
        INTERRUPT.set(Some(Box::new(interrupt)));
    }

    /// Ends that.
    pub(crate) fn clear() {
        INTERRUPT.set(None);
    }

    pub(super) fn may_interrupt() {
        // Taken out while it runs: an interrupt does not interrupt itself.
        let Some(mut interrupt) = INTERRUPT.take() else { return };
        interrupt();
        INTERRUPT.set(Some(interrupt));
    }
}
