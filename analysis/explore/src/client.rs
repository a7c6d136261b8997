//! What the page keeps of a conversation with a board: curves and values of the last seconds, and results of
//! requests as text.

use std::collections::VecDeque;
use std::time::Duration;

use haptic_model::board::client::{self, Event};
use haptic_model::board::history::History;
use haptic_model::board::request::{self, Request};
use haptic_model::board::sample::{Sample, Scale};
use haptic_model::board::timing::stream_every;
use haptic_servo::tuning::RenderError;
use haptic_servo::wire::message::{ActiveParameters, Id, Status};

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
    /// The conversation itself.
    pub wire: client::Client,
    /// The board, after its greeting.
    pub connected: Option<Connected>,
    /// The results of requests as text, until they are taken.
    pub replies: Vec<String>,
    /// Whether a status or active parameters have arrived since the last call.
    pub has_news: bool,
}

/// A board after its greeting.
pub struct Connected {
    /// Its own description.
    pub board: client::Connected,
    /// Its last status.
    pub status: Option<Status>,
    /// The active parameters.
    pub parameters: Option<ActiveParameters>,
    /// The last seconds.
    pub history: History,
    /// The same for the values of each status.
    pub slow: VecDeque<Slow>,
    scale: Scale,
}

impl Client {
    /// Greets the board at an address. `id` should not have been used by an earlier client.
    pub fn start(address: String, id: Id, now: Duration) -> Self {
        let wire = client::Client::start(address, id, now);
        Self { wire, connected: None, replies: Vec::new(), has_news: false }
    }

    /// Takes bytes from the board, passes its ticks to `each`, and sends the messages that are due.
    ///
    /// # Errors
    /// The reason why this board cannot be used, or any more.
    pub fn turn(
        &mut self,
        bytes: &[u8],
        now: Duration,
        mut each: impl FnMut(&Sample),
    ) -> Result<(), String> {
        let received = self.wire.receive(bytes, now);
        while let Some(event) = self.wire.next_event() {
            if let Event::Lost(why) = event {
                return Err(why);
            }
            self.take(event, now, &mut each);
        }
        let ended = received.and_then(|()| self.wire.tick(now));
        self.take_replies();
        ended.map_err(|error| error.to_string())
    }

    /// Sends a request. A set is certified here first.
    pub fn request(&mut self, request: Request, now: Duration) -> Result<(), String> {
        self.wire.check_free(&request).map_err(|reply| reply.line(&request))?;
        if matches!(request, Request::Set(_) | Request::Budget(_)) {
            self.judge(&request)?;
        }
        self.wire.request(request.clone(), now).map_err(|reply| reply.line(&request))?;
        self.take_replies();
        Ok(())
    }

    /// Judges changes of the board's running scene like the board. Only the board can judge a mode whose
    /// table it alone has.
    ///
    /// # Errors
    /// The reason for which the board would refuse them.
    pub fn judge(&self, request: &Request) -> Result<(), String> {
        let running = self.wire.description.as_ref().zip(self.wire.parameters.as_ref());
        let (description, parameters) =
            running.ok_or("the board has not said yet which scene runs there")?;
        match request::judge(request, self.wire.budget, description, parameters) {
            Err(refused) if !matches!(refused.0, RenderError::OtherMode { .. }) => Err(refused.1),
            Ok(()) | Err(_) => Ok(()),
        }
    }

    /// Gives up waiting for an answer, and reports it.
    pub fn give_up(&mut self) {
        self.wire.give_up();
        self.take_replies();
    }

    /// The events between two turns are replies.
    fn take_replies(&mut self) {
        while let Some(event) = self.wire.next_event() {
            self.take_reply(event);
        }
    }

    fn take_reply(&mut self, event: Event) {
        if let Event::Reply(request, reply) = event {
            self.replies.push(reply.line(&request));
        }
    }

    fn take(&mut self, event: Event, now: Duration, each: &mut impl FnMut(&Sample)) {
        if let Event::Connected(board) = event {
            self.wire.watch(stream_every(board.units.period), now);
            self.connected = Some(Connected::new(board));
            return;
        }
        let Some(connected) = &mut self.connected else { return };
        match event {
            Event::Ticks(frames) => {
                for frame in &frames {
                    let sample = connected.scale.sample(frame);
                    each(&sample);
                    connected.history.push(sample);
                }
            }
            Event::Status(status, _) => {
                self.has_news = true;
                connected.take_status(status);
            }
            Event::ActiveParameters(parameters) => {
                self.has_news = true;
                connected.parameters = Some(parameters);
            }
            other => self.take_reply(other),
        }
    }
}

impl Connected {
    fn new(board: client::Connected) -> Self {
        Self {
            scale: Scale::new(board.units),
            board,
            status: None,
            parameters: None,
            history: History::new(WINDOW),
            slow: VecDeque::new(),
        }
    }

    fn take_status(&mut self, status: Status) {
        self.status = Some(status);
        let board = &self.board.units;
        let time = match self.history.last() {
            Some(sample) => sample.time,
            None => f64::from(status.tick) * board.period,
        };
        let margin = self.parameters.as_ref().and_then(|parameters| parameters.margin);
        let energy = status.energy as f64 * board.energy_step;
        self.slow.push_back(Slow { time, margin, energy });
        let is_old = |first: &Slow| !(time - first.time <= WINDOW && first.time <= time);
        while self.slow.front().is_some_and(is_old) {
            self.slow.pop_front();
        }
    }
}
