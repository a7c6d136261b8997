//! The board's end of the wire: bytes in, requests to the servo, replies out.
//!
//! Runs below the servo's interrupt and without hardware. The task of the serial port passes received
//! bytes to [`Session::receive`], calls [`Session::poll`], and sends the bytes of [`Session::outgoing`],
//! in a loop. Nothing here waits, and each message causes a bounded amount of work: one request of each
//! kind can be open, and one frame is on its way out.
//!
//! The path of a new set of parameters:
//!
//! ```text
//! ToBoard::Set -> on_message     kept in `requested`, or refused: busy
//!         poll -> prepare_set    certified and built (`tuning::prepare`), or refused with the step
//!                 submit         to the servo's interrupt, which swaps it in (`servo_loop::swap`)
//! Notice::Applied -> on_notice   it is the active set; ToHost::Answer
//! ```

mod outbox;
mod pending_replies;
mod stream;
#[cfg(test)]
mod tests;

use self::outbox::Outbox;
use self::pending_replies::{Greeting, PendingReplies};
use self::stream::Stream;
use super::PROTOCOL;
use super::decoder::Decoder;
use super::description::Description;
use super::frame::CHECKSUM;
use super::message::{
    ActiveParameters, BoardUnits, Changes, FaultCode, Id, LONGEST_TO_BOARD, Outcome, Refusal,
    Status, ToBoard, ToHost,
};
use crate::boot::Program;
use crate::certificate::scene_data;
use crate::environment::Discretize;
use crate::fault::FaultRecord;
use crate::number::Number;
use crate::power_reading::PowerReading;
use crate::reset::ResetCause;
use crate::scene::Scene;
use crate::servo::{OutputMode, PreparedServo, SupportsTiming};
use crate::servo_loop::{self, FrameReader, Notice, Requests};
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
    /// The fault that stopped the board before that reset.
    pub previous_fault: Option<FaultRecord>,
    /// Bytes of the stack that were never used; returns `None` if the board does not measure this.
    pub stack_left: fn() -> Option<u32>,
    /// The measurements of the power stage; returns `None` without a bridge on the board.
    pub power: fn() -> Option<PowerReading>,
}

/// The largest number of notices that one poll takes: more than the queue holds.
const NOTICES: usize = 16;

/// A set of parameters with the damping that the device may lose while it runs.
#[derive(Clone, Copy)]
struct Set<E> {
    scene: Scene<E>,
    margin: Option<f64>,
}

/// The board's end of the wire; `LENGTH` is the length of the servo's queue of frames.
pub struct Session<'a, E: Discretize<N>, N: Number, M, const LENGTH: usize> {
    info: BoardInfo,
    program: Program<E>,
    requests: Requests<'a, PreparedServo<E, N, M>>,
    frames: FrameReader<'a, LENGTH>,
    decoder: Decoder<{ LONGEST_TO_BOARD + CHECKSUM }>,
    outbox: Outbox,
    replies: PendingReplies,
    stream: Stream,
    /// The set that the servo renders.
    active: Set<E>,
    /// The number of sets swapped in before the active set; wraps.
    revision: u32,
    /// Changes that are not certified yet.
    requested: Option<(Id, Changes)>,
    /// The set that was submitted to the servo and is not swapped in yet.
    submitted: Option<(Id, Set<E>)>,
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
            replies: PendingReplies::default(),
            stream: Stream::new(program.scene.timing.period),
            active: Set { scene: program.scene, margin },
            program,
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

    /// Takes the servo's notices, and puts the next frame into the outbox after the previous frame is sent:
    /// replies first, then the answer to a new set of parameters, then telemetry.
    ///
    /// Certifies at most one set, which takes most of a small board's stack.
    pub fn poll(&mut self) {
        for _ in 0..NOTICES {
            let Some(notice) = self.requests.notice() else { break };
            self.on_notice(notice);
        }
        self.stream.take(&mut self.frames);
        if self.outbox.is_empty() {
            self.send_reply();
        }
        if self.outbox.is_empty() {
            self.prepare_set();
        }
        if self.outbox.is_empty() {
            self.send_telemetry();
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

    fn on_message(&mut self, message: ToBoard) {
        match message {
            ToBoard::Hello => self.replies.greet(),
            ToBoard::Get => self.replies.parameters = true,
            ToBoard::Describe => self.replies.description = true,
            ToBoard::Status => self.requests.request_status(),
            ToBoard::Stream(every) => self.stream.set(every),
            ToBoard::Arm { id } => {
                if self.replies.arm(id) {
                    self.requests.arm();
                }
            }
            ToBoard::Align { id } => {
                self.replies.align(id);
                self.requests.align();
            }
            ToBoard::Disarm { id } => {
                self.replies.disarm(id);
                self.requests.disarm();
            }
            ToBoard::Set { id, changes } => match (&self.requested, &self.submitted) {
                (None, None) => self.requested = Some((id, changes)),
                // A host repeats a request because the answer takes a while.
                (Some((before, _)), _) | (_, Some((before, _))) if *before == id => {}
                _ => self.replies.refuse(id, Refusal::Busy),
            },
        }
    }

    fn on_notice(&mut self, notice: Notice) {
        match notice {
            Notice::Status(status) => self.replies.status = Some(status),
            Notice::Armed => self.replies.switched(true, Ok(())),
            Notice::NotArmed(fault) => self.replies.switched(true, Err(fault)),
            Notice::Aligning => self.replies.aligning(Outcome::Done),
            Notice::NotAligning(fault) => {
                let refusal = Refusal::NotAligning(fault.map(FaultCode::from));
                self.replies.aligning(Outcome::Refused(refusal));
            }
            // A stopped servo is disarmed, as requested.
            Notice::Disarmed | Notice::Stopped(_) => {
                self.replies.switched(false, Ok(()));
                // Disarming has priority over the alignment.
                self.replies.aligning(Outcome::Refused(Refusal::Disarming));
            }
            Notice::Applied => {
                if let Some((id, set)) = self.submitted.take() {
                    self.active = set;
                    self.revision = self.revision.wrapping_add(1);
                    self.replies.done(id);
                }
            }
        }
    }

    /// Puts the most urgent reply into the outbox.
    fn send_reply(&mut self) {
        if let Some(part) = self.replies.greeting() {
            self.greet(part);
        } else if let Some((id, outcome)) = self.replies.next_answer() {
            self.outbox.put(&ToHost::Answer { id, outcome });
        } else if let Some(status) = self.replies.status.take() {
            self.outbox.put(&ToHost::Status(self.status(&status)));
        } else if core::mem::take(&mut self.replies.parameters) {
            self.outbox.put(&ToHost::ActiveParameters(self.parameters()));
        } else if core::mem::take(&mut self.replies.description) {
            self.outbox.put(&ToHost::Described(self.description()));
        }
    }

    fn send_telemetry(&mut self) {
        if let Some(batch) = self.stream.batch() {
            self.outbox.put(&ToHost::Telemetry(batch));
        }
    }

    fn greet(&mut self, part: Greeting) {
        let message = match (part, self.info.previous_fault) {
            (Greeting::Welcome, _) => {
                ToHost::Welcome { protocol: PROTOCOL, program: self.info.name }
            }
            (Greeting::PreviousFault, Some(record)) => ToHost::PreviousFault(record.into()),
            (Greeting::PreviousFault, None) => return self.send_reply(),
            (Greeting::Board, _) => ToHost::Board(self.board()),
        };
        self.outbox.put(&message);
    }

    /// Certifies the requested set and submits it to the servo, or refuses it and changes nothing.
    fn prepare_set(&mut self) {
        let Some((id, changes)) = self.requested.take() else { return };
        let Program { transducers, rendering, .. } = &self.program;
        match tuning::prepare(&self.active.scene, &changes, transducers, rendering) {
            Ok(prepared) => {
                let set = Set { scene: prepared.scene, margin: prepared.margin };
                match self.requests.submit(prepared.rendering) {
                    Ok(()) => self.submitted = Some((id, set)),
                    Err(_) => self.replies.refuse(id, Refusal::Busy),
                }
            }
            Err(step) => {
                let outcome = Outcome::Refused(Refusal::Set(step));
                self.outbox.put(&ToHost::Answer { id, outcome });
            }
        }
    }

    fn board(&self) -> BoardUnits {
        let Program { transducers, rendering, .. } = &self.program;
        let period = self.program.scene.timing.period;
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
        let Program { transducers, rendering, .. } = self.program;
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
            power: (self.info.power)(),
        }
    }
}
