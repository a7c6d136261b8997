//! The board's end of the wire: bytes in, requests to the servo, replies out.
//!
//! Runs below the servo's interrupt and without hardware. The task of the serial port passes received
//! bytes to [`Session::receive`], calls [`Session::poll`], and sends the bytes of [`Session::outgoing`],
//! in a loop. Nothing here waits, and each message causes a bounded amount of work: one request of each
//! kind can be open, and one frame is on its way out. The kinds of replies take turns, so that no flood of
//! messages keeps another request from its answer ([`MESSAGES_AHEAD`]).
//!
//! The path of a new set of parameters:
//!
//! ```text
//! ToBoard::Set -> on_message     kept in `requested`, or refused: busy
//!         poll -> prepare_set    certified and built (`tuning::prepare`), or refused with the step
//!                 submit         to the servo's interrupt, which swaps it in (`servo_loop::swap`)
//! Requests::swapped -> compare   has its number: it is the active set; ToHostWith::Answer
//! ```

mod outgoing;
mod pending_replies;
#[cfg(test)]
mod tests;

pub use self::outgoing::MESSAGES_AHEAD;
use self::outgoing::{Outbox, Stream, Turn};
use self::pending_replies::{Greeting, PendingReplies};
use super::PROTOCOL;
use super::decoder::Decoder;
use super::description::Description;
use super::frame::CHECKSUM;
use super::host::{HostCommand, HostReport, HostRequest, HostState};
use super::message::{
    ActiveParameters, BoardUnits, Changes, FaultCode, Id, LONGEST_TO_BOARD, Outcome, Refusal,
    Status, ToBoardWith, ToHostWith,
};
use crate::boot::Program;
use crate::certificate::scene_data;
use crate::fault::FaultRecord;
use crate::host::BesideServo;
use crate::number::Number;
use crate::power_reading::PowerReading;
use crate::rendering::Rendering;
use crate::reset::ResetCause;
use crate::scene::Scene;
use crate::servo::{OutputMode, PreparedServo, RenderingOptions, SupportsTiming, Transducers};
use crate::servo_loop::{self, FrameReader, Requests};
use crate::tuning::{self, Tunable};

/// A board's own description.
#[derive(Clone, Copy, Debug)]
pub struct BoardInfo {
    /// Name of the program.
    pub name: &'static str,
    /// Timer counts in the servo's period.
    pub timer_counts: u32,
    /// Cause of the last reset.
    pub reset: ResetCause,
    /// Whether the chip's option bytes let it run at a supply that is too low for its work.
    pub low_brown_out: bool,
    /// The fault that stopped the board before that reset.
    pub previous_fault: Option<FaultRecord>,
    /// Bytes of the stack that were never used; returns `None` if the board does not measure this.
    pub stack_left: fn() -> Option<u32>,
    /// The measurements of the power stage; returns `None` without a bridge on the board.
    pub power: fn() -> Option<PowerReading>,
}

/// A value in the messages of a program with a host, and none in others.
type IfHost<E, N, T> = <<E as Rendering<N>>::Host as BesideServo>::IfPresent<T>;

/// A set of parameters with the damping that the device may lose while it runs.
#[derive(Clone, Copy)]
struct Set<E> {
    scene: Scene<E>,
    margin: Option<f64>,
}

/// A set on its way to the servo.
struct Submitted<E> {
    id: Id,
    /// That of [`Requests::swapped`] once it runs.
    number: u32,
    set: Set<E>,
}

/// The board's end of the wire; `LENGTH` is the length of the servo's queue of frames.
pub struct Session<'a, E: Rendering<N>, N: Number, M, const LENGTH: usize> {
    info: BoardInfo,
    transducers: Transducers,
    rendering: RenderingOptions,
    requests: Requests<'a, PreparedServo<E, N, M>>,
    frames: FrameReader<'a, LENGTH>,
    decoder: Decoder<{ LONGEST_TO_BOARD + CHECKSUM }>,
    outbox: Outbox,
    reported: <E::Host as BesideServo>::Reported,
    replies: PendingReplies,
    stream: Stream,
    /// The kind of reply that is sent next, if there is one.
    turn: Turn,
    active: Set<E>,
    /// The number of the active set: sets swapped in since the start; wraps.
    revision: u32,
    /// Changes that are not certified yet.
    requested: Option<(Id, Changes)>,
    /// The set that was submitted to the servo and is not swapped in yet.
    submitted: Option<Submitted<E>>,
}

impl<'a, E, N, M, const LENGTH: usize> Session<'a, E, N, M, LENGTH>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    /// Session of the servo that runs this program; `margin` is the damping in N m s/rad that the device
    /// may lose with its scene.
    pub fn new(
        program: Program<E>,
        margin: Option<f64>,
        info: BoardInfo,
        requests: Requests<'a, PreparedServo<E, N, M>>,
        frames: FrameReader<'a, LENGTH>,
    ) -> Self {
        Self {
            info,
            requests,
            frames,
            decoder: Decoder::new(),
            outbox: Outbox::new(),
            reported: Default::default(),
            replies: PendingReplies::default(),
            stream: Stream::new(program.scene.timing.period),
            turn: Turn::FIRST,
            active: Set { scene: program.scene, margin },
            transducers: program.transducers,
            rendering: program.rendering,
            revision: 0,
            requested: None,
            submitted: None,
        }
    }

    /// Takes received bytes.
    pub fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if let Some(message) = self.decoder.push(byte) {
                self.requests.host_alive();
                self.on_message(message);
            }
        }
    }

    /// Compares the servo's state with the requests, and puts the next frame into the outbox after the
    /// previous frame is sent. The kinds of frames take turns.
    ///
    /// Certifies at most one set, which takes most of a small board's stack.
    pub fn poll(&mut self) {
        self.compare();
        self.stream.take(&mut self.frames);
        if E::Host::IS_PRESENT && self.outbox.is_empty() {
            self.report_to_host();
        }
        // In one round each kind has its turn, and a greeting has no more parts than that.
        for _ in 0..Turn::COUNT {
            if !self.outbox.is_empty() {
                break;
            }
            let turn = self.turn;
            self.turn = turn.next();
            self.send(turn);
        }
    }

    /// Bytes to send.
    pub fn outgoing(&self) -> &[u8] {
        self.outbox.rest()
    }

    /// Marks the first `bytes` of [`Session::outgoing`] as sent.
    pub const fn sent(&mut self, bytes: usize) {
        self.outbox.sent(bytes);
    }

    fn on_message(&mut self, message: ToBoardWith<IfHost<E, N, HostRequest>>) {
        match message {
            ToBoardWith::Hello => self.replies.greet(),
            ToBoardWith::Get => self.replies.parameters = true,
            ToBoardWith::Describe => self.replies.description = true,
            ToBoardWith::Status => {
                self.replies.status_number.get_or_insert_with(|| self.requests.request_status());
            }
            ToBoardWith::Stream(every) => self.stream.set(every),
            ToBoardWith::Arm { id } => self.replies.arm(id, || self.requests.arm()),
            ToBoardWith::Align { id } => self.replies.align(id, || self.requests.align()),
            ToBoardWith::Disarm { id } => self.replies.disarm(id, self.requests.disarm()),
            ToBoardWith::Set { id, changes } => match self.open_set() {
                None => self.requested = Some((id, changes)),
                // A host repeats a request because the answer takes a while.
                Some(open) if open == id => {}
                Some(_) => self.replies.refuse(id, Refusal::Busy),
            },
            ToBoardWith::Host(request) => self.on_host_request(E::Host::value(request)),
        }
    }

    fn on_host_request(&mut self, request: HostRequest) {
        match request {
            HostRequest::Torque(HostCommand { number, torque, ramp }) => {
                E::Host::send(self.requests.host(), number, torque, ramp);
                // After the command, for the interrupt that takes it.
                self.requests.host_alive();
            }
            HostRequest::Budget { id, budget } => match self.open_set() {
                None => E::Host::ask(&mut self.reported, id, budget),
                Some(open) if open == id => {}
                Some(_) => self.replies.refuse(id, Refusal::Busy),
            },
        }
    }

    /// The set whose answer is not on its way yet.
    fn open_set(&self) -> Option<Id> {
        let requested = self.requested.as_ref().map(|(id, _)| *id);
        let submitted = self.submitted.as_ref().map(|submitted| submitted.id);
        let asking = E::Host::asking(&self.reported);
        requested.or(asking).or(submitted).or(self.replies.set.map(|(id, _)| id))
    }

    /// Compares what the servo has published with what was requested.
    fn compare(&mut self) {
        let Self { requests, replies, .. } = self;
        replies.arming.compare(requests.arming(), |fault| match fault {
            Some(fault) => Refusal::Fault(fault),
            // Arming has no such reply.
            None => Refusal::Busy,
        });
        replies.alignment.compare(requests.alignment(), Refusal::NotAligning);
        replies.disarming.compare(requests.off());
        if let Some((number, status)) = requests.status()
            && replies.status_number.take_if(|requested| *requested == number).is_some()
        {
            replies.status = Some(status);
        }
        let swapped = requests.swapped();
        if let Some(Submitted { id, set, .. }) =
            self.submitted.take_if(|submitted| submitted.number == swapped)
        {
            self.active = set;
            self.revision = swapped;
            E::Host::request_budget(&mut self.reported);
            self.replies.set = Some((id, Outcome::Done));
        }
    }

    /// Puts the next report to a host into the outbox, before the other kinds: a report belongs to one
    /// command, so that a host that sends commands more slowly than the line carries reports leaves room
    /// for them.
    fn report_to_host(&mut self) {
        let report = if E::Host::is_budget_due(&mut self.reported) {
            E::Host::host(&self.active.scene.environment.budget()).map(HostReport::Budget)
        } else {
            let (transducers, period) = (&self.transducers, self.active.scene.timing.period);
            let count_a_tick = core::f64::consts::TAU / transducers.counts_per_turn / period;
            let taken = E::Host::report(self.requests.host(), &mut self.reported);
            taken.map(|taken| HostReport::State(HostState::of(&taken, count_a_tick)))
        };
        if let Some(report) = report.and_then(E::Host::present) {
            self.put(&ToHostWith::Host(report));
        }
    }

    fn put(&mut self, message: &ToHostWith<&str, IfHost<E, N, HostReport>>) {
        self.outbox.put(message);
    }

    /// Puts a reply of this kind into the outbox, if there is one.
    fn send(&mut self, turn: Turn) {
        let replies = &mut self.replies;
        let answer = match turn {
            Turn::Disarming => replies.disarming.answer(),
            Turn::Arming => replies.arming.answer(),
            Turn::Alignment => replies.alignment.answer(),
            Turn::Refusal => replies.refusal(),
            Turn::Set => {
                self.prepare_set();
                self.replies.set.take()
            }
            Turn::Greeting => return self.greet(),
            Turn::Status => {
                let Some(status) = replies.status.take() else { return };
                return self.put(&ToHostWith::Status(self.status(&status)));
            }
            Turn::Parameters if core::mem::take(&mut replies.parameters) => {
                return self.put(&ToHostWith::ActiveParameters(self.parameters()));
            }
            Turn::Description if core::mem::take(&mut replies.description) => {
                return self.put(&ToHostWith::Described(self.description()));
            }
            Turn::Telemetry => {
                let Some(batch) = self.stream.batch() else { return };
                return self.put(&ToHostWith::Telemetry(batch));
            }
            Turn::Parameters | Turn::Description => return,
        };
        if let Some((id, outcome)) = answer {
            self.put(&ToHostWith::Answer { id, outcome });
        }
    }

    /// The next part of a greeting; its parts follow one another.
    fn greet(&mut self) {
        let Some((part, is_last)) = self.replies.greeting() else { return };
        if !is_last {
            self.turn = Turn::Greeting;
        }
        let message = match (part, self.info.previous_fault) {
            (Greeting::Welcome, _) => {
                E::Host::request_budget(&mut self.reported);
                ToHostWith::Welcome { protocol: PROTOCOL, program: self.info.name }
            }
            (Greeting::PreviousFault, Some(record)) => ToHostWith::PreviousFault(record.into()),
            (Greeting::PreviousFault, None) => return,
            (Greeting::Board, _) => ToHostWith::Board(self.board()),
        };
        self.put(&message);
    }

    /// Certifies the requested set and submits it to the servo, or refuses it and changes nothing.
    fn prepare_set(&mut self) {
        let mut budgeted = None;
        let (id, changes) = if let Some(requested) = self.requested.take() {
            requested
        } else if let Some((id, host)) = E::Host::asked(&mut self.reported) {
            let scene = self.active.scene;
            let environment = scene.environment.with_budget(E::Host::budget(host));
            budgeted = Some(Scene { environment, ..scene });
            (id, Changes::new())
        } else {
            return;
        };
        let scene = budgeted.as_ref().unwrap_or(&self.active.scene);
        let refusal = match tuning::prepare(scene, &changes, &self.transducers, &self.rendering) {
            Ok(prepared) => {
                let set = Set { scene: prepared.scene, margin: prepared.margin };
                match self.requests.submit(prepared.rendering) {
                    Ok(number) => {
                        self.submitted = Some(Submitted { id, number, set });
                        return;
                    }
                    Err(_) => Refusal::Busy,
                }
            }
            Err(step) => Refusal::Set(step),
        };
        self.replies.set = Some((id, Outcome::Refused(refusal)));
    }

    fn board(&self) -> BoardUnits {
        let Self { transducers, rendering, .. } = self;
        let period = self.active.scene.timing.period;
        BoardUnits {
            period,
            timer_counts: self.info.timer_counts,
            counts_per_turn: transducers.counts_per_turn,
            full_scale_torque: transducers.full_scale_torque,
            energy_step: transducers.energy_unit(),
            longest_gap: servo_loop::longest_gap(rendering, period),
        }
    }

    fn description(&self) -> Description {
        let Self { transducers, rendering, .. } = *self;
        let (scene, format, timing) = (scene_data(&self.active.scene), N::FORMAT, M::TIMING);
        Description { scene, transducers, rendering, format, timing }
    }

    fn parameters(&self) -> ActiveParameters {
        let Set { scene, margin } = &self.active;
        let named = |parameter| tuning::get(scene, parameter).map(|value| (parameter, value));
        let values = tuning::parameters(scene).iter().filter_map(named).collect();
        ActiveParameters { sets: self.revision, margin: *margin, values }
    }

    fn status(&self, servo: &servo_loop::Status) -> Status {
        Status {
            state: servo.state,
            fault: servo.fault.map(FaultCode::from),
            link_lost: servo.link_lost,
            tick: servo.tick,
            count: servo.count,
            sets: self.revision,
            missed: servo.missed,
            worst_slack: servo.worst_slack,
            energy: servo.energy,
            worst_deficit: servo.worst_deficit,
            dropped: servo.dropped,
            thinned: self.stream.thinned(),
            discarded: self.decoder.discarded(),
            stack_left: (self.info.stack_left)(),
            reset: self.info.reset,
            low_brown_out: self.info.low_brown_out,
            power: (self.info.power)(),
        }
    }
}
