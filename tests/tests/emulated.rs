//! The scenes' programs on the emulated board, against the same servo on the host.
//!
//! Fails if a single DAC code differs, if a certificate differs by a bit between compiler, host
//! and board, or if the board drops a frame or misses a tick.

use std::sync::LazyLock;

use analysis::emulator::{Emulator, Report};
use analysis::toolchain::{NumberFormat, Toolchain, prepare};
use firmware::certificate::Certified;
use firmware::encoder::RawCount;
use firmware::environment::Renderable;
use firmware::number::Number;
use firmware::scene::Scene;
use firmware::servo::{Servo, Transducers};
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

// The programs' own files: their scenes have no second copy.
#[path = "../../firmware/src/bin/damper_wall.rs"]
mod damper_wall;
#[path = "../../firmware/src/bin/delayed_spring.rs"]
mod delayed_spring;
#[path = "../../firmware/src/bin/free_mode.rs"]
mod free_mode;

/// Ticks of each run.
const TICKS: usize = 5_000;

static TOOLCHAIN: LazyLock<Toolchain> =
    LazyLock::new(|| prepare(|step| eprintln!("{step}")).unwrap_or_else(|error| panic!("{error}")));

/// Counts of a hand that wanders, jumps, stands still, turns through the counter's wrap, and flings
/// the device so far that the torque is limited.
fn counts(seed: u64) -> Vec<i32> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut count = 0_i32;
    let mut speed = 0;
    (0..TICKS)
        .map(|tick| {
            if tick % 100 == 0 {
                speed = random.random_range(-40..=40);
            }
            count += match random.random_range(0..50) {
                0 => random.random_range(-77..=77),
                1 => random.random_range(-20_000..=20_000),
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
) -> Report
where
    E: Renderable<N>,
    N: Number,
{
    let elf = TOOLCHAIN.build_scene(name, format).unwrap_or_else(|error| panic!("{error}"));
    let mut servo = Servo::<E, N>::new(certified, transducers).unwrap();
    let mut board = Emulator::boot(&elf).unwrap();
    for (tick, count) in counts(1).into_iter().enumerate() {
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

/// What holds for every run.
fn check<E>(report: &Report, certified: &Certified<Scene<E>>) {
    assert_eq!((report.ticks, report.dropped, report.overruns), (TICKS as u64, 0, 0));
    assert_eq!(report.calibration.per_instruction, 32, "the emulator counts 32 ns an instruction");
    assert_eq!(report.compute_instructions.count, TICKS as u64);
    assert!(report.interrupt_instructions.min > report.compute_instructions.min);
    let assessment = certified.assessment();
    let bits = |index: Option<firmware::passivity::interval::Interval>| {
        index.map(|index| (index.lo().to_bits(), index.hi().to_bits()))
    };
    for found in [report.board, report.compiler] {
        assert_eq!(found.alpha, bits(assessment.alpha));
        assert_eq!(found.alpha_coupled, bits(assessment.alpha_coupled));
    }
    assert!(report.board.alpha.is_some());
}

macro_rules! emulated {
    ($($test:ident: $scene:ident, $format:expr, $number:ty;)*) => {$(
        #[test]
        fn $test() {
            let report = run::<_, $number>(
                stringify!($scene),
                $format,
                &$scene::CERTIFIED,
                &$scene::TRANSDUCERS,
            );
            check(&report, &$scene::CERTIFIED);
        }
    )*};
}

emulated! {
    delayed_spring_in_f32: delayed_spring, NumberFormat::F32, f32;
    delayed_spring_in_fixed_point: delayed_spring, NumberFormat::Fixed, delayed_spring::Fixed;
    damper_wall_in_f32: damper_wall, NumberFormat::F32, f32;
    damper_wall_in_fixed_point: damper_wall, NumberFormat::Fixed, damper_wall::Fixed;
    free_mode_in_f32: free_mode, NumberFormat::F32, f32;
    free_mode_in_fixed_point: free_mode, NumberFormat::Fixed, free_mode::Fixed;
}
