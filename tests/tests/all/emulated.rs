//! The scenes' programs on the emulated board, against the same servo on the host.
//!
//! Fails if a single DAC code differs, if a certificate differs by a bit between compiler, host
//! and board, or if the board drops a frame or misses a tick.

use std::path::{Path, PathBuf};
use std::time::Duration;

use analysis::emulator::{Client, Emulator, EmulatorError, EmulatorReport};
use analysis::program::{damper_wall, delayed_spring, free_mode, knob};
use analysis::studies::bench;
use analysis::studies::bench::on_target::{contact_instructions, live_set, profiles};
use analysis::studies::number_format::{Motion, cost};
use analysis::studies::tradeoff::{servo, sine};
use analysis::toolchain::NumberFormat;
use firmware_harness::bench_request::BenchRequest;
use firmware_harness::scene_codec::{CertifyReply, IntervalBits};
use firmware_harness::sines::Sine;
use haptic_servo::certificate::{Certified, Parameter, assess};
use haptic_servo::encoder::RawCount;
use haptic_servo::environment::{Canceller, Wall};
use haptic_servo::number::{Arithmetic, Number};
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::{Coupling, Latency, Scene};
use haptic_servo::servo::{Servo, Transducers};
use haptic_servo::tuning::Tunable;
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tests::vectors;

use crate::toolchain::{TOOLCHAIN, bench_board, harness};

/// Ticks of each run.
const TICKS: usize = 5_000;

/// Judging may not need more instructions than 20 ms of a core at 170 MHz.
const MOST_TO_JUDGE: u64 = 3_400_000;

fn program(name: &str, format: NumberFormat) -> PathBuf {
    TOOLCHAIN.build_scene(name, format).unwrap_or_else(|error| panic!("{error}"))
}

/// Counts of a hand that wanders, jerks, stands still, flings the device so far that the torque is
/// limited, and turns through the counter's wrap; never faster than the device can be.
fn counts(seed: u64) -> Vec<i32> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut count = 0_i32;
    let mut speed = 0;
    (0..TICKS)
        .map(|tick| {
            if tick % 100 == 0 {
                speed = match random.random_range(0..5) {
                    0 => random.random_range(-700..=700),
                    _ => random.random_range(-40..=40),
                };
            }
            count += match random.random_range(0..50) {
                0 => random.random_range(-77..=77),
                1 => random.random_range(-900..=900),
                2..=10 => 0,
                _ => speed + random.random_range(-1..=1),
            };
            count
        })
        .collect()
}

/// Runs a program and the host's servo on the same counts.
fn run<E, N>(
    name: &str,
    format: NumberFormat,
    certified: &Certified<Scene<E>>,
    transducers: &Transducers,
) -> EmulatorReport
where
    E: Tunable<N>,
    N: Number,
{
    let mut servo = Servo::<E, N>::new(certified, transducers).unwrap();
    let mut board = Emulator::boot(&program(name, format)).unwrap();
    board.arm_and_wait().unwrap();
    let counts = counts(1);
    assert!(counts.iter().any(|count| count.abs() > 1 << 15), "the counter wraps");
    for (tick, count) in counts.into_iter().enumerate() {
        let code = board.exchange(count).unwrap_or_else(|error| panic!("tick {tick}: {error}"));
        let expected = servo.tick(RawCount::from(count)).code.get();
        assert_eq!(code, expected, "{name} in {format}, tick {tick}, count {count}");
    }
    let report = board.finish().unwrap();
    for line in &report.log {
        println!("{name} {format} {line}");
    }
    report
}

fn bits(index: Option<Interval>) -> IntervalBits {
    index.map(|index| (index.lo().to_bits(), index.hi().to_bits()))
}

/// What holds for every run.
fn check<E>(report: &EmulatorReport, certified: &Certified<Scene<E>>) {
    assert_eq!((report.ticks, report.dropped, report.overruns), (TICKS as u64, 0, 0));
    assert_eq!(report.calibration.per_instruction, 32, "the emulator counts 32 ns an instruction");
    assert_eq!(report.compute_instructions.count, TICKS as u64);
    assert!(report.interrupt_instructions.min > report.compute_instructions.min);
    let assessment = certified.assessment();
    for found in [report.board, report.compiler] {
        assert_eq!(found.alpha, bits(assessment.alpha));
        assert_eq!(found.alpha_coupled, bits(assessment.alpha_coupled));
    }
    assert!(report.board.alpha.is_some());
    assert!(report.certify_instructions <= MOST_TO_JUDGE, "{}", report.certify_instructions);
    // Judging needs the most stack; a kibibyte is kept for what a change may add to it.
    let (used, size) = (report.stack_used, report.stack_size);
    assert!(used + 1024 <= size, "{used} of {size} bytes of stack used");
}

/// The board's judgement of a scene, which is that of the host, bit for bit.
fn judged_alike(board: &mut Client, scene: &Scene, name: &str) -> CertifyReply {
    let reply = board.certify(scene).unwrap_or_else(|error| panic!("{name}: {error}"));
    let found = assess(scene);
    let expected = CertifyReply {
        alpha: bits(found.alpha),
        alpha_coupled: bits(found.alpha_coupled),
        alpha_port: bits(found.alpha_port),
        paper: found.paper,
        exact: found.exact,
        is_certified: found.outcome.is_ok(),
        ..reply
    };
    assert_eq!(reply, expected, "{name}");
    reply
}

/// The same of the reference cases, of scenes whose torque lags, and of torque profiles of 64 knots; none takes
/// longer than it may.
#[test]
#[ignore = "builds for minutes"]
fn the_board_judges_as_the_host_does() {
    let mut board = Client::boot(&harness("certify_server")).unwrap();
    for case in vectors::all() {
        assert!(judged_alike(&mut board, &case.scene(), &case.name).instructions > 0);
    }
    let published = super::latency::scenes().into_iter().step_by(4);
    let lagging = published.chain(bench::lagging_scenes().into_iter().step_by(7));
    let profiles = profiles();
    let (mut most, mut certified) = (0, 0);
    for scene in lagging {
        let reply = judged_alike(&mut board, &scene, &format!("{scene:?}"));
        most = most.max(reply.verdict_instructions);
    }
    for scene in &profiles {
        let reply = judged_alike(&mut board, scene, &format!("{scene:?}"));
        most = most.max(reply.instructions);
        certified += usize::from(reply.is_certified);
    }
    board.finish().unwrap();
    println!("instructions of the longest verdict: {most}");
    assert!(certified > 5 && certified < profiles.len(), "{certified}");
    assert!(most <= MOST_TO_JUDGE, "{most}");
}

/// Torques and codes are those of the host, bit for bit, in every number format; there the scene is
/// data, on the board it is a type.
#[test]
#[ignore = "builds for minutes"]
fn every_format_computes_as_the_host_does() {
    let mut board = bench_board();
    for (number, case) in servo::cases().iter().enumerate() {
        let motion = Motion::recorded(&case.problem, counts(number as u64));
        for arithmetic in Arithmetic::ALL {
            let name = format!("{} in {}", case.name, arithmetic.name());
            let cost = cost(&mut board, &motion, arithmetic);
            let cost = cost.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(cost.most > 0, "{name}");
        }
    }
    let turns: Vec<_> = sine::turns().into_iter().map(f32::to_bits).collect();
    for sine in Sine::ALL {
        let outputs = board.compute(&BenchRequest::Sine(sine), &turns).unwrap();
        for (turn, output) in turns.iter().zip(outputs) {
            let here = f64::from(sine.of_turn(f32::from_bits(*turn)));
            assert_eq!(output.value.to_bits(), here.to_bits(), "{} {turn:x}", sine.as_str());
        }
    }
    // A type of scene that the program has not is refused, and the next question is answered.
    let problem = servo::cases()[0].problem;
    let environment = Canceller { residual: 0.01, delay: 3 }.alone();
    let other = BenchRequest::Servo {
        scene: Scene { environment, ..problem.scene },
        transducers: problem.transducers,
        arithmetic: Arithmetic::F32,
    };
    assert!(matches!(board.compute(&other, &[0]), Err(EmulatorError::NoBenchProgram)));
    assert_eq!(board.compute(&BenchRequest::Sine(Sine::Quintic), &[0]).unwrap()[0].value, 0.0);
    board.finish().unwrap();
}

/// So are those behind the matched coupling, with one lag and without; the wall's depth and its torque's limit
/// change what a tick does.
#[test]
#[ignore = "builds for minutes"]
fn behind_the_matched_coupling_a_board_computes_as_the_host_does() {
    let mut board = bench_board();
    let environment = Wall::damped(22.0, 0.01, 0).behind(0.01).alone();
    let prompt = Latency::delayed(1e-5);
    for latency in [prompt, prompt.with_actuator_lag(5e-5)] {
        let mut problem = servo::cases()[0].problem;
        let coupling = Coupling::Matched;
        problem.scene = Scene { environment, coupling, latency, ..problem.scene };
        let motion = Motion::recorded(&problem, counts(3));
        for arithmetic in [Arithmetic::F32, Arithmetic::I16F16, Arithmetic::I8F24] {
            let cost = cost(&mut board, &motion, arithmetic);
            let name = arithmetic.name();
            let cost = cost.unwrap_or_else(|error| panic!("{name}, {latency:?}: {error}"));
            println!("{name}, {latency:?}: at most {} instructions", cost.most);
        }
    }
    board.finish().unwrap();
    let [most, with_a_lag] = contact_instructions(&harness("bench_programs")).unwrap();
    println!("in contact: {most} instructions, {with_a_lag} with one lag");
    assert!(most <= 51 && with_a_lag <= 60, "{most}, {with_a_lag}");
}

/// A program that never answers is an error after a while, and not a wait for ever.
#[test]
fn a_board_that_does_nothing_is_an_error() {
    let file = tempfile::NamedTempFile::new().unwrap();
    // Stack pointer, reset vector, and a branch to itself.
    let image = [0, 0x10, 0, 0x20, 9, 0, 0, 0, 0xfe, 0xe7];
    std::fs::write(file.path(), image).unwrap();
    let mut board = Emulator::boot(file.path()).unwrap().with_timeout(Duration::from_millis(500));
    let error = board.exchange(0).unwrap_err();
    assert!(matches!(error, EmulatorError::Silent { .. }), "{error}");
}

/// However a set is judged, taken or refused, by its certificate or by its timing, the answer comes
/// and a kibibyte of stack is left.
#[test]
#[ignore = "builds for minutes"]
fn every_set_is_answered_with_stack_to_spare() {
    for name in ["delayed_spring", "damper_wall", "free_mode", "knob"] {
        let elf = program(name, NumberFormat::F32);
        // The standard coupling; softer and stiffer couplings, for which another function is judged; a
        // coupling with which the loop has no solution.
        let mut taken = 0;
        for stiffness in [44.0, 43.0, 60.0, 88.0, 1e9] {
            let set = live_set(&elf, &[(Parameter::CouplingStiffness, stiffness)])
                .unwrap_or_else(|error| panic!("{name}, {stiffness} N m/rad: {error}"));
            let left = set.stack_left.expect("the emulated board knows its stack");
            assert!(left >= 1024, "{name}, {stiffness} N m/rad: {left} bytes left");
            taken += usize::from(set.taken);
        }
        assert!((1..5).contains(&taken), "{name}: {taken} taken");
    }
}

/// An instruction takes 32 ns here, so that a phase of 10 us is 312 of them: enough for the tick in
/// floating point, but not in fixed point, which a real board has five times as many cycles for.
#[test]
#[ignore = "builds for minutes"]
fn a_tick_that_is_longer_than_its_phase_keeps_the_board_from_being_armed() {
    let mut board = Emulator::boot(&program("undelayed_wall", NumberFormat::Fixed)).unwrap();
    let error = board.arm_and_wait().unwrap_err();
    assert!(matches!(error, EmulatorError::NotArmed), "{error}");
}

/// A program that crashes is an error at once.
#[test]
fn a_board_that_crashes_is_an_error() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let mut board = Emulator::boot(file.path()).unwrap();
    let error = board.exchange(0).unwrap_err();
    assert!(matches!(error, EmulatorError::Ended { .. }), "{error}");
    let missing = Emulator::boot(Path::new("no/such/program"));
    assert!(matches!(missing, Err(EmulatorError::Program { .. })));
}

/// With the most instructions that its servo's interrupt may take, where that is promised.
macro_rules! emulated {
    ($scene:ident, $format:expr, $number:ty, $most:expr) => {{
        let (certified, name) = (&$scene::CERTIFIED, stringify!($scene));
        let report = run::<_, $number>(name, $format, certified, &$scene::TRANSDUCERS);
        check(&report, &certified.certified_in(<$number>::FORMAT));
        let interrupt = report.interrupt_instructions;
        assert!(interrupt.max <= $most, "{interrupt:?}");
    }};
}

/// The demo has built these two.
#[test]
fn two_scenes_give_the_host_s_codes() {
    emulated!(damper_wall, NumberFormat::F32, f32, 150);
    emulated!(knob, NumberFormat::F32, f32, 160);
}

/// The spring, the wall without delay and the knob are compared as they are flashed, on virtual boards.
#[test]
#[ignore = "builds for minutes"]
fn free_mode_and_fixed_point_give_the_host_s_codes() {
    emulated!(free_mode, NumberFormat::F32, f32, u64::MAX);
    emulated!(damper_wall, NumberFormat::Fixed, damper_wall::Fixed, u64::MAX);
    emulated!(delayed_spring, NumberFormat::Fixed, delayed_spring::Fixed, u64::MAX);
    emulated!(free_mode, NumberFormat::Fixed, free_mode::Fixed, u64::MAX);
    emulated!(knob, NumberFormat::Fixed, knob::Fixed, u64::MAX);
}
