//! A board that answers.

use std::io;
use std::time::{Duration, Instant};

use haptic_servo::wire::Discarded;
use haptic_servo::wire::description::Description;
use haptic_servo::wire::message::{
    ActiveParameters, BoardUnits, Changes, PreviousFault, Status, ToBoard, ToHost,
};

use haptic_model::board::client::{Client, ClientError, Event};
use haptic_model::board::request::{Reply, Request, RequestResult};
use haptic_model::board::timing::{QUERY, REQUEST, SILENCE};

use super::transport::{self, Transport, read_within};
use super::{Address, LinkError};

/// A message of a board that owns its text.
pub type Message = ToHost<String>;

/// A connection to a board that has identified itself.
pub struct Link {
    wire: Wire,
    program: String,
    board: BoardUnits,
    previous_fault: Option<PreviousFault>,
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

    /// Waits for bytes until a time at the latest, and sends the messages that are due then. It reads first: the
    /// bytes that came while this process did not run are no silence.
    pub fn carry(&mut self, until: Instant) -> Result<(), LinkError> {
        let received = self.exchange(until).map_err(|source| self.lost(source))?;
        let now = self.now();
        self.client
            .receive(&self.bytes[..received], now)
            .and_then(|()| self.client.tick(now))
            .map_err(|error| self.ended(error))?;
        self.flush().map_err(|source| self.lost(source))
    }

    /// Sends the waiting bytes; returns the number of received bytes.
    fn exchange(&mut self, until: Instant) -> io::Result<usize> {
        self.flush()?;
        // No operating system takes a timeout of zero.
        let left = until.saturating_duration_since(Instant::now()).max(Duration::from_millis(1));
        read_within(self.transport.as_mut(), self.bytes.as_mut_slice(), left)
    }

    fn flush(&mut self) -> io::Result<()> {
        let bytes = self.client.take_outgoing();
        if bytes.is_empty() {
            return Ok(());
        }
        self.transport.write_all(&bytes)?;
        self.transport.flush()
    }

    /// Sends a message that ends the conversation.
    pub fn send_last(&mut self, message: &ToBoard) -> Result<(), LinkError> {
        self.client.send(message);
        self.flush().map_err(|source| self.lost(source))
    }

    /// The next event, if there is one before a time.
    fn next(&mut self, until: Instant) -> Result<Option<Event>, LinkError> {
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

    fn unanswered(&self, what: &'static str, after: Duration) -> LinkError {
        LinkError::Unanswered { address: self.address.clone(), what, after }
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
        let mut wire = Wire::open(address)?;
        loop {
            // The client gives up by itself.
            match wire.next(Instant::now() + QUERY.again) {
                Ok(Some(Event::Connected { program, board, previous_fault })) => {
                    return Ok(Self { wire, program, board, previous_fault });
                }
                Ok(_) => {}
                // A socket reports it; a serial line is silent.
                Err(LinkError::Lost { address, source })
                    if is_closed(&source) && !matches!(address, Address::Serial { .. }) =>
                {
                    return Err(LinkError::InUse { address });
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// The board's address.
    pub fn address(&self) -> &Address {
        &self.wire.address
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
        self.wire.client.discarded()
    }

    /// The conversation, to carry it on.
    pub(crate) fn into_wire(self) -> Wire {
        self.wire
    }

    /// Changes these numbers, all or none, and waits until they run.
    pub fn set(&mut self, changes: Changes) -> Result<RequestResult, LinkError> {
        self.request("the change of its parameters", Request::Set(changes))
    }

    /// Switches the amplifier on, or clears a fault and does so.
    pub fn arm(&mut self) -> Result<RequestResult, LinkError> {
        self.request("the request to arm", Request::Arm)
    }

    /// Has a motor board begin to align its brushless motor, which moves the handle.
    pub fn align(&mut self) -> Result<RequestResult, LinkError> {
        self.request("the request to align the motor", Request::Align)
    }

    /// Fades the torque out and switches the amplifier off.
    pub fn disarm(&mut self) -> Result<RequestResult, LinkError> {
        self.request("the request to disarm", Request::Disarm)
    }

    /// The scene that runs, with all numbers of its servo.
    pub fn description(&mut self) -> Result<Description, LinkError> {
        self.wire.client.description = None;
        self.ask("the request for its description", &ToBoard::Describe, |client, _| {
            client.description
        })
    }

    /// The active parameters.
    pub fn parameters(&mut self) -> Result<ActiveParameters, LinkError> {
        self.ask("the request for its parameters", &ToBoard::Get, |_, event| match event {
            Some(Event::ActiveParameters(parameters)) => Some(parameters),
            _ => None,
        })
    }

    /// The board's status.
    pub fn status(&mut self) -> Result<Status, LinkError> {
        self.ask("the request for its status", &ToBoard::Status, |_, event| match event {
            Some(Event::Status(status, _)) => Some(status),
            _ => None,
        })
    }

    fn request(
        &mut self,
        what: &'static str,
        request: Request,
    ) -> Result<RequestResult, LinkError> {
        let Wire { client, began, .. } = &mut self.wire;
        // A refused set is explained by the scene of then.
        (client.description, client.parameters) = (None, None);
        let mut reply = client.request(request, began.elapsed()).err();
        loop {
            match reply {
                Some(Reply::Answered(result)) => return Ok(result),
                None | Some(Reply::Asked) => {}
                Some(_) => return Err(self.wire.unanswered(what, REQUEST.end)),
            }
            reply = match self.wire.next(Instant::now() + QUERY.again)? {
                Some(Event::Reply(_, reply)) => Some(reply),
                _ => None,
            };
        }
    }

    /// Repeats a query until `wanted` accepts what the client knows or what has come, or the time is up.
    fn ask<T>(
        &mut self,
        what: &'static str,
        question: &ToBoard,
        wanted: impl Fn(&Client, Option<Event>) -> Option<T>,
    ) -> Result<T, LinkError> {
        let end = Instant::now() + QUERY.end;
        while Instant::now() < end {
            self.wire.client.send(question);
            let again = (Instant::now() + QUERY.again).min(end);
            while Instant::now() < again {
                self.wire.carry(again)?;
                loop {
                    let event = self.wire.client.next_event();
                    let is_last = event.is_none();
                    if let Some(answer) = wanted(&self.wire.client, event) {
                        return Ok(answer);
                    }
                    if is_last {
                        break;
                    }
                }
            }
        }
        Err(self.wire.unanswered(what, QUERY.end))
    }
}
