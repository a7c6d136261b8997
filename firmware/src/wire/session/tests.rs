//! A host's side of a session, with a servo that runs behind it.

mod floods;
mod interrupted;

use std::boxed::Box;
use std::string::{String, ToString};
use std::vec::Vec;

use proptest::collection::vec;
use proptest::prelude::*;

use super::*;
use crate::certificate::Parameter;
use crate::current::IndexOffset;
use crate::dac::DacCode;
use crate::environment::{
    Anticogging, Canceller, Damper, Drag, Ends, Environment, KNOB_MODES, Knots, Parts, Profile,
    Shape, Side, Wall,
};
use crate::fault::Fault;
use crate::number::Format;
use crate::scene::{Device, Timing};
use crate::servo::{Latched, RenderingOptions, Step, Transducers};
use crate::servo_loop::tests::board::Board;
use crate::servo_loop::{Frame, FrameQueue, Frames, Inbox, Mailbox, OutputEvent, ServoLoop, State};
use crate::test_scene;
use crate::tuning::RenderError;
use crate::wire::message::{LONGEST_TO_HOST, ToBoard, ToHost};
use crate::wire::{Discarded, encode, largest_frame};

const SCENE: Scene = Scene {
    torque_limit: Some(1.0),
    ..test_scene::scene(Wall::damped(22.0, 0.01, 1).behind(0.0).alone())
};

fn program() -> Program<Environment> {
    Program {
        scene: SCENE,
        transducers: Transducers {
            largest_speed: Transducers::NO_HAND_IS_FASTER,
            ..test_scene::PADDLE
        },
        rendering: RenderingOptions { fade: 0.02, injection: None, ..RenderingOptions::DEFAULT },
        options: servo_loop::Options::DEFAULT,
    }
}

type Said = ToHost<String>;

/// Of a board with a bridge; the numbers are as long as they get.
const READING: PowerReading = PowerReading {
    current: i32::MIN,
    reference: 400,
    voltage: u32::MAX,
    temperature: i32::MIN,
    index: Some(IndexOffset { counts: u32::MAX, is_reversed: true }),
};

/// Counts inside the wall.
const INSIDE: i32 = 100;

const FRAMES: usize = 32;

/// A session, the servo behind it, and the host's ear.
struct Bench {
    session: Served,
    servo_loop: ServoLoop<Environment, f32, Latched>,
    /// A device that is held still, [`INSIDE`] the wall.
    hardware: Board,
    inbox: Inbox<'static, PreparedServo<Environment, f32, Latched>>,
    frames: Frames<'static, FRAMES>,
    ear: Decoder<{ LONGEST_TO_HOST + CHECKSUM }>,
}

impl Bench {
    fn new(previous_fault: Option<FaultRecord>) -> Self {
        let program = program();
        let (requests, inbox) = Box::leak(Box::new(Mailbox::new())).split();
        let (frames, queue) = Box::leak(Box::new(FrameQueue::<FRAMES>::new())).split();
        let Program { scene, transducers, rendering, options } = &program;
        let prepared =
            tuning::prepare::<_, f32, Latched>(scene, &[], transducers, rendering).unwrap();
        let servo_loop = ServoLoop::new(prepared.rendering, options, 1000, None);
        let reset = ResetCause::Pin;
        let info = BoardInfo {
            name: "wall",
            timer_counts: 1000,
            reset,
            low_brown_out: true,
            previous_fault,
            stack_left: || Some(77),
            power: || Some(READING),
        };
        requests.arm();
        let session = Session::new(program, prepared.margin, info, requests, queue);
        let hardware = Board { count: INSIDE, ..Board::new() };
        Self { session, servo_loop, hardware, inbox, frames, ear: Decoder::new() }
    }

    fn tell(&mut self, message: &ToBoard) {
        self.session.receive(&frame(message));
    }

    /// Serves the wire, which takes this number of bytes; returns the bytes and the board's messages.
    fn serve(&mut self, most: usize) -> (usize, Vec<Said>) {
        serve(&mut self.session, &mut self.ear, most)
    }

    fn tick(&mut self) {
        self.servo_loop.run(&mut self.hardware, &mut self.inbox, &mut self.frames);
    }

    /// Runs ticks and serves the wire after each; returns the board's messages.
    fn run(&mut self, ticks: usize) -> Vec<Said> {
        let mut said = Vec::new();
        for _ in 0..ticks {
            self.tick();
            said.extend(self.serve(usize::MAX).1);
        }
        said
    }

    /// The answer to a request, within half a second.
    fn ask(&mut self, message: &ToBoard) -> Vec<Said> {
        self.tell(message);
        self.run(500)
    }

    fn set(&mut self, id: Id, changes: &[(Parameter, f64)]) -> Outcome {
        let said = self.ask(&set(id, changes));
        match said.as_slice() {
            [ToHost::Answer { id: answered, outcome }] if *answered == id => *outcome,
            other => panic!("{other:?}"),
        }
    }

    /// The words that a host has for a set that was refused.
    fn why(&mut self, changes: &[(Parameter, f64)]) -> String {
        let said = self.ask(&ToBoard::Describe);
        let [ToHost::Described(description)] = said.as_slice() else { panic!("{said:?}") };
        let values = self.running().values;
        let has = tuning::Parameters::of(values.iter().map(|(parameter, _)| *parameter));
        description.explain(has, None, changes).unwrap_err().to_string()
    }

    fn running(&mut self) -> ActiveParameters {
        match self.ask(&ToBoard::Get).as_slice() {
            [ToHost::ActiveParameters(running)] => running.clone(),
            other => panic!("{other:?}"),
        }
    }

    fn status(&mut self) -> Status {
        let said = self.ask(&ToBoard::Status);
        let mut statuses = said.iter().filter_map(|said| match said {
            ToHost::Status(status) => Some(*status),
            _ => None,
        });
        statuses.next().expect("a board says how it is going")
    }
}

type Served = Session<'static, Environment, f32, Latched, FRAMES>;

/// Serves a session's wire once: the bytes that it took, and the messages in them.
fn serve(
    session: &mut Served,
    ear: &mut Decoder<{ LONGEST_TO_HOST + CHECKSUM }>,
    most: usize,
) -> (usize, Vec<Said>) {
    session.poll();
    let bytes = session.outgoing();
    let bytes = bytes[..bytes.len().min(most)].to_vec();
    session.sent(bytes.len());
    (bytes.len(), bytes.iter().filter_map(|&byte| ear.push::<Said>(byte)).collect())
}

fn frame(message: &ToBoard) -> Vec<u8> {
    let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
    encode(message, &mut buffer).unwrap().to_vec()
}

fn set(id: Id, changes: &[(Parameter, f64)]) -> ToBoard {
    ToBoard::Set { id, changes: Changes::from_slice(changes).unwrap() }
}

fn stiffness(id: Id, stiffness: f64) -> ToBoard {
    set(id, &[(Parameter::Stiffness, stiffness)])
}

fn refused(id: Id, refusal: Refusal) -> Said {
    ToHost::Answer { id, outcome: Outcome::Refused(refusal) }
}

/// With everything that a description can have, and numbers that take all their bytes.
fn longest_status(fault: FaultCode) -> Status {
    let discarded = u32::MAX;
    Status {
        state: State::Faulted,
        fault: Some(fault),
        link_lost: true,
        tick: u32::MAX,
        count: i64::MIN,
        sets: u32::MAX,
        missed: u32::MAX,
        worst_slack: u32::MAX,
        energy: i64::MIN,
        worst_deficit: i64::MAX,
        dropped: u32::MAX,
        thinned: u32::MAX,
        discarded: Discarded {
            broken: discarded,
            too_long: discarded,
            checksum: discarded,
            unknown: discarded,
        },
        stack_left: Some(u32::MAX),
        reset: ResetCause::OptionBytes,
        low_brown_out: true,
        power: Some(READING),
    }
}

fn largest_description() -> Description {
    // A snap point beside other parts has no certificate.
    static KNOTS: Knots<1024> = Knots::of(&[Shape::detents(24, 1.0)]);
    let mut modes = Profile::of_modes(&KNOB_MODES, 1).modes.unwrap();
    modes.count = u32::MAX;
    let profile = Profile {
        ends: Some(Ends { from: -1.0, to: 1.0, stiffness: 1.0 }),
        modes: Some(modes),
        ..Profile::of(&KNOTS, 8)
    };
    let wall = Wall {
        stiffness: 1.0,
        damper: Some(Damper { damping: 1.0, filter: Some(1.0) }),
        side: Side::Face(1.0),
        delay: 8,
    };
    let canceller = Some(Canceller::to(1.0));
    let drag = Some(Drag::of(1.0, 8));
    let environment =
        Parts { canceller, wall: Some(wall), profile: Some(profile), drag, ..Parts::NONE }.sum();
    let torques: Vec<_> = (0..2048).map(|i| f64::from(i % 2)).collect();
    let learnt = Anticogging::learnt(&torques, vec![0; 2048].leak()).unwrap();
    let environment = environment.beside(learnt);
    Description {
        scene: Scene {
            device: Device { passivity: Some(1.0), ..SCENE.device },
            timing: Timing { worst_period: Some(1.0), ..SCENE.timing },
            environment,
            ..SCENE
        },
        transducers: program().transducers,
        rendering: RenderingOptions { injection: Some(1.0), ..program().rendering },
        format: Format::Fixed { fraction_bits: u32::MAX },
        timing: crate::servo::OutputTiming::AtPhase(u32::MAX),
    }
}

fn done(id: Id) -> Said {
    ToHost::Answer { id, outcome: Outcome::Done }
}

/// Torque in codes of a wall of that stiffness behind the coupling, [`INSIDE`] the wall.
fn codes(stiffness: f64) -> f64 {
    let angle = f64::from(INSIDE) * core::f64::consts::TAU / 61_440.0;
    -angle * stiffness / (1.0 + stiffness / 44.0) * 1791.0 / 2.0
}

#[test]
fn greets_with_what_its_numbers_mean() {
    let fault = crate::fault::Fault::Watchdog;
    let record = FaultRecord { fault, tick: 7, count: -8 };
    let mut bench = Bench::new(Some(record));
    let said = bench.ask(&ToBoard::Hello);
    let [
        ToHost::Welcome { protocol: PROTOCOL, program },
        ToHost::PreviousFault(previous_fault),
        ToHost::Board(board),
    ] = said.as_slice()
    else {
        panic!("{said:?}")
    };
    assert_eq!(program, "wall");
    assert_eq!(
        (previous_fault.fault.fault(), previous_fault.tick, previous_fault.count),
        (Some(fault), 7, -8)
    );
    assert_eq!((board.period, board.timer_counts), (0.001, 1000));
    let said = Bench::new(None).ask(&ToBoard::Hello);
    assert!(matches!(said.as_slice(), [ToHost::Welcome { .. }, ToHost::Board(_)]), "{said:?}");
}

#[test]
fn a_certified_set_runs_whole() {
    let mut bench = Bench::new(None);
    assert_eq!(bench.running().sets, 0);
    let margin = SCENE.certify_in(Format::F32).unwrap().assessment().margin(&SCENE);
    assert_eq!(bench.running().margin, margin);
    let changes = [(Parameter::Stiffness, 12.0), (Parameter::Damping, 0.002)];
    assert_eq!(bench.set(1, &changes), Outcome::Done);
    let running = bench.running();
    assert_eq!(running.sets, 1);
    assert!(running.margin > margin);
    for change in changes {
        assert!(running.values.contains(&change), "{running:?}");
    }
    assert!(running.values.contains(&(Parameter::CouplingStiffness, 44.0)));
    assert_eq!(bench.status().state, State::Running);
    let offset = f64::from(bench.hardware.code().offset());
    assert!((offset - codes(12.0)).abs() <= 1.0, "{offset} is not {}", codes(12.0));
}

#[test]
fn a_refused_set_changes_nothing_and_its_host_has_the_compilers_sentence() {
    let mut bench = Bench::new(None);
    bench.run(500);
    let (before, code) = (bench.running(), bench.hardware.code());
    let mut scene = SCENE;
    scene.environment.wall_mut().unwrap().stiffness = 30.0;
    let sentence = scene.certify_in(Format::F32).unwrap_err().to_string();
    assert!(sentence.starts_with("rejected: "));
    let changes = [(Parameter::Damping, 0.01), (Parameter::Stiffness, 30.0)];
    assert_eq!(bench.set(2, &changes), Outcome::Refused(Refusal::Set(Step::Certificate)));
    assert_eq!(bench.why(&changes), sentence);
    for (changes, step, part) in [
        ([(Parameter::Residual, 0.1)], Step::Change, "has no residual"),
        ([(Parameter::Period, 0.1)], Step::Change, "period is fixed"),
        ([(Parameter::Stiffness, f64::NAN)], Step::Certificate, "must be finite"),
        ([(Parameter::TorqueLimit, 5.0)], Step::Servo, "above the DAC's full scale"),
    ] {
        assert_eq!(bench.set(3, &changes), Outcome::Refused(Refusal::Set(step)), "{part}");
        let sentence = bench.why(&changes);
        assert!(sentence.contains(part), "{sentence}");
    }
    assert_eq!((bench.running(), bench.hardware.code()), (before, code));
    assert_eq!(bench.status().sets, 0);
}

#[test]
fn a_status_has_what_the_board_itself_knows() {
    let Status { stack_left, power, reset, low_brown_out, .. } = Bench::new(None).status();
    assert!(low_brown_out);
    assert_eq!((stack_left, power, reset), (Some(77), Some(READING), ResetCause::Pin));
}

#[test]
fn one_set_at_a_time() {
    let mut bench = Bench::new(None);
    bench.run(500);
    bench.tell(&stiffness(1, 10.0));
    // Asked again, which is the same request and not another one.
    bench.tell(&stiffness(1, 10.0));
    bench.tell(&stiffness(2, 11.0));
    let said = bench.run(3);
    assert_eq!(said, [refused(2, Refusal::Busy)]);
    bench.tell(&stiffness(1, 10.0));
    assert_eq!(bench.run(500), [done(1)]);
    assert!(bench.running().values.contains(&(Parameter::Stiffness, 10.0)));
}

#[test]
fn disarming_goes_before_arming() {
    let mut bench = Bench::new(None);
    bench.run(500);
    assert_eq!(bench.ask(&ToBoard::Disarm { id: 1 }), [done(1)]);
    assert_eq!(bench.status().state, State::Disarmed);
    assert_eq!(bench.hardware.code(), DacCode::MID_SCALE);
    assert_eq!(bench.ask(&ToBoard::Arm { id: 2 }), [done(2)]);
    assert_eq!(bench.status().state, State::Running);
    for (first, second) in [
        (ToBoard::Arm { id: 3 }, ToBoard::Disarm { id: 4 }),
        (ToBoard::Disarm { id: 4 }, ToBoard::Arm { id: 3 }),
    ] {
        bench.tell(&first);
        bench.tell(&second);
        let mut said = bench.run(500);
        // Kinds of answers take turns.
        said.sort_by_key(|said| *said == done(4));
        assert_eq!(said, [refused(3, Refusal::Disarming), done(4)]);
        assert_eq!(bench.status().state, State::Disarmed);
    }
}

#[test]
fn streams_what_it_is_asked_for_and_leaves_out_what_the_wire_does_not_take() {
    let mut bench = Bench::new(None);
    let every = core::num::NonZeroU32::new(10);
    let said = bench.ask(&ToBoard::Stream(every));
    let ticks: Vec<Frame> = said.iter().flat_map(ticks).collect();
    assert!(ticks.len() > 40 && ticks.windows(2).all(|two| two[1].tick == two[0].tick + 10));
    assert!(ticks.iter().all(|tick| tick.count == INSIDE && tick.slack == 700));
    assert_eq!(ticks.last().unwrap().code, bench.hardware.code());
    assert_eq!(bench.status().thinned, 0);
    bench.tell(&ToBoard::Stream(core::num::NonZeroU32::new(1)));
    // Nothing is sent for a while: the servo's queue does not overflow for that.
    for _ in 0..1000 {
        bench.tick();
        bench.session.poll();
    }
    bench.run(100);
    bench.tell(&ToBoard::Stream(None));
    bench.run(10);
    let status = bench.status();
    assert_eq!(status.dropped, 0);
    assert!((900..1000).contains(&status.thinned), "{status:?}");
    assert_eq!(bench.run(500), []);
}

fn ticks(said: &Said) -> Vec<Frame> {
    match said {
        ToHost::Telemetry(batch) => batch.ticks().collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_frame_may_take_its_time() {
    let mut bench = Bench::new(None);
    let frame = frame(&stiffness(5, 9.0));
    let (first, second) = frame.split_at(frame.len() / 2);
    bench.session.receive(first);
    assert_eq!(bench.run(2000), []);
    bench.session.receive(second);
    assert_eq!(bench.run(500), [done(5)]);
}

/// Also where there are more than one set may change.
#[test]
fn every_tunable_number_is_listed() {
    let mut bench = Bench::new(None);
    bench.session.active.scene = largest_description().scene;
    let listed = bench.running().values;
    let named: Vec<_> =
        listed.iter().filter_map(|(parameter, _)| tuning::name(*parameter)).collect();
    assert_eq!(named, tuning::TUNABLE.map(|(name, _)| name));
}

#[test]
fn every_message_fits_its_frame() {
    let pairs = [(Parameter::UnitZeros, -1.0e-300); super::super::message::MAX_CHANGES];
    let changes = Changes::from_slice(&pairs).unwrap();
    let set = ToBoard::Set { id: u16::MAX, changes };
    assert!(postcard::to_slice(&set, &mut [0; LONGEST_TO_BOARD]).is_ok());
    let mut batch = crate::wire::telemetry::Batch::new();
    let (limit, state) = (crate::torque::LimitReason::None, State::Faulted);
    for sign in 0..crate::wire::telemetry::BATCH as u32 {
        let (tick, count) = (sign.wrapping_mul(u32::MAX / 2), i32::MIN * (sign % 2) as i32);
        let frame = Frame { tick, count, code: DacCode::MAX, limit, state, slack: u32::MAX };
        batch.push(frame).unwrap();
    }
    let fault = FaultCode { code: u32::MAX, numbers: [u32::MAX; 2] };
    let outcome = Outcome::Refused(Refusal::Fault(fault));
    for message in [
        Said::Telemetry(batch),
        ToHost::Answer { id: u16::MAX, outcome },
        ToHost::Status(longest_status(fault)),
        ToHost::ActiveParameters(ActiveParameters {
            sets: u32::MAX,
            margin: Some(1.0),
            values: tuning::TUNABLE
                .map(|(_, parameter)| (parameter, -1.0e-300))
                .into_iter()
                .collect(),
        }),
        ToHost::Described(largest_description()),
    ] {
        let bytes = postcard::to_slice(&message, &mut [0; 1024]).unwrap().len();
        assert!(bytes <= LONGEST_TO_HOST, "{bytes} bytes");
    }
}

/// Bytes that are noise, and frames in whole or in part.
fn garbage() -> impl Strategy<Value = Vec<u8>> {
    let frame = (any::<u8>(), 0_usize..120, any::<u8>()).prop_map(|(kind, cut, flip)| {
        let message = match kind % 6 {
            0 => ToBoard::Hello,
            1 => ToBoard::Get,
            2 => ToBoard::Status,
            // Never certified, with any neighbours.
            3 => stiffness(1, 1000.0),
            4 => ToBoard::Stream(core::num::NonZeroU32::new(3)),
            _ => ToBoard::Arm { id: 9 },
        };
        let mut frame = frame(&message);
        frame.truncate(cut);
        if flip % 4 == 0 && !frame.is_empty() {
            let place = usize::from(flip) % frame.len();
            frame[place] ^= flip;
        }
        frame
    });
    let piece = prop_oneof![frame, vec(any::<u8>(), 0..300), Just(std::vec![0x41; 2000])];
    vec(piece, 0..30).prop_map(|pieces| pieces.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Beside a servo whose wire is silent: the codes are the same, tick by tick.
    #[test]
    fn garbage_and_floods_do_not_reach_the_servo(
        garbage in garbage(),
        chunk in 1_usize..500,
    ) {
        let (mut bench, mut silent) = (Bench::new(None), Bench::new(None));
        let mut rest = garbage.as_slice();
        for _ in 0..300 {
            let now = rest.split_off(..chunk.min(rest.len())).unwrap();
            bench.session.receive(now);
            bench.run(1);
            silent.run(1);
            prop_assert_eq!(bench.hardware.code(), silent.hardware.code());
            prop_assert_eq!(bench.servo_loop.state(), silent.servo_loop.state());
        }
        bench.tell(&ToBoard::Stream(None));
        bench.run(100);
        let status = bench.status();
        prop_assert_eq!((status.missed, status.dropped, status.sets), (0, 0, 0));
        prop_assert_eq!(bench.set(77, &[(Parameter::Stiffness, 5.0)]), Outcome::Done);
    }

    /// Beside the judgement of the whole scene, made apart from the wire.
    #[test]
    fn what_is_not_certified_never_runs(
        sets in vec((0.0_f64..44.0, -0.01_f64..0.03, -0.1_f64..0.1), 1..10),
    ) {
        let mut bench = Bench::new(None);
        let mut scene = SCENE;
        for (id, (stiffness, damping, face)) in sets.into_iter().enumerate() {
            let mut wanted = scene;
            wanted.environment = Wall::damped(stiffness, damping, 1).behind(face).alone();
            let changes = [
                (Parameter::Face, face),
                (Parameter::Damping, damping),
                (Parameter::Stiffness, stiffness),
            ];
            let outcome = bench.set(id as Id, &changes);
            let timed = wanted.certify_in(Format::F32).map_err(RenderError::from);
            let timed = timed.and_then(|certified| Ok(certified.time::<Latched>()?));
            match timed {
                Ok(_) => {
                    scene = wanted;
                    prop_assert_eq!(outcome, Outcome::Done);
                }
                Err(reason) => {
                    let refused = Outcome::Refused(Refusal::Set(reason.step()));
                    prop_assert_eq!(outcome, refused);
                    prop_assert_eq!(bench.why(&changes), reason.to_string());
                }
            }
            bench.run(400);
            let wall = scene.environment.wall().unwrap();
            // Near its limit (equation 27) a wall is certified and rings at half the sample rate for
            // as long as one likes: its torque at rest is still to come.
            if wall.stiffness * 0.001 / 2.0 + wall.damping().abs() > 0.9 * 0.022 {
                continue;
            }
            let depth = f64::from(INSIDE) * core::f64::consts::TAU / 61_440.0 - wall.face();
            let torque = (wall.stiffness * depth / (1.0 + wall.stiffness / 44.0)).clamp(0.0, 1.0);
            let offset = f64::from(bench.hardware.code().offset());
            prop_assert!((offset + torque * 1791.0 / 2.0).abs() <= 1.0, "{offset}, {torque}");
        }
    }
}
