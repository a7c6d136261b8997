//! Any sets of parameters over the wire into a servo that runs: certificate, swap and ticks.

use std::sync::OnceLock;

use haptic_servo::board::sim_hardware::{SimHardware, SimIo};
use haptic_servo::boot::Program;
use haptic_servo::certificate::Parameter;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::environment::{Canceller, Environment, Side, Wall};
use haptic_servo::reset::ResetCause;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{Latched, PreparedServo, RenderingOptions, Transducers};
use haptic_servo::servo_loop::{FrameQueue, Frames, Inbox, Mailbox, Options, ServoLoop};
use haptic_servo::tuning;
use haptic_servo::wire::message::{
    Changes, LONGEST_TO_BOARD, LONGEST_TO_HOST, Outcome, ToBoard, ToHost,
};
use haptic_servo::wire::{BoardInfo, CHECKSUM, Decoder, Session, encode, largest_frame};

/// Sets of one input.
const SETS: usize = 2;
/// Ticks after each: more than a swap takes.
const TICKS: usize = 40;
/// Frames that wait.
const FRAMES: usize = 16;

/// Scenes.
const KINDS: usize = 6;

/// A servo that is ready to run.
type Prepared = PreparedServo<Environment, f32, Latched>;
/// The servo of a scene before anything is changed, judged once.
type First = OnceLock<Prepared>;

/// The first byte says which scene; sets and the hand's motion follow.
pub fn run(data: &[u8]) {
    static FIRST: [First; KINDS] = [const { OnceLock::new() }; KINDS];
    let Some((kind, rest)) = data.split_first() else { return };
    let kind = usize::from(*kind) % KINDS;
    let wall = Wall::damped(22.0, 0.01, 1);
    let (environment, limit) = match kind {
        0 => (wall.behind(0.0).alone(), Some(1.0)),
        1 => (Wall { side: Side::Displaced(0.01), ..wall }.alone(), None),
        2 => (Wall::spring(21.0, 1).alone(), None),
        3 => (Wall::spring(7.0, 3).alone(), Some(0.3)),
        4 => (Wall::damped(10.0, 0.01, 1).filtered(0.5).alone(), Some(1.0)),
        _ => (Canceller { residual: 0.015, delay: 1 }.alone(), None),
    };
    drive(&FIRST[kind], program(environment, limit), rest);
}

const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    largest_speed: Transducers::NO_HAND_IS_FASTER,
};

fn program(environment: Environment, torque_limit: Option<f64>) -> Program<Environment> {
    Program {
        scene: Scene {
            device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
            timing: Timing { period: 0.001, worst_period: None },
            coupling: Coupling::Spring { stiffness: 44.0 },
            environment,
            latency: Latency::NONE,
            torque_limit,
        },
        transducers: TRANSDUCERS,
        rendering: RenderingOptions { fade: 0.004, injection: None, ..RenderingOptions::DEFAULT },
        options: Options::DEFAULT,
    }
}

/// Bytes as numbers, for as long as there are any.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    fn word<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    /// Any number, or a number that is likely to certify.
    fn value(&mut self) -> Option<f64> {
        let kind = self.byte()?;
        if kind < 16 {
            return Some(f64::from_le_bytes(self.word()?));
        }
        let digits = f64::from(i16::from_le_bytes(self.word()?));
        Some(digits * [1e-6, 1e-5, 1e-4, 1e-3][usize::from(kind % 4)])
    }

    fn changes(&mut self) -> Option<Changes> {
        const NAMES: [Parameter; 9] = [
            Parameter::Stiffness,
            Parameter::Damping,
            Parameter::Face,
            Parameter::Filter,
            Parameter::Residual,
            Parameter::CouplingStiffness,
            Parameter::TorqueLimit,
            Parameter::Period,
            Parameter::Passivity,
        ];
        let mut changes = Changes::new();
        for _ in 0..1 + self.byte()? % 3 {
            let name = NAMES[usize::from(self.byte()?) % NAMES.len()];
            changes.push((name, self.value()?)).expect("there is room for three");
        }
        Some(changes)
    }
}

/// Timer counts in a period.
const PERIOD: u32 = 1000;

/// A device with a prescribed motion.
#[derive(Clone)]
struct Still {
    count: i16,
    code: DacCode,
}

impl SimIo for Still {
    fn count(&mut self) -> RawCount {
        RawCount::from(self.count)
    }

    fn write(&mut self, code: DacCode) {
        self.code = code;
    }
}

/// A servo with what belongs to its interrupt.
struct Running<'a> {
    servo_loop: ServoLoop<Environment, f32, Latched>,
    device: SimHardware<Still>,
    inbox: Inbox<'a, Prepared>,
    frames: Frames<'a, FRAMES>,
}

impl Running<'_> {
    fn tick(&mut self, count: i16) -> DacCode {
        self.device.lines.count = count;
        self.servo_loop.run(&mut self.device, &mut self.inbox, &mut self.frames);
        self.device.lines.code
    }
}

fn drive(first: &First, program: Program<Environment>, data: &[u8]) {
    let Program { scene, transducers, rendering, options } = &program;
    let judged = || {
        let prepared = tuning::prepare(scene, &[], transducers, rendering);
        prepared.expect("it is certified").rendering
    };
    let first = first.get_or_init(judged).clone();
    let (mut mailbox, mut queue) = (Mailbox::new(), FrameQueue::new());
    let ((requests, inbox), (frames, reader)) = (mailbox.split(), queue.split());
    requests.arm();
    let device = SimHardware::new(Still { count: 0, code: DacCode::MID_SCALE }, PERIOD);
    let servo_loop = ServoLoop::new(first, options, PERIOD, None);
    let mut servo = Running { servo_loop, device, inbox, frames };
    let facts = BoardInfo {
        name: "any",
        timer_counts: 1000,
        reset: ResetCause::PowerOn,
        low_brown_out: false,
        previous_fault: None,
        stack_left: || None,
        power: || None,
    };
    let mut session = Session::new(program, None, facts, requests, reader);
    let mut limit = scene.torque_limit.unwrap_or(TRANSDUCERS.full_scale_torque);
    let (mut bytes, mut count) = (Reader(data), 0_i16);
    for _ in 0..TICKS {
        // It is armed.
        servo.tick(count);
        session.poll();
    }
    for id in 0..SETS as u16 {
        let Some(changes) = bytes.changes() else { return };
        let set = ToBoard::Set { id, changes: changes.clone() };
        let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
        session.receive(encode(&set, &mut buffer).expect("a set fits"));
        let (mut silent_mailbox, mut silent_queue) = (Mailbox::new(), FrameQueue::new());
        let ((_quiet, inbox), (frames, _unread)) = (silent_mailbox.split(), silent_queue.split());
        let (servo_loop, device) = (servo.servo_loop.clone(), servo.device.clone());
        let mut silent = Running { servo_loop, device, inbox, frames };
        let told = changes.iter().find(|(name, _)| *name == Parameter::TorqueLimit);
        let new_limit = told.map_or(limit, |(_, value)| *value);
        let (mut differs, mut outcome) = (false, None);
        for _ in 0..TICKS {
            let step = bytes.byte().unwrap_or(0).cast_signed();
            count = count.wrapping_add(step.into());
            let code = servo.tick(count);
            differs |= code != silent.tick(count);
            within(code, if outcome == Some(false) { limit } else { limit.max(new_limit) });
            session.poll();
            outcome = outcome.or(answer(session.outgoing()));
            session.sent(session.outgoing().len());
            assert_eq!(servo.servo_loop.fault(), None);
        }
        match outcome.expect("a set is answered while it is swapped in") {
            true => limit = new_limit,
            false => assert!(!differs, "a refused set was felt"),
        }
    }
}

/// The torque never exceeds its limit by more than the rounding to a code.
fn within(code: DacCode, limit: f64) {
    let largest = limit / TRANSDUCERS.full_scale_torque * f64::from(DacCode::CODES_TO_FULL_SCALE);
    assert!(f64::from(code.offset()).abs() <= largest + 0.5, "{code:?}, {limit} N m");
}

/// Whether a request was done; `None` where these bytes are no answer.
fn answer(bytes: &[u8]) -> Option<bool> {
    let mut ear = Decoder::<{ LONGEST_TO_HOST + CHECKSUM }>::new();
    bytes.iter().find_map(|&byte| match ear.push::<ToHost<&str>>(byte)? {
        ToHost::Answer { outcome: Outcome::Done, .. } => Some(true),
        ToHost::Answer { outcome: Outcome::Refused(_), .. } => Some(false),
        other => panic!("{other:?}"),
    })
}
