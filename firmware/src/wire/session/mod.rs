//! The board's end of the wire: bytes in, requests to the servo, answers out.
//!
//! Runs below the servo's interrupt and without hardware: whoever has a serial port gives the bytes
//! that came to [`Session::receive`], calls [`Session::poll`], and sends what [`Session::outgoing`]
//! holds, over and over. Nothing here waits, and nothing that arrives makes more than a fixed
//! amount of work: of each kind of question one can be open, and one frame is on its way out.

mod outbox;
mod owed;
mod stream;
#[cfg(test)]
mod tests;

use self::outbox::Outbox;
use self::owed::{Greeting, Owed};
use self::stream::Stream;
use super::PROTOCOL;
use super::decoder::Decoder;
use super::description::Description;
use super::frame::CHECKSUM;
use super::message::{
    Board, Changes, FaultCode, Id, LONGEST_TO_BOARD, Outcome, Refusal, Running, Status, ToBoard,
    ToHost,
};
use crate::boot::Program;
use crate::cycle::{self, FrameReader, Notice, Requests};
use crate::environment::Renderable;
use crate::fault::Retained;
use crate::number::Number;
use crate::reset::ResetCause;
use crate::scene::Scene;
use crate::servo::{OutputMode, Rendering, Renders};
use crate::tuning::{self, Tunable};

/// What a board says of itself.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Name of the program.
    pub name: &'static str,
    /// Timer counts in the servo's period.
    pub timer_counts: u32,
    /// Why it was last reset.
    pub reset: ResetCause,
    /// What stopped it before that.
    pub left: Option<Retained>,
    /// Bytes of the stack that were never used; gives `None` where the board cannot tell.
    pub stack_left: fn() -> Option<u32>,
}

/// Notices that a poll looks at: more than can wait.
const NOTICES: usize = 16;

/// A set of parameters with the damping that the device may lose while it runs.
#[derive(Clone, Copy)]
struct Set<E> {
    scene: Scene<E>,
    margin: Option<f64>,
}

/// The board's end of the wire; `LENGTH` is that of the servo's queue of frames.
pub struct Session<'a, E: Renderable<N>, N: Number, M, const LENGTH: usize> {
    facts: Facts,
    program: Program<E>,
    requests: Requests<'a, Rendering<E, N, M>>,
    frames: FrameReader<'a, LENGTH>,
    decoder: Decoder<{ LONGEST_TO_BOARD + CHECKSUM }>,
    outbox: Outbox,
    owed: Owed,
    stream: Stream,
    /// What runs.
    running: Set<E>,
    /// How many were swapped in before it; wraps.
    sets: u32,
    /// Changes that nobody has looked at yet.
    asked: Option<(Id, Changes)>,
    /// What the servo was given and has not taken yet.
    swapping: Option<(Id, Set<E>)>,
}

impl<'a, E, N, M, const LENGTH: usize> Session<'a, E, N, M, LENGTH>
where
    E: Tunable<N> + Renders<M>,
    N: Number,
    M: OutputMode,
{
    /// The wire's end of the servo that runs this program; `margin` is the damping in N m s/rad
    /// that the device may lose with its scene.
    pub fn new(
        program: Program<E>,
        margin: Option<f64>,
        facts: Facts,
        requests: Requests<'a, Rendering<E, N, M>>,
        frames: FrameReader<'a, LENGTH>,
    ) -> Self {
        Self {
            facts,
            requests,
            frames,
            decoder: Decoder::new(),
            outbox: Outbox::new(),
            owed: Owed::default(),
            stream: Stream::new(program.scene.timing.period),
            running: Set { scene: program.scene, margin },
            program,
            sets: 0,
            asked: None,
            swapping: None,
        }
    }

    /// Takes bytes that came in.
    pub fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if let Some(message) = self.decoder.push(byte) {
                self.requests.heard();
                self.hear(message);
            }
        }
    }

    /// Takes what the servo says, and has the next frame ready if the one before has gone.
    ///
    /// Certifies at most one set, which takes most of a small board's stack.
    pub fn poll(&mut self) {
        for _ in 0..NOTICES {
            let Some(notice) = self.requests.notice() else { break };
            self.note(notice);
        }
        self.stream.take(&mut self.frames);
        if self.outbox.is_empty() {
            self.say();
        }
    }

    /// Bytes that are to be sent.
    pub fn outgoing(&self) -> &[u8] {
        self.outbox.rest()
    }

    /// So many of them were sent.
    pub const fn sent(&mut self, bytes: usize) {
        self.outbox.sent(bytes);
    }

    fn hear(&mut self, message: ToBoard) {
        match message {
            ToBoard::Hello => self.owed.greet(),
            ToBoard::Get => self.owed.running = true,
            ToBoard::Describe => self.owed.description = true,
            ToBoard::Status => self.requests.ask_status(),
            ToBoard::Stream(every) => self.stream.set(every),
            ToBoard::Arm { id } => {
                if self.owed.arm(id) {
                    self.requests.arm();
                }
            }
            ToBoard::Disarm { id } => {
                self.owed.disarm(id);
                self.requests.disarm();
            }
            ToBoard::Set { id, changes } => match (&self.asked, &self.swapping) {
                (None, None) => self.asked = Some((id, changes)),
                // Asked again because the answer takes its time.
                (Some((before, _)), _) | (_, Some((before, _))) if *before == id => {}
                _ => self.owed.refuse(id, Refusal::Busy),
            },
        }
    }

    fn note(&mut self, notice: Notice) {
        match notice {
            Notice::Status(status) => self.owed.status = Some(status),
            Notice::Armed => self.owed.switched(true, Ok(())),
            Notice::NotArmed(fault) => self.owed.switched(true, Err(fault)),
            // A servo that has stopped is as disarmed as it was to be.
            Notice::Disarmed | Notice::Stopped(_) => self.owed.switched(false, Ok(())),
            Notice::Applied => {
                if let Some((id, set)) = self.swapping.take() {
                    self.running = set;
                    self.sets = self.sets.wrapping_add(1);
                    self.owed.done(id);
                }
            }
        }
    }

    /// Puts the most urgent thing that is to be said into the outbox.
    fn say(&mut self) {
        if let Some(part) = self.owed.greeting() {
            self.greet(part);
        } else if let Some((id, outcome)) = self.owed.next_answer() {
            self.outbox.put(&ToHost::Answer { id, outcome });
        } else if let Some(status) = self.owed.status.take() {
            self.outbox.put(&ToHost::Status(self.status(&status)));
        } else if core::mem::take(&mut self.owed.running) {
            self.outbox.put(&ToHost::Running(self.numbers()));
        } else if core::mem::take(&mut self.owed.description) {
            self.outbox.put(&ToHost::Described(self.description()));
        } else if let Some((id, changes)) = self.asked.take() {
            self.change(id, &changes);
        } else if let Some(batch) = self.stream.batch() {
            self.outbox.put(&ToHost::Telemetry(batch));
        }
    }

    fn greet(&mut self, part: Greeting) {
        let message = match (part, self.facts.left) {
            (Greeting::Welcome, _) => {
                ToHost::Welcome { protocol: PROTOCOL, program: self.facts.name }
            }
            (Greeting::Remembered, Some(record)) => ToHost::Remembered(record.into()),
            (Greeting::Remembered, None) => return self.say(),
            (Greeting::Board, _) => ToHost::Board(self.board()),
        };
        self.outbox.put(&message);
    }

    /// Certifies a set and gives it to the servo, or refuses it and leaves everything as it is.
    fn change(&mut self, id: Id, changes: &Changes) {
        let Program { transducers, rendering, .. } = &self.program;
        match tuning::prepare(&self.running.scene, changes, transducers, rendering) {
            Ok(prepared) => {
                let set = Set { scene: prepared.scene, margin: prepared.margin };
                match self.requests.submit(prepared.rendering) {
                    Ok(()) => self.swapping = Some((id, set)),
                    Err(_) => self.owed.refuse(id, Refusal::Busy),
                }
            }
            Err(step) => {
                let outcome = Outcome::Refused(Refusal::Set(step));
                self.outbox.put(&ToHost::Answer { id, outcome });
            }
        }
    }

    fn board(&self) -> Board {
        let Program { transducers, rendering, .. } = &self.program;
        let period = self.program.scene.timing.period;
        Board {
            period,
            timer_counts: self.facts.timer_counts,
            counts_per_turn: transducers.counts_per_turn,
            full_scale_torque: transducers.full_scale_torque,
            energy_step: transducers.energy_unit(),
            longest_gap: cycle::longest_gap(rendering, period),
        }
    }

    fn description(&self) -> Description {
        let Program { transducers, rendering, .. } = self.program;
        let (scene, format, timing) = (E::as_data(&self.running.scene), N::FORMAT, M::TIMING);
        Description { scene, transducers, rendering, format, timing }
    }

    fn numbers(&self) -> Running {
        let Set { scene, margin } = &self.running;
        let named = |parameter| tuning::get(scene, parameter).map(|value| (parameter, value));
        let values = tuning::parameters(scene).iter().filter_map(named).collect();
        Running { sets: self.sets, margin: *margin, values }
    }

    fn status(&self, servo: &cycle::Status) -> Status {
        Status {
            state: servo.state,
            fault: servo.fault.map(FaultCode::from),
            link_lost: servo.link_lost,
            tick: servo.tick,
            count: servo.count,
            sets: self.sets,
            missed: servo.missed,
            worst_slack: servo.worst_slack,
            energy: servo.energy,
            worst_deficit: servo.worst_deficit,
            dropped: servo.dropped,
            thinned: self.stream.thinned(),
            discarded: self.decoder.discarded(),
            stack_left: (self.facts.stack_left)(),
            reset: self.facts.reset,
        }
    }
}
