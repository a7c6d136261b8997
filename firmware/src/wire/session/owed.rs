//! What the host is still to be told. Of each kind there is a fixed number: asking faster than the
//! wire can answer costs answers, not memory.

use core::fmt;

use heapless::Deque;

use crate::cycle::Status;
use crate::fault::Fault;
use crate::wire::message::Id;

/// Answers that wait.
const ANSWERS: usize = 4;

/// What the host is still to be told.
#[derive(Default)]
pub(super) struct Owed {
    greeting: Option<Greeting>,
    /// Which numbers run.
    pub running: bool,
    /// How it is going.
    pub status: Option<Status>,
    /// Who asked for the amplifier to be switched on or off, where the servo has not said yet.
    switching: Option<(Id, bool)>,
    answers: Deque<(Id, Result<(), Refusal>), ANSWERS>,
}

/// The parts of a greeting, in their order.
#[derive(Clone, Copy)]
pub(super) enum Greeting {
    Welcome,
    Remembered,
    Board,
}

/// Why a request is refused that is not a matter of its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// One set at a time.
    Busy,
    /// It is to be disarmed, which goes first.
    Disarming,
    /// What stopped the servo is still there.
    Fault(Fault),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Busy => f.write_str(
                "the set of parameters before this one is still being swapped in: wait for its \
                 answer",
            ),
            Self::Disarming => f.write_str("not armed: it is being disarmed; arm it after that"),
            Self::Fault(fault) => write!(f, "not armed: {fault}"),
        }
    }
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
            self.answer(id, outcome.map_err(Refusal::Fault));
        }
    }

    /// A request was done.
    pub(super) fn done(&mut self, id: Id) {
        self.answer(id, Ok(()));
    }

    /// A request is refused.
    pub(super) fn refuse(&mut self, id: Id, refusal: Refusal) {
        self.answer(id, Err(refusal));
    }

    /// The next answer.
    pub(super) fn next_answer(&mut self) -> Option<(Id, Result<(), Refusal>)> {
        self.answers.pop_front()
    }

    fn answer(&mut self, id: Id, outcome: Result<(), Refusal>) {
        if self.answers.is_full() {
            // Whoever asked so long ago has stopped waiting.
            let _ = self.answers.pop_front();
        }
        let _ = self.answers.push_back((id, outcome));
    }
}
