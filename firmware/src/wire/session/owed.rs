//! What the host is still to be told. Of each kind there is a fixed number: asking faster than the
//! wire can answer costs answers, not memory.

use heapless::Deque;

use crate::cycle::Status;
use crate::fault::Fault;
use crate::wire::message::{Id, Outcome, Refusal};

/// Answers that wait.
const ANSWERS: usize = 4;

/// What the host is still to be told.
#[derive(Default)]
pub(super) struct Owed {
    greeting: Option<Greeting>,
    /// Which numbers run.
    pub running: bool,
    /// What exactly runs.
    pub description: bool,
    /// How it is going.
    pub status: Option<Status>,
    /// Who asked for the amplifier to be switched on or off, where the servo has not said yet.
    switching: Option<(Id, bool)>,
    answers: Deque<(Id, Outcome), ANSWERS>,
}

/// The parts of a greeting, in their order.
#[derive(Clone, Copy)]
pub(super) enum Greeting {
    Welcome,
    Remembered,
    Board,
}

impl Owed {
    /// Owes a greeting, from its beginning.
    pub(super) const fn greet(&mut self) {
        self.greeting = Some(Greeting::Welcome);
    }

    /// The next part of a greeting.
    pub(super) fn greeting(&mut self) -> Option<Greeting> {
        let part = self.greeting?;
        self.greeting = match part {
            Greeting::Welcome => Some(Greeting::Remembered),
            Greeting::Remembered => Some(Greeting::Board),
            Greeting::Board => None,
        };
        Some(part)
    }

    /// Somebody asked for the amplifier to be switched on. Gives whether the servo may be asked:
    /// not while it is to be switched off.
    pub(super) fn arm(&mut self, id: Id) -> bool {
        if let Some((_, false)) = self.switching {
            self.refuse(id, Refusal::Disarming);
            return false;
        }
        self.switching = Some((id, true));
        true
    }

    /// Somebody asked for the amplifier to be switched off, which is never refused.
    pub(super) fn disarm(&mut self, id: Id) {
        if let Some((before, true)) = self.switching.replace((id, false)) {
            self.refuse(before, Refusal::Disarming);
        }
    }

    /// The servo has switched the amplifier, or says why it has not.
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
            // Whoever asked so long ago has stopped waiting.
            let _ = self.answers.pop_front();
        }
        let _ = self.answers.push_back((id, outcome));
    }
}
