//! The host's end of a board's wire, without a port and a clock: bytes and times in, bytes and events out. It
//! sends, waits and repeats requests for every program that talks to a board.

use std::collections::VecDeque;
use std::num::NonZeroU32;
use std::time::Duration;

use haptic_servo::host::HostTorque;
use haptic_servo::servo::Step;
use haptic_servo::servo_loop::Frame;
use haptic_servo::wire::description::Description;
use haptic_servo::wire::host::{HostReport, HostState};
use haptic_servo::wire::message::{
    ActiveParameters, BoardUnits, Id, LONGEST_TO_BOARD, LONGEST_TO_HOST, Outcome, PreviousFault,
    Refusal, Status, ToBoard, ToHost,
};
use haptic_servo::wire::{CHECKSUM, Decoder, Discarded, PROTOCOL, encode, largest_frame};
use thiserror::Error;

use super::OtherProtocol;
use super::request::{Reply, Request, RequestResult, no_host, refusal_in_words};
use super::timing::{QUERY, REQUEST, SILENCE, STATUS_INTERVAL};

/// A board that has identified itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Connected {
    /// Name of its program.
    pub program: String,
    /// The units of its numbers.
    pub units: BoardUnits,
    /// The fault that stopped it before its last start.
    pub previous_fault: Option<PreviousFault>,
    /// What a host's torque may do there, if the program takes one.
    pub budget: Option<HostTorque>,
}

/// A board's event.
#[derive(Clone, Debug)]
pub enum Event {
    /// A board has identified itself.
    Connected(Connected),
    /// Ticks.
    Ticks(Vec<Frame>),
    /// Its status, and the frames that the host could not read.
    Status(Status, Discarded),
    /// The active parameters.
    ActiveParameters(ActiveParameters),
    /// The running scene.
    Description(Box<Description>),
    /// The tick that took a host's torque.
    Host(HostState),
    /// The result of a request.
    Reply(Request, Reply),
    /// The link is lost, or the board has restarted without its settings: the conversation has to begin again.
    Lost(String),
}

/// Why a conversation has ended.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ClientError {
    /// A board of another version.
    #[error(transparent)]
    Protocol(#[from] OtherProtocol),
    /// No board has identified itself at this address.
    #[error(
        "no board answers on {} within {} s: is it powered, flashed with a scene's program, and is \
         this its port?",
        .0,
        QUERY.end.as_secs_f64()
    )]
    Silent(String),
    /// The board at this address has stopped answering.
    #[error(
        "the board on {} has not answered the request for its status within {} s",
        .0,
        SILENCE.as_secs_f64()
    )]
    Unanswered(String),
}

/// A conversation with a board.
pub struct Client {
    address: String,
    decoder: Decoder<{ LONGEST_TO_HOST + CHECKSUM }>,
    outgoing: Vec<u8>,
    events: VecDeque<Event>,
    last_id: Id,
    greeting: Option<Greeting>,
    heard: Duration,
    /// When the status is requested next, if the board is watched.
    beat: Option<Duration>,
    status: Option<Status>,
    /// The active parameters, once they are known.
    pub parameters: Option<ActiveParameters>,
    /// The running scene, once it is known.
    pub description: Option<Description>,
    /// What its host may do now, if it has one.
    pub budget: Option<HostTorque>,
    pending: Option<Pending>,
}

/// A board before it has identified itself.
struct Greeting {
    program: Option<String>,
    previous_fault: Option<PreviousFault>,
    again: Duration,
    end: Duration,
}

/// An unanswered request.
struct Pending {
    id: Id,
    request: Request,
    again: Duration,
    end: Duration,
    /// The step that has refused it, while the words for that are missing.
    refused: Option<Step>,
}

/// A message as it goes over the wire.
pub fn frame(message: &ToBoard) -> Vec<u8> {
    let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
    // The buffer has room for the longest message.
    encode(message, &mut buffer).unwrap_or_default().to_vec()
}

impl Client {
    /// Greets the board at an address. `id` should not have been used by an earlier client.
    pub fn start(address: String, id: Id, now: Duration) -> Self {
        let (again, end) = (now + QUERY.again, now + QUERY.end);
        let greeting = Greeting { program: None, previous_fault: None, again, end };
        Self {
            address,
            decoder: Decoder::new(),
            outgoing: frame(&ToBoard::Hello),
            events: VecDeque::new(),
            last_id: id,
            greeting: Some(greeting),
            heard: now,
            beat: None,
            status: None,
            parameters: None,
            description: None,
            budget: None,
            pending: None,
        }
    }

    /// Address of the board.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Bytes to the board since the last call.
    pub fn take_outgoing(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.outgoing)
    }

    /// The next event.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Invalid frames from the board.
    pub fn discarded(&self) -> Discarded {
        self.decoder.discarded()
    }

    /// Takes bytes from the board.
    ///
    /// # Errors
    /// The reason why this board cannot be used.
    pub fn receive(&mut self, bytes: &[u8], now: Duration) -> Result<(), ClientError> {
        for &byte in bytes {
            if let Some(message) = self.decoder.push::<ToHost<String>>(byte) {
                match self.greeting {
                    Some(_) => self.take_greeting(message, now)?,
                    None => self.take_news(message, now),
                }
            }
        }
        Ok(())
    }

    /// Sends the messages that are due.
    ///
    /// # Errors
    /// If the board has been silent for too long.
    pub fn tick(&mut self, now: Duration) -> Result<(), ClientError> {
        if let Some(greeting) = &mut self.greeting {
            if now >= greeting.end {
                return Err(ClientError::Silent(self.address.clone()));
            }
            if now >= greeting.again {
                greeting.again = now + QUERY.again;
                self.send(&ToBoard::Hello);
            }
            return Ok(());
        }
        if let Some(beat) = self.beat {
            if now.saturating_sub(self.heard) > SILENCE {
                return Err(ClientError::Unanswered(self.address.clone()));
            }
            if beat <= now {
                self.beat = Some(now + STATUS_INTERVAL);
                self.send(&ToBoard::Status);
                self.send_missing();
            }
        }
        self.repeat(now);
        Ok(())
    }

    /// Has the board send one of so many ticks, and keeps its state here up to date.
    pub fn watch(&mut self, every: NonZeroU32, now: Duration) {
        (self.beat, self.heard) = (Some(now), now);
        self.send(&ToBoard::Stream(Some(every)));
        self.send_missing();
    }

    /// Ends [`Self::watch`].
    pub fn unwatch(&mut self) {
        self.beat = None;
        self.send(&ToBoard::Stream(None));
    }

    /// Sends a request, one at a time, except that disarming never waits.
    pub fn request(&mut self, request: Request, now: Duration) -> Result<(), Reply> {
        self.check_free(&request)?;
        self.give_up();
        let id = self.last_id.wrapping_add(1);
        let Some(message) = request.message(id, self.budget) else {
            return Err(Reply::Answered(no_host()));
        };
        self.last_id = id;
        self.send(&message);
        self.events.push_back(Event::Reply(request.clone(), Reply::Asked));
        let (again, end) = (now + REQUEST.again, now + REQUEST.end);
        self.pending = Some(Pending { id, request, again, end, refused: None });
        Ok(())
    }

    /// Checks that a request can be sent.
    pub fn check_free(&self, request: &Request) -> Result<(), Reply> {
        if self.greeting.is_some() {
            return Err(Reply::NoLink);
        }
        let waits = self.pending.is_some() && *request != Request::Disarm;
        if waits { Err(Reply::Busy) } else { Ok(()) }
    }

    /// Gives up waiting for an answer, and reports it.
    pub fn give_up(&mut self) {
        if let Some(Pending { request, .. }) = self.pending.take() {
            self.events.push_back(Event::Reply(request, Reply::Unanswered));
        }
    }

    /// Sends a message that is not repeated.
    pub fn send(&mut self, message: &ToBoard) {
        self.outgoing.extend(frame(message));
    }

    /// Requests parameters and description, if they are missing: bytes get lost.
    fn send_missing(&mut self) {
        if self.parameters.is_none() {
            self.send(&ToBoard::Get);
        }
        if self.description.is_none() {
            self.send(&ToBoard::Describe);
        }
    }

    fn repeat(&mut self, now: Duration) {
        if self.pending.as_ref().is_some_and(|pending| now >= pending.end) {
            self.give_up();
        }
        let Some(pending) = self.pending.as_mut().filter(|pending| now >= pending.again) else {
            return;
        };
        pending.again = now + REQUEST.again;
        if pending.refused.is_some() {
            pending.again = now + QUERY.again;
            self.send_missing();
        } else {
            let message = pending.request.message(pending.id, self.budget);
            message.iter().for_each(|message| self.send(message));
        }
    }

    fn take_greeting(&mut self, message: ToHost<String>, now: Duration) -> Result<(), ClientError> {
        let Some(greeting) = &mut self.greeting else { return Ok(()) };
        match message {
            ToHost::Welcome { protocol: PROTOCOL, program } => greeting.program = Some(program),
            ToHost::Welcome { protocol: theirs, program } => {
                let address = self.address.clone();
                return Err(OtherProtocol { address, program, theirs }.into());
            }
            ToHost::PreviousFault(fault) => greeting.previous_fault = Some(fault),
            ToHost::Host(HostReport::Budget(budget)) => self.budget = Some(budget),
            // The last part of the greeting.
            ToHost::Board(units) => {
                if let Some(program) = greeting.program.take() {
                    let (previous_fault, budget) = (greeting.previous_fault, self.budget);
                    let connected = Connected { program, units, previous_fault, budget };
                    self.events.push_back(Event::Connected(connected));
                    (self.greeting, self.heard) = (None, now);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn take_news(&mut self, message: ToHost<String>, now: Duration) {
        self.heard = now;
        match message {
            ToHost::Telemetry(batch) => {
                self.events.push_back(Event::Ticks(batch.ticks().collect()));
            }
            ToHost::Status(status) => {
                let last = self.status.replace(status);
                if last.is_some_and(|last| status.tick.wrapping_sub(last.tick) > u32::MAX / 2) {
                    self.events.push_back(Event::Lost("the board was started again".to_owned()));
                    return;
                }
                self.events.push_back(Event::Status(status, self.discarded()));
                // Another client changed the parameters.
                if last.is_some_and(|last| last.sets != status.sets) {
                    self.refresh();
                }
            }
            ToHost::ActiveParameters(parameters) => {
                self.parameters = Some(parameters.clone());
                self.events.push_back(Event::ActiveParameters(parameters));
                self.explain();
            }
            ToHost::Described(description) => {
                self.description = Some(description);
                self.events.push_back(Event::Description(Box::new(description)));
                self.explain();
            }
            ToHost::Answer { id, outcome } => self.take_answer(id, outcome, now),
            ToHost::Host(HostReport::State(state)) => self.events.push_back(Event::Host(state)),
            ToHost::Host(HostReport::Budget(budget)) => self.budget = Some(budget),
            // Replies to a repeated hello.
            ToHost::Welcome { .. } | ToHost::PreviousFault(_) | ToHost::Board(_) => {}
        }
    }

    fn take_answer(&mut self, id: Id, outcome: Outcome, now: Duration) {
        let Some(pending) = self.pending.as_mut().filter(|pending| pending.id == id) else {
            return;
        };
        if let Outcome::Refused(Refusal::Set(step)) = outcome {
            pending.refused = Some(step);
            (pending.again, pending.end) = (now + QUERY.again, now + QUERY.end);
            self.send_missing();
            self.explain();
        } else {
            self.answer(outcome.into());
        }
    }

    /// Answers a refused set in words, once the scene that it was for is known: it is judged again here, with the
    /// remedies that a board has no room to look for.
    fn explain(&mut self) {
        if let Some(Pending { request, refused: Some(step), .. }) = &self.pending
            && let Some((description, parameters)) =
                self.description.as_ref().zip(self.parameters.as_ref())
        {
            let result = refusal_in_words(*step, request, self.budget, description, parameters);
            self.answer(result);
        }
    }

    fn answer(&mut self, result: RequestResult) {
        if let Some(Pending { request, .. }) = self.pending.take() {
            self.events.push_back(Event::Reply(request, Reply::Answered(result)));
            self.refresh();
        }
    }

    /// Requests what an answer or another client may have changed, if the board is watched.
    fn refresh(&mut self) {
        if self.beat.is_some() {
            self.send(&ToBoard::Get);
            self.send(&ToBoard::Describe);
        }
    }
}
