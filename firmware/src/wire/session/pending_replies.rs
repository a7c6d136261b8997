//! Replies to the host that are not sent yet. Each kind has its own place, so that memory does not grow and a
//! flood of one kind takes no place from another: an accepted request keeps its place until its answer is on
//! its way.

use heapless::{Deque, Vec};

use crate::servo_loop::{Reply, Status};
use crate::wire::message::{FaultCode, Id, Outcome, Refusal};

/// The largest number of refusals that are kept, and of requests to disarm; the oldest is discarded first.
const WAITING: usize = 4;

/// Replies to the host that are not sent yet.
#[derive(Default)]
pub(super) struct PendingReplies {
    greeting: Option<Greeting>,
    /// Another greeting was requested during this one.
    greet_again: bool,
    /// The values of the active parameters were requested.
    pub parameters: bool,
    /// The description of the active scene was requested.
    pub description: bool,
    /// The number of the servo's status that was requested.
    pub status_number: Option<u32>,
    /// The servo's status.
    pub status: Option<Status>,
    pub arming: Switching,
    pub alignment: Switching,
    pub disarming: Disarming,
    /// The answer to the accepted set.
    pub set: Option<(Id, Outcome)>,
    refusals: Deque<(Id, Outcome), WAITING>,
}

/// The parts of a greeting, in their order.
#[derive(Clone, Copy)]
pub(super) enum Greeting {
    Welcome,
    PreviousFault,
    Board,
}

impl PendingReplies {
    /// Starts a greeting, or another one after the present one: a host that repeats its request faster than
    /// the wire carries a greeting must not keep it from its end.
    pub(super) const fn greet(&mut self) {
        match self.greeting {
            None => self.greeting = Some(Greeting::Welcome),
            Some(Greeting::Welcome) => {}
            Some(Greeting::PreviousFault | Greeting::Board) => self.greet_again = true,
        }
    }

    /// The next part of a greeting, and whether it is the last.
    pub(super) fn greeting(&mut self) -> Option<(Greeting, bool)> {
        let part = self.greeting?;
        self.greeting = match part {
            Greeting::Welcome => Some(Greeting::PreviousFault),
            Greeting::PreviousFault => Some(Greeting::Board),
            Greeting::Board => core::mem::take(&mut self.greet_again).then_some(Greeting::Welcome),
        };
        Some((part, matches!(part, Greeting::Board)))
    }

    /// Takes a request to arm, or refuses it while a request to disarm is pending or another one to arm.
    pub(super) fn arm(&mut self, id: Id, request: impl FnOnce() -> u32) {
        let opened = self.arming.open(id, self.disarming.is_open(), request);
        opened.unwrap_or_else(|refusal| self.refuse(id, refusal));
    }

    /// Takes a request to align the motor, with the same exceptions.
    pub(super) fn align(&mut self, id: Id, request: impl FnOnce() -> u32) {
        let opened = self.alignment.open(id, self.disarming.is_open(), request);
        opened.unwrap_or_else(|refusal| self.refuse(id, refusal));
    }

    /// Takes a request to disarm, which is never refused and overrules the others. `number` is its number.
    pub(super) fn disarm(&mut self, id: Id, number: u32) {
        self.arming.overrule();
        self.alignment.overrule();
        self.disarming.open(id, number);
    }

    pub(super) fn refuse(&mut self, id: Id, refusal: Refusal) {
        if self.refusals.is_full() {
            let _ = self.refusals.pop_front();
        }
        let _ = self.refusals.push_back((id, Outcome::Refused(refusal)));
    }

    #[cfg(test)]
    pub(super) fn is_empty(&self) -> bool {
        let Self { greeting, parameters, description, status_number, status, .. } = self;
        let has_question = *parameters || *description || status_number.is_some();
        let has_request =
            self.arming.0.is_some() || self.alignment.0.is_some() || self.disarming.is_open();
        let has_answer = self.set.is_some() || status.is_some() || !self.refusals.is_empty();
        greeting.is_none() && !has_question && !has_request && !has_answer
    }

    pub(super) fn refusal(&mut self) -> Option<(Id, Outcome)> {
        self.refusals.pop_front()
    }
}

/// A request to arm or to align, until its answer is on its way.
#[derive(Default)]
pub(super) struct Switching(Option<Open>);

struct Open {
    id: Id,
    number: u32,
    outcome: Option<Outcome>,
}

impl Switching {
    fn open(
        &mut self,
        id: Id,
        is_overruled: bool,
        request: impl FnOnce() -> u32,
    ) -> Result<(), Refusal> {
        match &self.0 {
            // A host repeats a request because the answer takes a while.
            Some(open) if open.id == id => Ok(()),
            _ if is_overruled => Err(Refusal::Disarming),
            Some(_) => Err(Refusal::Busy),
            None => {
                self.0 = Some(Open { id, number: request(), outcome: None });
                Ok(())
            }
        }
    }

    fn overrule(&mut self) {
        if let Some(open) = &mut self.0 {
            open.outcome.get_or_insert(Outcome::Refused(Refusal::Disarming));
        }
    }

    /// Compares the servo's last reply with the request; `refusal` is that for a fault.
    pub(super) fn compare(
        &mut self,
        last: Option<(u32, Reply)>,
        refusal: impl FnOnce(Option<FaultCode>) -> Refusal,
    ) {
        if let (Some(open), Some((number, reply))) = (&mut self.0, last)
            && open.number == number
        {
            open.outcome.get_or_insert_with(|| match reply {
                Reply::Done => Outcome::Done,
                Reply::Fault(fault) => Outcome::Refused(refusal(Some(fault.into()))),
                Reply::Armed => Outcome::Refused(refusal(None)),
                Reply::Disarming => Outcome::Refused(Refusal::Disarming),
            });
        }
    }

    /// The answer, after which the next request is accepted.
    pub(super) fn answer(&mut self) -> Option<(Id, Outcome)> {
        let answered = self.0.take_if(|open| open.outcome.is_some())?;
        Some((answered.id, answered.outcome?))
    }
}

/// The requests to disarm, until their answers are on their way. All of them get the same answer.
#[derive(Default)]
pub(super) struct Disarming {
    ids: Vec<Id, WAITING>,
    /// The first one's number in the mailbox.
    number: u32,
    is_off: bool,
}

impl Disarming {
    fn is_open(&self) -> bool {
        !self.ids.is_empty()
    }

    fn open(&mut self, id: Id, number: u32) {
        if self.ids.is_empty() {
            (self.number, self.is_off) = (number, false);
        }
        if self.ids.contains(&id) {
            return;
        }
        if self.ids.is_full() {
            self.ids.remove(0);
        }
        let _ = self.ids.push(id);
    }

    /// Compares the last request after which the amplifier was off with these.
    pub(super) const fn compare(&mut self, off: u32) {
        self.is_off |= off.wrapping_sub(self.number).cast_signed() >= 0;
    }

    /// The next answer. Until the last one is taken, no request to arm is accepted: the amplifier stays off.
    pub(super) fn answer(&mut self) -> Option<(Id, Outcome)> {
        let is_answered = self.is_off && self.is_open();
        is_answered.then(|| (self.ids.remove(0), Outcome::Done))
    }
}
