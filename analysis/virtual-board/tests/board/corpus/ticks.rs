//! Ticks of the scenes that have a program, in every number format.

use analysis::emulator::BenchClient;
use analysis::studies::number_format::{FormatProblem, Motion, Units};
use analysis::studies::tradeoff::servo;
use firmware_harness::bench_request::BenchRequest;
use haptic_servo::number::Arithmetic;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{TOOLCHAIN, VirtualGuest, counts};

/// Ticks of each scene in each format and unit.
const TICKS: usize = 448;
/// Units of angle and torque as powers of two: as they are; numbers so large that fixed point is
/// full; and so small that it is almost empty.
const UNITS: [(i32, i32); 4] = [(0, 0), (-4, -3), (12, 2), (24, 24)];

/// A problem in other units.
fn scaled(problem: FormatProblem, (angle, torque): (i32, i32)) -> FormatProblem {
    let units = Units { angle: 2_f64.powi(angle), torque: 2_f64.powi(torque) };
    FormatProblem {
        scene: units.scene(&problem.scene),
        transducers: units.transducers(&problem.transducers),
        ..problem
    }
}

/// Has the host and both boards follow a motion; gives the ticks with the largest torque of all,
/// which are many where it is a limit. None where the format does not hold the scene in its unit.
fn compare(
    boards: &mut [BenchClient; 2],
    motion: &Motion,
    arithmetic: Arithmetic,
) -> Option<usize> {
    let here = motion.torques(arithmetic).ok()?;
    let (scene, transducers) = motion.problem().scaled(arithmetic);
    let unit = motion.problem().units(arithmetic).torque;
    let trial = BenchRequest::Servo { scene, transducers, arithmetic };
    let inputs: Vec<_> = motion.counts().iter().map(|count| count.cast_unsigned()).collect();
    let there = boards.each_mut().map(|board| board.compute(&trial, &inputs).unwrap());
    assert!(there[0] == there[1], "the boards' instructions differ: {trial:?}");
    for (outputs, board) in there.iter().zip(["the virtual board", "QEMU"]) {
        for (tick, (output, (torque, code))) in outputs.iter().zip(&here).enumerate() {
            let value = output.value * unit;
            let equal = (value.to_bits(), output.code) == (torque.to_bits(), *code);
            assert!(equal, "tick {tick} on {board}: {output:?}, not {torque:e}; {trial:?}");
        }
    }
    let torques = here.iter().map(|(torque, _)| torque.abs());
    let largest = torques.clone().fold(0.0, f64::max);
    Some(torques.filter(|torque| *torque == largest).count())
}

#[test]
fn ticks_are_equal() {
    let elf = TOOLCHAIN.build_harness("bench_programs").unwrap_or_else(|error| panic!("{error}"));
    let mut boards =
        [BenchClient::with_transport(VirtualGuest::boot(&elf)), BenchClient::boot(&elf).unwrap()];
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut limited = Vec::new();
    for case in servo::cases() {
        for units in UNITS {
            let motion = Motion::recorded(&scaled(case.problem, units), counts(&mut rng, TICKS));
            let formats = Arithmetic::ALL.into_iter();
            limited.extend(formats.filter_map(|format| compare(&mut boards, &motion, format)));
        }
    }
    boards.into_iter().for_each(|board| board.finish().unwrap());
    let servos = limited.len();
    let limited = limited.into_iter().filter(|ticks| *ticks > TICKS / 10).count();
    println!("{servos} servos, {limited} of them often at their limit");
    assert!(servos > 100 && limited > 50, "{servos} servos, {limited} often at their limit");
}
