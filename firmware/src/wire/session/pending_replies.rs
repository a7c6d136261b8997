//! Replies to the host that are not sent yet. The number of each kind is fixed: a host that sends requests
//! faster than the wire can answer loses replies, and memory does not grow.

use heapless::Deque;

use crate::fault::Fault;
use crate::servo_loop::Status;
use crate::wire::message::{Id, Outcome, Refusal};

/// The largest number of answers that are kept; the oldest is discarded first.
const ANSWERS: usize = 4;

/// Replies to the host that are not sent yet.
#[derive(Default)]
pub(super) struct PendingReplies {
    greeting: Option<Greeting>,
    /// The values of the active parameters were requested.
    pub parameters: bool,
    /// The description of the active scene was requested.
    pub description: bool,
    /// The servo's requested status.
    pub status: Option<Status>,
    /// The request to switch the amplifier on (`true`) or off that the servo has not confirmed yet.
    switching: Option<(Id, bool)>,
    /// The request to align the motor that the servo has not answered yet.
    aligning: Option<Id>,
    answers: Deque<(Id, Outcome), ANSWERS>,
}

/// The parts of a greeting, in their order.
#[derive(Clone, Copy)]
pub(super) enum Greeting {
    Welcome,
    PreviousFault,
    Board,
}

impl PendingReplies {
    /// Starts the greeting from its beginning.
    pub(super) const fn greet(&mut self) {
        self.greeting = Some(Greeting::Welcome);
    }

    /// The next part of a greeting.
    pub(super) fn greeting(&mut self) -> Option<Greeting> {
        let part = self.greeting?;
        self.greeting = match part {
            Greeting::Welcome => Some(Greeting::PreviousFault),
            Greeting::PreviousFault => Some(Greeting::Board),
            Greeting::Board => None,
        };
        Some(part)
    }

    /// Records a request to switch the amplifier on. Returns whether it may be passed to the servo: not while
    /// a request to switch it off is pending.
    pub(super) fn arm(&mut self, id: Id) -> bool {
        if let Some((_, false)) = self.switching {
            self.refuse(id, Refusal::Disarming);
            return false;
        }
        self.switching = Some((id, true));
        true
    }

    /// Records a request to switch the amplifier off, which is never refused.
    pub(super) fn disarm(&mut self, id: Id) {
        if let Some((before, true)) = self.switching.replace((id, false)) {
            self.refuse(before, Refusal::Disarming);
        }
    }

    /// The servo has switched the amplifier, or refused with a fault.
    pub(super) fn switched(&mut self, on: bool, outcome: Result<(), Fault>) {
        if let Some((id, wanted)) = self.switching
            && wanted == on
        {
            self.switching = None;
            self.answer(
                id,
                match outcome {
                    Ok(()) => Outcome::Done,
                    Err(fault) => Outcome::Refused(Refusal::Fault(fault.into())),
                },
            );
        }
    }

    /// Records a request to align the motor; an earlier unanswered request gets the same answer.
    pub(super) fn align(&mut self, id: Id) {
        self.aligning = Some(id);
    }

    /// The alignment has begun, or not.
    pub(super) fn aligning(&mut self, outcome: Outcome) {
        if let Some(id) = self.aligning.take() {
            self.answer(id, outcome);
        }
    }

    /// A request was done.
    pub(super) fn done(&mut self, id: Id) {
        self.answer(id, Outcome::Done);
    }

    /// A request is refused.
    pub(super) fn refuse(&mut self, id: Id, refusal: Refusal) {
        self.answer(id, Outcome::Refused(refusal));
    }

    /// The next answer.
    pub(super) fn next_answer(&mut self) -> Option<(Id, Outcome)> {
        self.answers.pop_front()
    }

    fn answer(&mut self, id: Id, outcome: Outcome) {
        if self.answers.is_full() {
            // The oldest request has timed out at the host.
            let _ = self.answers.pop_front();
        }
        let _ = self.answers.push_back((id, outcome));
    }
}
