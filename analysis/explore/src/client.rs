//! The host's end of a board's wire, without a port and a clock: bytes and times in, bytes and news out. It
//! sends, waits and repeats requests like `haptic scope`.

use std::collections::VecDeque;
use std::time::Duration;

use haptic_model::board::OtherProtocol;
use haptic_model::board::history::History;
use haptic_model::board::request::{Reply, Request, RequestResult, names, refusal_in_words};
use haptic_model::board::sample::{Sample, Scale};
use haptic_model::board::timing::{QUERY, REQUEST, SILENCE, STATUS_INTERVAL, stream_every};
use haptic_servo::tuning::RenderError;
use haptic_servo::wire::description::Description;
use haptic_servo::wire::message::{
    ActiveParameters, BoardUnits, Changes, Id, LONGEST_TO_BOARD, LONGEST_TO_HOST, Outcome,
    PreviousFault, Refusal, Status, ToBoard, ToHost,
};
use haptic_servo::wire::{CHECKSUM, Decoder, Discarded, PROTOCOL, encode, largest_frame};

/// Duration of the kept curves in s.
pub const WINDOW: f64 = 5.0;

/// Values of a status, at its time in s since the servo's start.
#[derive(Clone, Copy, Debug)]
pub struct Slow {
    /// The time.
    pub time: f64,
    /// Damping in N m s/rad that the device may lose.
    pub margin: Option<f64>,
    /// Net energy into the hand in J.
    pub energy: f64,
}

/// A conversation with a board.
pub struct Client {
    address: String,
    decoder: Decoder<{ LONGEST_TO_HOST + CHECKSUM }>,
    outgoing: Vec<u8>,
    last_id: Id,
    greeting: Greeting,
    /// The board, after its greeting.
    pub connected: Option<Connected>,
    pending: Option<Pending>,
    /// The results of requests as text, until they are taken.
    pub replies: Vec<String>,
    /// Whether a status or active parameters have arrived since the last call.
    pub has_news: bool,
}

/// A board before its greeting.
struct Greeting {
    program: Option<String>,
    previous_fault: Option<PreviousFault>,
    again: Duration,
    end: Duration,
}

/// A board after its greeting.
pub struct Connected {
    /// Name of its program.
    pub program: String,
    /// The units of its numbers.
    pub board: BoardUnits,
    /// The fault that stopped it before its last reset.
    pub previous_fault: Option<PreviousFault>,
    /// Its last status.
    pub status: Option<Status>,
    /// The active parameters.
    pub parameters: Option<ActiveParameters>,
    /// The running scene.
    pub description: Option<Description>,
    /// The last seconds.
    pub history: History,
    /// The same for the values of each status.
    pub slow: VecDeque<Slow>,
    scale: Scale,
    heard: Duration,
    beat: Duration,
}

/// An unanswered request.
struct Pending {
    id: Id,
    request: Request,
    again: Duration,
    end: Duration,
}

impl Client {
    /// Greets the board at an address. `id` should not have been used by an earlier client.
    pub fn start(address: String, id: Id, now: Duration) -> Self {
        let again = now + QUERY.again;
        let greeting =
            Greeting { program: None, previous_fault: None, again, end: now + QUERY.end };
        let mut client = Self {
            address,
            decoder: Decoder::new(),
            outgoing: Vec::new(),
            last_id: id,
            greeting,
            connected: None,
            pending: None,
            replies: Vec::new(),
            has_news: false,
        };
        client.send(&ToBoard::Hello);
        client
    }

    /// Address of the board.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Bytes to the board since the last call.
    pub fn take_outgoing(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.outgoing)
    }

    /// Invalid frames from the board.
    pub fn discarded(&self) -> Discarded {
        self.decoder.discarded()
    }

    /// Takes bytes from the board, and passes its ticks to `each`.
    ///
    /// # Errors
    /// The reason why this board cannot be used.
    pub fn receive(
        &mut self,
        bytes: &[u8],
        now: Duration,
        mut each: impl FnMut(&Sample),
    ) -> Result<(), String> {
        for &byte in bytes {
            if let Some(message) = self.decoder.push::<ToHost<String>>(byte) {
                self.take(message, now, &mut each)?;
            }
        }
        Ok(())
    }

    /// Sends the requests that are due.
    ///
    /// # Errors
    /// If the board has been silent for too long.
    pub fn tick(&mut self, now: Duration) -> Result<(), String> {
        let Some(connected) = &mut self.connected else { return self.greet(now) };
        if now.saturating_sub(connected.heard) > SILENCE {
            return Err(silent(&self.address, "the request for its status", SILENCE));
        }
        if connected.beat <= now {
            connected.beat = now + STATUS_INTERVAL;
            let is_described = connected.description.is_some();
            let has_parameters = connected.parameters.is_some();
            self.send(&ToBoard::Status);
            // Bytes get lost: missing replies are requested again.
            if !is_described {
                self.send(&ToBoard::Describe);
            }
            if !has_parameters {
                self.send(&ToBoard::Get);
            }
        }
        self.ask_again(now);
        Ok(())
    }

    /// Sends a request, one at a time, except that disarming never waits. A set is certified here first.
    ///
    /// # Errors
    /// The reason if it is not sent.
    pub fn request(&mut self, request: Request, now: Duration) -> Result<(), String> {
        if self.connected.is_none() {
            return Err(Reply::NoLink.line(&request));
        }
        if self.pending.is_some() && request != Request::Disarm {
            return Err(Reply::Busy.line(&request));
        }
        if let Request::Set(changes) = &request {
            self.judge(changes)?;
        }
        self.give_up();
        self.last_id = self.last_id.wrapping_add(1);
        let id = self.last_id;
        self.send(&request.message(id));
        self.replies.push(Reply::Asked.line(&request));
        self.pending =
            Some(Pending { id, request, again: now + REQUEST.again, end: now + REQUEST.end });
        Ok(())
    }

    /// Judges changes of the board's running scene like the board. Only the board can judge a mode whose
    /// table it alone has.
    ///
    /// # Errors
    /// The reason for which the board would refuse them.
    pub fn judge(&self, changes: &Changes) -> Result<(), String> {
        let running = self.connected.as_ref().and_then(|connected| {
            connected.description.as_ref().zip(connected.parameters.as_ref())
        });
        let (description, parameters) =
            running.ok_or("the board has not said yet which scene runs there")?;
        match description.explain(names(parameters), changes) {
            Ok(()) | Err(RenderError::OtherMode { .. }) => Ok(()),
            Err(reason) => Err(reason.to_string()),
        }
    }

    /// Gives up waiting for an answer, and reports it.
    pub fn give_up(&mut self) {
        if let Some(Pending { request, .. }) = self.pending.take() {
            self.replies.push(Reply::Unanswered.line(&request));
        }
    }

    fn send(&mut self, message: &ToBoard) {
        let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
        // The buffer has the size of the longest message.
        if let Ok(frame) = encode(message, &mut buffer) {
            self.outgoing.extend_from_slice(frame);
        }
    }

    fn greet(&mut self, now: Duration) -> Result<(), String> {
        if now >= self.greeting.end {
            return Err(format!(
                "no board answers on {} within {} s: is it powered, flashed with a scene's program, and is \
                 this its port?",
                self.address,
                QUERY.end.as_secs_f64()
            ));
        }
        if now >= self.greeting.again {
            self.greeting.again = now + QUERY.again;
            self.send(&ToBoard::Hello);
        }
        Ok(())
    }

    fn ask_again(&mut self, now: Duration) {
        if self.pending.as_ref().is_some_and(|pending| now >= pending.end) {
            self.give_up();
        }
        if let Some(pending) = &mut self.pending
            && now >= pending.again
        {
            pending.again = now + REQUEST.again;
            let message = pending.request.message(pending.id);
            self.send(&message);
        }
    }

    fn take(
        &mut self,
        message: ToHost<String>,
        now: Duration,
        each: &mut impl FnMut(&Sample),
    ) -> Result<(), String> {
        match &mut self.connected {
            None => self.take_greeting(message, now),
            Some(connected) => {
                connected.heard = now;
                self.take_news(message, each)
            }
        }
    }

    fn take_greeting(&mut self, message: ToHost<String>, now: Duration) -> Result<(), String> {
        match message {
            ToHost::Welcome { protocol: PROTOCOL, program } => {
                self.greeting.program = Some(program);
            }
            ToHost::Welcome { protocol: theirs, program } => {
                let address = self.address.clone();
                return Err(OtherProtocol { address, program, theirs }.to_string());
            }
            ToHost::PreviousFault(fault) => self.greeting.previous_fault = Some(fault),
            // The last part of the greeting.
            ToHost::Board(board) => {
                if let Some(program) = self.greeting.program.take() {
                    let previous_fault = self.greeting.previous_fault;
                    self.connected = Some(Connected::new(program, board, previous_fault, now));
                    self.send(&ToBoard::Stream(Some(stream_every(board.period))));
                    self.send(&ToBoard::Get);
                    self.send(&ToBoard::Describe);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn take_news(
        &mut self,
        message: ToHost<String>,
        each: &mut impl FnMut(&Sample),
    ) -> Result<(), String> {
        let Some(connected) = &mut self.connected else { return Ok(()) };
        match message {
            ToHost::Telemetry(batch) => {
                for frame in batch.ticks() {
                    let sample = connected.scale.sample(&frame);
                    each(&sample);
                    connected.history.push(sample);
                }
            }
            ToHost::Status(status) => {
                self.has_news = true;
                if connected.is_changed_by(status)? {
                    self.send(&ToBoard::Get);
                    self.send(&ToBoard::Describe);
                }
            }
            ToHost::ActiveParameters(parameters) => {
                self.has_news = true;
                connected.parameters = Some(parameters);
            }
            ToHost::Described(description) => connected.description = Some(description),
            ToHost::Answer { id, outcome } => self.take_answer(id, outcome),
            // Replies to a repeated hello.
            ToHost::Welcome { .. } | ToHost::PreviousFault(_) | ToHost::Board(_) => {}
        }
        Ok(())
    }

    fn take_answer(&mut self, id: Id, outcome: Outcome) {
        let Some(Pending { request, .. }) = self.pending.take_if(|pending| pending.id == id) else {
            return;
        };
        let result = self.in_words(outcome, &request.changes());
        self.replies.push(Reply::Answered(result).line(&request));
        self.send(&ToBoard::Get);
        self.send(&ToBoard::Describe);
    }

    fn in_words(&self, outcome: Outcome, changes: &Changes) -> RequestResult {
        if let Outcome::Refused(Refusal::Set(step)) = outcome
            && let Some(Connected {
                description: Some(description),
                parameters: Some(parameters),
                ..
            }) = &self.connected
        {
            return refusal_in_words(step, changes, description, parameters);
        }
        outcome.into()
    }
}

impl Connected {
    fn new(
        program: String,
        board: BoardUnits,
        previous_fault: Option<PreviousFault>,
        now: Duration,
    ) -> Self {
        Self {
            program,
            board,
            previous_fault,
            status: None,
            parameters: None,
            description: None,
            history: History::new(WINDOW),
            slow: VecDeque::new(),
            scale: Scale::new(board),
            heard: now,
            beat: now,
        }
    }

    /// Stores a status; returns whether the active parameters have changed since the last.
    fn is_changed_by(&mut self, status: Status) -> Result<bool, String> {
        let last = self.status.replace(status);
        if last.is_some_and(|last| status.tick.wrapping_sub(last.tick) > u32::MAX / 2) {
            return Err("the board was started again".to_owned());
        }
        let board = &self.board;
        let time = match self.history.last() {
            Some(sample) => sample.time,
            None => f64::from(status.tick) * board.period,
        };
        let margin = self.parameters.as_ref().and_then(|parameters| parameters.margin);
        self.slow.push_back(Slow {
            time,
            margin,
            energy: status.energy as f64 * board.energy_step,
        });
        while self
            .slow
            .front()
            .is_some_and(|first| !(time - first.time <= WINDOW && first.time <= time))
        {
            self.slow.pop_front();
        }
        Ok(last.is_some_and(|last| last.sets != status.sets))
    }
}

/// The message for a board that has not answered in time.
fn silent(address: &str, what: &str, after: Duration) -> String {
    format!("the board on {address} has not answered {what} within {} s", after.as_secs_f64())
}
