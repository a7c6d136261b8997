//! A board that answers.

use std::io;
use std::num::NonZeroU32;
use std::time::{Duration, Instant};

use haptic_model::board::client::{Client, ClientError, Connected, Event};
use haptic_model::board::request::{Reply, Request, RequestResult};
use haptic_model::board::sample::{Sample, Scale};
use haptic_model::board::timing::{QUERY, REQUEST, SILENCE};
use haptic_servo::wire::Discarded;
use haptic_servo::wire::description::Description;
use haptic_servo::wire::message::{ActiveParameters, Changes, Status, ToBoard};

use super::transport::{self, Transport, read_within};
use super::{Address, LinkError};

/// A connection to a board that has identified itself.
pub struct Link {
    wire: Wire,
    board: Connected,
}

/// A conversation over a port.
pub(crate) struct Wire {
    address: Address,
    transport: Box<dyn Transport>,
    pub client: Client,
    /// The client's time zero.
    began: Instant,
    bytes: Box<[u8; 4096]>,
}

impl Link {
    /// Connects and says hello.
    ///
    /// # Errors
    /// The address cannot be opened, no board answers, or its protocol version differs.
    pub fn open(address: &Address) -> Result<Self, LinkError> {
        let mut wire = Wire::open(address)?;
        loop {
            // The client gives up by itself.
            match wire.next(Instant::now() + QUERY.again) {
                Ok(Some(Event::Connected(board))) => return Ok(Self { wire, board }),
                Ok(_) => {}
                Err(error) => return Err(error.before_an_answer()),
            }
        }
    }

    /// The board's address.
    pub fn address(&self) -> &Address {
        &self.wire.address
    }

    /// The board's own description.
    pub fn board(&self) -> &Connected {
        &self.board
    }

    /// Invalid frames from the board.
    pub fn discarded(&self) -> Discarded {
        self.wire.client.discarded()
    }

    /// Sends a request, and waits for the board's answer to it.
    ///
    /// # Errors
    /// The link is lost, or there is no answer in time.
    pub fn request(&mut self, request: Request) -> Result<RequestResult, LinkError> {
        let what = match request {
            Request::Set(_) | Request::Budget(_) => "the change of its parameters",
            Request::Arm => "the request to arm",
            Request::Align => "the request to align the motor",
            Request::Disarm => "the request to disarm",
        };
        // A refused set is explained by the scene of then.
        let now = self.wire.now();
        let client = &mut self.wire.client;
        (client.description, client.parameters) = (None, None);
        let mut reply = client.request(request, now).err();
        loop {
            match reply {
                Some(Reply::Answered(result)) => {
                    self.board.budget = self.wire.client.budget;
                    return Ok(result);
                }
                None | Some(Reply::Asked) => {}
                Some(_) => return Err(self.wire.unanswered(what, REQUEST.end)),
            }
            reply = match self.wire.next(Instant::now() + QUERY.again)? {
                Some(Event::Reply(_, reply)) => Some(reply),
                _ => None,
            };
        }
    }

    /// Changes these numbers, all or none, and waits until they run.
    ///
    /// # Errors
    /// As for [`Self::request`].
    pub fn set(&mut self, changes: Changes) -> Result<RequestResult, LinkError> {
        self.request(Request::Set(changes))
    }

    /// Switches the amplifier on, or clears a fault and does so.
    ///
    /// # Errors
    /// As for [`Self::request`].
    pub fn arm(&mut self) -> Result<RequestResult, LinkError> {
        self.request(Request::Arm)
    }

    /// Fades the torque out and switches the amplifier off.
    ///
    /// # Errors
    /// As for [`Self::request`].
    pub fn disarm(&mut self) -> Result<RequestResult, LinkError> {
        self.request(Request::Disarm)
    }

    /// The scene that runs, with all numbers of its servo.
    ///
    /// # Errors
    /// The link is lost, or there is no answer in time.
    pub fn description(&mut self) -> Result<Description, LinkError> {
        self.wire.ask("the request for its description", &ToBoard::Describe, |event| match event {
            Event::Description(description) => Some(*description),
            _ => None,
        })
    }

    /// The active parameters.
    ///
    /// # Errors
    /// As for [`Self::description`].
    pub fn parameters(&mut self) -> Result<ActiveParameters, LinkError> {
        self.wire.ask("the request for its parameters", &ToBoard::Get, |event| match event {
            Event::ActiveParameters(parameters) => Some(parameters),
            _ => None,
        })
    }

    /// The board's status.
    ///
    /// # Errors
    /// As for [`Self::description`].
    pub fn status(&mut self) -> Result<Status, LinkError> {
        self.wire.ask("the request for its status", &ToBoard::Status, |event| match event {
            Event::Status(status, _) => Some(status),
            _ => None,
        })
    }

    /// Receives one of `every` ticks for this time and passes each to `each`, which ends it by `false`.
    ///
    /// # Errors
    /// The link is lost, or the board has stopped sending.
    pub fn telemetry(
        &mut self,
        duration: Duration,
        every: NonZeroU32,
        mut each: impl FnMut(&Sample) -> bool,
    ) -> Result<(), LinkError> {
        let mut scale = Scale::new(self.board.units);
        let end = Instant::now() + duration;
        self.wire.watch(every);
        let mut goes_on = true;
        while goes_on && let Some(event) = self.wire.next(end)? {
            match event {
                Event::Ticks(frames) => {
                    goes_on = frames.iter().all(|frame| each(&scale.sample(frame)));
                }
                Event::Lost(_) => return Err(self.wire.restarted()),
                _ => {}
            }
        }
        self.wire.unwatch()
    }

    pub(crate) fn wire(&mut self) -> &mut Wire {
        &mut self.wire
    }

    /// The conversation, to carry it on.
    pub(crate) fn into_wire(self) -> Wire {
        self.wire
    }
}

impl Wire {
    fn open(address: &Address) -> Result<Self, LinkError> {
        let transport = transport::open(address)
            .map_err(|source| LinkError::Open { address: address.clone(), source })?;
        // Starts at random, so that a reply to an earlier client is not taken for ours.
        let client = Client::start(address.to_string(), fastrand::u16(..), Duration::ZERO);
        let (address, bytes) = (address.clone(), Box::new([0; 4096]));
        Ok(Self { address, transport, client, began: Instant::now(), bytes })
    }

    /// The client's time.
    pub fn now(&self) -> Duration {
        self.began.elapsed()
    }

    /// Has the board send one of so many ticks, and its status now and then.
    pub fn watch(&mut self, every: NonZeroU32) {
        let now = self.now();
        self.client.watch(every, now);
    }

    /// Ends [`Self::watch`].
    pub fn unwatch(&mut self) -> Result<(), LinkError> {
        self.client.unwatch();
        self.flush()
    }

    /// Waits for bytes until a time at the latest, and sends the messages that are due then. It reads first: the
    /// bytes that came while this process did not run are no silence.
    pub fn carry(&mut self, until: Instant) -> Result<(), LinkError> {
        let received = self.exchange(until)?;
        let now = self.now();
        self.client
            .receive(&self.bytes[..received], now)
            .and_then(|()| self.client.tick(now))
            .map_err(|error| self.ended(error))?;
        self.flush()
    }

    /// Sends the waiting bytes; returns the number of received bytes.
    fn exchange(&mut self, until: Instant) -> Result<usize, LinkError> {
        self.flush()?;
        let left = until.saturating_duration_since(Instant::now());
        read_within(self.transport.as_mut(), self.bytes.as_mut_slice(), left)
            .map_err(|source| self.lost(source))
    }

    /// Sends the waiting bytes.
    pub fn flush(&mut self) -> Result<(), LinkError> {
        let bytes = self.client.take_outgoing();
        if bytes.is_empty() {
            return Ok(());
        }
        let sent = self.transport.write_all(&bytes).and_then(|()| self.transport.flush());
        sent.map_err(|source| self.lost(source))
    }

    /// The next event, if there is one before a time.
    pub fn next(&mut self, until: Instant) -> Result<Option<Event>, LinkError> {
        loop {
            if let Some(event) = self.client.next_event() {
                return Ok(Some(event));
            }
            if Instant::now() >= until {
                return Ok(None);
            }
            self.carry(until)?;
        }
    }

    /// Repeats a question until `wanted` accepts an event, or the time is up.
    fn ask<T>(
        &mut self,
        what: &'static str,
        question: &ToBoard,
        wanted: impl Fn(Event) -> Option<T>,
    ) -> Result<T, LinkError> {
        let end = Instant::now() + QUERY.end;
        while Instant::now() < end {
            self.client.send(question);
            let again = (Instant::now() + QUERY.again).min(end);
            while let Some(event) = self.next(again)? {
                if let Some(answer) = wanted(event) {
                    return Ok(answer);
                }
            }
        }
        Err(self.unanswered(what, QUERY.end))
    }

    /// The link is lost because the board was started again.
    pub fn restarted(&self) -> LinkError {
        self.lost(io::Error::other("the board was started again"))
    }

    fn lost(&self, source: io::Error) -> LinkError {
        LinkError::Lost { address: self.address.clone(), source }
    }

    fn ended(&self, error: ClientError) -> LinkError {
        match error {
            ClientError::Protocol(error) => error.into(),
            ClientError::Silent { .. } => {
                LinkError::Silent { address: self.address.clone(), after: QUERY.end }
            }
            ClientError::Unanswered { .. } => {
                self.unanswered("the request for its status", SILENCE)
            }
        }
    }

    /// A message has no answer.
    pub fn unanswered(&self, what: &'static str, after: Duration) -> LinkError {
        LinkError::Unanswered { address: self.address.clone(), what, after }
    }
}
