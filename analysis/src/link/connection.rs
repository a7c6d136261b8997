//! A board that answers.

use std::io;
use std::time::{Duration, Instant};

use haptic_servo::wire::description::Description;
use haptic_servo::wire::message::{
    ActiveParameters, BoardUnits, Changes, Id, LONGEST_TO_BOARD, LONGEST_TO_HOST, Outcome,
    PreviousFault, Refusal, Status, ToBoard, ToHost,
};
use haptic_servo::wire::{CHECKSUM, Decoder, Discarded, PROTOCOL, encode, largest_frame};

use haptic_model::board::OtherProtocol;
use haptic_model::board::request::{RequestResult, refusal_in_words};
use haptic_model::board::timing::{QUERY, REQUEST, RetryTiming};

use super::transport::{self, Transport, is_timeout};
use super::{Address, LinkError};

/// A message of a board that owns its text.
pub type Message = ToHost<String>;

/// A connection to a board that has identified itself.
pub struct Link {
    address: Address,
    wire: Wire,
    program: String,
    board: BoardUnits,
    previous_fault: Option<PreviousFault>,
    /// Starts at random, so that a reply to an earlier client is not taken for ours.
    last_id: Id,
}

/// Messages over a transport.
struct Wire {
    transport: Box<dyn Transport>,
    decoder: Decoder<{ LONGEST_TO_HOST + CHECKSUM }>,
    /// Bytes that were read; `filled` is their number, `used` the number of decoded bytes.
    bytes: Box<[u8; 4096]>,
    filled: usize,
    used: usize,
}

impl Wire {
    fn send(&mut self, message: &ToBoard) -> io::Result<()> {
        let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
        let frame = encode(message, &mut buffer).map_err(io::Error::other)?;
        self.transport.write_all(frame)?;
        self.transport.flush()
    }

    /// The next message; `None` if there is none before the time is up.
    fn receive(&mut self, until: Instant) -> io::Result<Option<Message>> {
        loop {
            while self.used < self.filled {
                let byte = self.bytes[self.used];
                self.used += 1;
                if let Some(message) = self.decoder.push(byte) {
                    return Ok(Some(message));
                }
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            // No operating system takes a timeout of zero.
            self.transport.wait_at_most(left.max(Duration::from_millis(1)))?;
            match self.transport.read(self.bytes.as_mut_slice()) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(filled) => (self.used, self.filled) = (0, filled),
                Err(error) if is_timeout(&error) => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Repeats a request until `wanted` accepts an answer, or the time is up.
    fn ask<T>(
        &mut self,
        question: &ToBoard,
        timing: RetryTiming,
        mut wanted: impl FnMut(Message) -> Option<T>,
    ) -> io::Result<Option<T>> {
        let end = Instant::now() + timing.end;
        while Instant::now() < end {
            self.send(question)?;
            let again = (Instant::now() + timing.again).min(end);
            while let Some(message) = self.receive(again)? {
                if let Some(answer) = wanted(message) {
                    return Ok(Some(answer));
                }
            }
        }
        Ok(None)
    }
}

/// Whether the other end has closed the connection.
fn is_closed(error: &io::Error) -> bool {
    use io::ErrorKind::{BrokenPipe, ConnectionReset, UnexpectedEof};
    matches!(error.kind(), BrokenPipe | ConnectionReset | UnexpectedEof)
}

impl Link {
    /// Connects and says hello.
    ///
    /// # Errors
    /// The address cannot be opened, no board answers, or its protocol version differs.
    pub fn open(address: &Address) -> Result<Self, LinkError> {
        let transport = transport::open(address)
            .map_err(|source| LinkError::Open { address: address.clone(), source })?;
        let (decoder, bytes) = (Decoder::new(), Box::new([0; 4096]));
        let mut wire = Wire { transport, decoder, bytes, filled: 0, used: 0 };
        let (mut welcome, mut previous_fault) = (None, None);
        let greeted = wire.ask(&ToBoard::Hello, QUERY, |message| match message {
            ToHost::Welcome { protocol, program } if protocol == PROTOCOL => {
                welcome = Some(program);
                None
            }
            ToHost::Welcome { protocol, program } => Some(Err((protocol, program))),
            ToHost::PreviousFault(fault) => {
                previous_fault = Some(fault);
                None
            }
            // The last part of the greeting.
            ToHost::Board(board) => welcome.take().map(|program| Ok((program, board))),
            _ => None,
        });
        let address = address.clone();
        match greeted {
            Ok(Some(Ok((program, board)))) => Ok(Self {
                address,
                wire,
                program,
                board,
                previous_fault,
                last_id: fastrand::u16(..),
            }),
            Ok(Some(Err((theirs, program)))) => {
                let address = address.to_string();
                Err(LinkError::Protocol(OtherProtocol { address, program, theirs }))
            }
            Ok(None) => Err(LinkError::Silent { address, after: QUERY.end }),
            // A socket reports it; a serial line is silent.
            Err(source) if is_closed(&source) && !matches!(address, Address::Serial { .. }) => {
                Err(LinkError::InUse { address })
            }
            Err(source) => Err(LinkError::Lost { address, source }),
        }
    }

    /// The board's address.
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// Name of the board's program.
    pub fn program(&self) -> &str {
        &self.program
    }

    /// The units of the board's numbers.
    pub fn board(&self) -> &BoardUnits {
        &self.board
    }

    /// The fault that stopped the board before its last start.
    pub fn previous_fault(&self) -> Option<PreviousFault> {
        self.previous_fault
    }

    /// Invalid frames from the board.
    pub fn discarded(&self) -> Discarded {
        self.wire.decoder.discarded()
    }

    /// Changes these numbers, all or none, and waits until they run.
    ///
    /// # Errors
    /// Where the board does not answer.
    pub fn set(&mut self, changes: Changes) -> Result<RequestResult, LinkError> {
        let set = |id| ToBoard::Set { id, changes: changes.clone() };
        let outcome = self.request("the change of its parameters", set)?;
        self.in_words(outcome, &changes)
    }

    /// The outcome of a request for these changes, in words. A refused set is judged again here, with the
    /// remedies that a board has no room to look for.
    ///
    /// # Errors
    /// Where the board does not answer.
    pub fn in_words(
        &mut self,
        outcome: Outcome,
        changes: &Changes,
    ) -> Result<RequestResult, LinkError> {
        if let Outcome::Refused(Refusal::Set(step)) = outcome {
            let (description, parameters) = (self.description()?, self.parameters()?);
            return Ok(refusal_in_words(step, changes, &description, &parameters));
        }
        Ok(outcome.into())
    }

    /// Switches the amplifier on, or clears a fault and does so.
    ///
    /// # Errors
    /// Where the board does not answer.
    pub fn arm(&mut self) -> Result<RequestResult, LinkError> {
        Ok(self.request("the request to arm", |id| ToBoard::Arm { id })?.into())
    }

    /// Has a motor board begin to align its brushless motor, which moves the handle.
    ///
    /// # Errors
    /// Where the board does not answer.
    pub fn align(&mut self) -> Result<RequestResult, LinkError> {
        Ok(self.request("the request to align the motor", |id| ToBoard::Align { id })?.into())
    }

    /// Fades the torque out and switches the amplifier off.
    ///
    /// # Errors
    /// Where the board does not answer.
    pub fn disarm(&mut self) -> Result<RequestResult, LinkError> {
        Ok(self.request("the request to disarm", |id| ToBoard::Disarm { id })?.into())
    }

    /// The scene that runs, with all numbers of its servo.
    ///
    /// # Errors
    /// Where the board does not answer.
    pub fn description(&mut self) -> Result<Description, LinkError> {
        self.ask("the request for its description", &ToBoard::Describe, QUERY, |message| {
            match message {
                ToHost::Described(description) => Some(description),
                _ => None,
            }
        })
    }

    /// The active parameters.
    ///
    /// # Errors
    /// Where the board does not answer.
    pub fn parameters(&mut self) -> Result<ActiveParameters, LinkError> {
        self.ask("the request for its parameters", &ToBoard::Get, QUERY, |message| match message {
            ToHost::ActiveParameters(parameters) => Some(parameters),
            _ => None,
        })
    }

    /// The board's status.
    ///
    /// # Errors
    /// Where the board does not answer.
    pub fn status(&mut self) -> Result<Status, LinkError> {
        self.ask("the request for its status", &ToBoard::Status, QUERY, |message| match message {
            ToHost::Status(status) => Some(status),
            _ => None,
        })
    }

    /// Sends a message that is not answered, or whose answer is taken with [`Self::receive`].
    ///
    /// # Errors
    /// Where the link is lost.
    pub fn send(&mut self, message: &ToBoard) -> Result<(), LinkError> {
        self.wire.send(message).map_err(|source| self.lost(source))
    }

    /// The next message of any type; `None` when the time is up.
    ///
    /// # Errors
    /// Where the link is lost.
    pub fn receive(&mut self, until: Instant) -> Result<Option<Message>, LinkError> {
        self.wire.receive(until).map_err(|source| self.lost(source))
    }

    /// A new number for a request; the answer has the same number.
    pub fn next_id(&mut self) -> Id {
        self.last_id = self.last_id.wrapping_add(1);
        self.last_id
    }

    fn request(
        &mut self,
        what: &'static str,
        message: impl Fn(Id) -> ToBoard,
    ) -> Result<Outcome, LinkError> {
        let sent = self.next_id();
        self.ask(what, &message(sent), REQUEST, |message| match message {
            ToHost::Answer { id, outcome } if id == sent => Some(outcome),
            _ => None,
        })
    }

    fn ask<T>(
        &mut self,
        what: &'static str,
        question: &ToBoard,
        timing: RetryTiming,
        wanted: impl FnMut(Message) -> Option<T>,
    ) -> Result<T, LinkError> {
        match self.wire.ask(question, timing, wanted) {
            Ok(Some(answer)) => Ok(answer),
            Ok(None) => Err(self.silent(what, timing.end)),
            Err(source) => Err(self.lost(source)),
        }
    }

    /// The error of a board that has not answered for this time.
    pub fn silent(&self, what: &'static str, after: Duration) -> LinkError {
        LinkError::Unanswered { address: self.address.clone(), what, after }
    }

    fn lost(&self, source: io::Error) -> LinkError {
        LinkError::Lost { address: self.address.clone(), source }
    }
}
