//! Connects the servo's interrupt and the task below it. The task requests; the interrupt publishes its
//! state, which the task compares with its requests. Neither side ever waits for the other, and a task that
//! reads late misses nothing: a published value replaces the previous one.
//!
//! Each shared word has one writer, except `pending`, in which the task sets bits and which the interrupt
//! clears as a whole. The order of the accesses:
//!
//! ```text
//! task        a request: its number in `numbers`, then its bit in `pending` (release)
//!             a set: into `sets`, then its bit in `pending` (release)
//! interrupt   all of `pending` (acquire), the numbers of its bits, then the work
//!             the result with the number of its request: `off`, `swapped`, `arming`, `alignment`, `status`
//! task        reads the result; it is that of its last request if it has the number of that request
//! ```
//!
//! An interrupt between number and bit may still find the bit of an earlier request of the same kind. It then
//! answers both with the later number, and does the same work again for the later bit.

use core::sync::atomic::{AtomicU32, Ordering, fence};

use heapless::spsc::{Consumer, Producer, Queue};

use super::interruption::may_interrupt;
use super::state::{Reply, Status};
use crate::host::HostChannel;

/// Bits of the word of requests; the first are those of [`Kind`].
const SET: u32 = 1 << 4;
const HOST_ALIVE: u32 = 1 << 5;

/// Slots of the queue of sets: one set can wait, and a queue keeps one slot free.
const SETS: usize = 2;

/// Numbered requests. Each has a bit in the word of requests.
#[derive(Clone, Copy)]
enum Kind {
    Arm = 0,
    Disarm = 1,
    Align = 2,
    Status = 3,
}

impl Kind {
    const COUNT: usize = 4;

    const fn bit(self) -> u32 {
        1 << self as u32
    }
}

/// The words that both ends share.
#[derive(Debug)]
struct Shared {
    /// Pending requests; the interrupt reads nothing else in an ordinary tick.
    pending: AtomicU32,
    /// The number of the last request of each kind, from 1; wraps.
    numbers: [AtomicU32; Kind::COUNT],
    /// Sets swapped in since the start; wraps.
    swapped: AtomicU32,
    /// The last request to disarm after which the amplifier was off.
    off: AtomicU32,
    /// The last answered requests to arm and for an alignment, and their replies.
    arming: Published<{ 1 + Reply::WORDS }>,
    alignment: Published<{ 1 + Reply::WORDS }>,
    /// The last answered request for the status, and the status.
    status: Published<{ 1 + Status::WORDS }>,
}

/// What the mailbox carries beside a servo.
pub trait Exchanged {
    /// The words of a host, or none.
    type Channel: HostChannel;
}

/// Shared by both ends; `R` is the swapped servo, a [`PreparedServo`](crate::servo::PreparedServo).
pub struct Mailbox<R: Exchanged> {
    sets: Queue<R, SETS>,
    shared: Shared,
    host: R::Channel,
}

impl<R: Exchanged> Mailbox<R> {
    /// An empty mailbox.
    pub const fn new() -> Self {
        let shared = Shared {
            pending: AtomicU32::new(0),
            numbers: [const { AtomicU32::new(0) }; Kind::COUNT],
            swapped: AtomicU32::new(0),
            off: AtomicU32::new(0),
            arming: Published::new(),
            alignment: Published::new(),
            status: Published::new(),
        };
        Self { sets: Queue::new(), shared, host: R::Channel::EMPTY }
    }

    /// The task's end and the interrupt's end.
    pub fn split(&mut self) -> (Requests<'_, R>, Inbox<'_, R>) {
        let (submit, sets) = self.sets.split();
        let (shared, host) = (&self.shared, &self.host);
        let requests = Requests { submit, shared, host, submitted: 0 };
        (requests, Inbox { sets, shared, host, swapped: 0, disarm: 0 })
    }
}

impl<R: Exchanged> Default for Mailbox<R> {
    fn default() -> Self {
        Self::new()
    }
}

/// The low-priority end. Requests have numbers, by which a reply is recognised.
pub struct Requests<'a, R: Exchanged> {
    submit: Producer<'a, R>,
    shared: &'a Shared,
    host: &'a R::Channel,
    submitted: u32,
}

impl<R: Exchanged> Requests<'_, R> {
    /// The words of a host.
    pub const fn host(&self) -> &R::Channel {
        self.host
    }

    /// Requests arming; [`Requests::arming`] has the reply under the returned number. Do not request it
    /// before a request to disarm has its reply: the servo would fade in again, and never be off.
    pub fn arm(&self) -> u32 {
        self.request(Kind::Arm)
    }

    /// Requests to close the clamp and to switch the amplifier off; [`Requests::off`] then returns this
    /// number or a later one. If arming is requested as well, disarming wins.
    pub fn disarm(&self) -> u32 {
        self.request(Kind::Disarm)
    }

    /// Requests the alignment of a brushless motor, which moves the handle; [`Requests::alignment`] has the
    /// reply under the returned number.
    pub fn align(&self) -> u32 {
        self.request(Kind::Align)
    }

    /// Requests the status; [`Requests::status`] has it under the returned number.
    pub fn request_status(&self) -> u32 {
        self.request(Kind::Status)
    }

    /// Reports a message from the host.
    pub fn host_alive(&self) {
        self.post(HOST_ALIVE);
    }

    /// Submits a set, which is swapped in as a whole; [`Requests::swapped`] then returns the number that this
    /// function returns. Its period must be that of the board's timer; [`tuning`](crate::tuning) never changes
    /// the period.
    ///
    /// # Errors
    /// Returns the set if the previous set is still waiting.
    pub fn submit(&mut self, set: R) -> Result<u32, R> {
        may_interrupt();
        self.submit.enqueue(set)?;
        self.submitted = self.submitted.wrapping_add(1);
        self.post(SET);
        Ok(self.submitted)
    }

    /// The number of sets swapped in since the start, which is the number of the running set; wraps.
    pub fn swapped(&self) -> u32 {
        may_interrupt();
        self.shared.swapped.load(Ordering::Acquire)
    }

    /// The number of the last request to disarm after which the amplifier was off; 0 before the first.
    pub fn off(&self) -> u32 {
        may_interrupt();
        self.shared.off.load(Ordering::Acquire)
    }

    /// The number of the last answered request to arm, and its reply. `None` before the first, or if a reply
    /// was published during this call: poll again.
    pub fn arming(&self) -> Option<(u32, Reply)> {
        numbered(&self.shared.arming)
    }

    /// The same of the last answered request for an alignment.
    pub fn alignment(&self) -> Option<(u32, Reply)> {
        numbered(&self.shared.alignment)
    }

    /// The number of the last answered request for the status, and the status; `None` as above.
    pub fn status(&self) -> Option<(u32, Status)> {
        let [number, words @ ..] = self.shared.status.read()?;
        (number != 0).then(|| (number, Status::from_words(words)))
    }

    fn request(&self, kind: Kind) -> u32 {
        let place = &self.shared.numbers[kind as usize];
        // 0 stands for no request.
        let number = place.load(Ordering::Relaxed).wrapping_add(1).max(1);
        may_interrupt();
        place.store(number, Ordering::Relaxed);
        self.post(kind.bit());
        number
    }

    fn post(&self, request: u32) {
        may_interrupt();
        self.shared.pending.fetch_or(request, Ordering::Release);
        may_interrupt();
    }
}

fn numbered(published: &Published<{ 1 + Reply::WORDS }>) -> Option<(u32, Reply)> {
    let [number, words @ ..] = published.read()?;
    Some((number, Reply::from_words(words)?)).filter(|_| number != 0)
}

/// The interrupt's end.
pub struct Inbox<'a, R: Exchanged> {
    sets: Consumer<'a, R>,
    shared: &'a Shared,
    host: &'a R::Channel,
    swapped: u32,
    /// The last request to disarm.
    disarm: u32,
}

/// Requests since the last tick, by their numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingRequests {
    pub arm: Option<u32>,
    pub align: Option<u32>,
    pub status: Option<u32>,
    pub disarm: bool,
    pub host_alive: bool,
}

impl<R: Exchanged> Inbox<'_, R> {
    /// The words of a host.
    pub(super) const fn host(&self) -> &R::Channel {
        self.host
    }

    /// Pending requests as a word; zero if none.
    #[inline(always)]
    pub(super) fn pending(&self) -> u32 {
        self.shared.pending.load(Ordering::Relaxed)
    }

    /// Takes the pending requests. A request to disarm overrules the others.
    pub(super) fn take(&mut self) -> PendingRequests {
        let pending = self.shared.pending.swap(0, Ordering::Acquire);
        let number = |kind: Kind| {
            let number = || self.shared.numbers[kind as usize].load(Ordering::Relaxed);
            (pending & kind.bit() != 0).then(number)
        };
        let mut requests = PendingRequests {
            arm: number(Kind::Arm),
            align: number(Kind::Align),
            status: number(Kind::Status),
            disarm: false,
            host_alive: pending & HOST_ALIVE != 0,
        };
        if let Some(disarm) = number(Kind::Disarm) {
            self.disarm = disarm;
            requests.disarm = true;
            if let Some(number) = requests.arm.take() {
                self.reply_to_arm(number, Reply::Disarming);
            }
            if let Some(number) = requests.align.take() {
                self.reply_to_align(number, Reply::Disarming);
            }
        }
        requests
    }

    pub(super) fn has_set(&self) -> bool {
        self.sets.ready()
    }

    /// The waiting set.
    pub(super) fn waiting_set(&self) -> Option<&R> {
        self.sets.peek()
    }

    /// Takes the waiting set; [`Inbox::swapped`] follows.
    pub(super) fn set(&mut self) -> Option<R> {
        self.sets.dequeue()
    }

    /// Publishes that the taken set runs.
    pub(super) fn swapped(&mut self) {
        self.swapped = self.swapped.wrapping_add(1);
        self.shared.swapped.store(self.swapped, Ordering::Release);
    }

    /// Publishes that the amplifier is off, as last requested.
    pub(super) fn off(&self) {
        self.shared.off.store(self.disarm, Ordering::Release);
    }

    pub(super) fn reply_to_arm(&self, number: u32, reply: Reply) {
        let [kind, code, a, b] = reply.to_words();
        self.shared.arming.publish([number, kind, code, a, b]);
    }

    pub(super) fn reply_to_align(&self, number: u32, reply: Reply) {
        let [kind, code, a, b] = reply.to_words();
        self.shared.alignment.publish([number, kind, code, a, b]);
    }

    pub(super) fn reply_with_status(&self, number: u32, status: &Status) {
        let mut words = [number; 1 + Status::WORDS];
        let [_, rest @ ..] = &mut words;
        *rest = status.to_words();
        self.shared.status.publish(words);
    }
}

/// The last published words; zeros before the first. One writer, which replaces them, and one reader.
///
/// A sequence lock. The writer stores an odd version, the words, and the next even version, and never waits.
/// The reader loads the version, the words, and the version again. An interrupt between these loads that
/// publishes changes the version, and the words are dropped.
#[derive(Debug)]
pub(super) struct Published<const WORDS: usize> {
    version: AtomicU32,
    words: [AtomicU32; WORDS],
}

impl<const WORDS: usize> Published<WORDS> {
    pub(super) const fn new() -> Self {
        Self { version: AtomicU32::new(0), words: [const { AtomicU32::new(0) }; WORDS] }
    }

    pub(super) fn publish(&self, words: [u32; WORDS]) {
        let version = self.version.load(Ordering::Relaxed);
        self.version.store(version.wrapping_add(1), Ordering::Relaxed);
        // No word before the odd version.
        fence(Ordering::Release);
        for (place, word) in self.words.iter().zip(words) {
            place.store(word, Ordering::Relaxed);
        }
        self.version.store(version.wrapping_add(2), Ordering::Release);
    }

    /// The words; `None` if they were replaced meanwhile: read them again at the next poll.
    pub(super) fn read(&self) -> Option<[u32; WORDS]> {
        let version = self.version.load(Ordering::Acquire);
        let mut words = [0; WORDS];
        for (word, place) in words.iter_mut().zip(&self.words) {
            may_interrupt();
            *word = place.load(Ordering::Relaxed);
        }
        may_interrupt();
        // The second load of the version after all words.
        fence(Ordering::Acquire);
        let is_whole = version.is_multiple_of(2) && self.version.load(Ordering::Relaxed) == version;
        is_whole.then_some(words)
    }
}
