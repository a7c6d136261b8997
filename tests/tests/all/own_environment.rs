//! A type of environment that is not in the firmware, on the emulated board: the codes of the host, bit for
//! bit, and live parameters that its own statement judges.

use analysis::emulator::Emulator;
use analysis::studies::bench::on_target::live_set;
use analysis::toolchain::NumberFormat;
use fixed::types::I8F24;
use haptic_servo::certificate::{Certified, Parameter};
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::number::Number;
use haptic_servo::scene::{Coupling, Device, Scene};
use haptic_servo::servo::{Servo, Transducers};
use own_environment::ProgressiveSpring;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::toolchain::TOOLCHAIN;

/// That of the program `pedal`: a difference would show in the certificate and in the codes.
const PEDAL: Scene<ProgressiveSpring<1>> = Scene {
    coupling: Coupling::Spring { stiffness: 44.0 },
    torque_limit: Some(1.0),
    ..Scene::of(
        Device::damped(2.2e-5, 0.022),
        0.001,
        ProgressiveSpring { soft: 4.0, stiff: 24.0, knee: 0.1 },
    )
};

const CERTIFIED: Certified<Scene<ProgressiveSpring<1>>> =
    PEDAL.certified_as(PEDAL.environment.stated_at(PEDAL.timing.period));

const TRANSDUCERS: Transducers =
    Transducers { counter: CounterWidth::Bits16, ..Transducers::of(61_440.0, 2.0) };

/// A hand that goes far enough for the torque to be limited.
fn counts() -> impl Iterator<Item = i32> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (mut count, mut speed) = (0_i32, 0);
    (0..3000).map(move |tick| {
        if tick % 50 == 0 {
            speed = random.random_range(-60..=60) - count.signum() * 20;
        }
        count += speed + random.random_range(-1..=1);
        count
    })
}

fn plays<N: Number>(format: NumberFormat)
where
    ProgressiveSpring<1>: haptic_servo::environment::Discretize<N>,
{
    let elf = TOOLCHAIN.build_own_environment(format).unwrap_or_else(|error| panic!("{error}"));
    let mut servo = Servo::<_, N>::new(&CERTIFIED, &TRANSDUCERS).unwrap();
    let mut board = Emulator::boot(&elf).unwrap();
    board.arm_and_wait().unwrap();
    let mut least = u16::MAX;
    for (tick, count) in counts().enumerate() {
        let code = board.exchange(count).unwrap_or_else(|error| panic!("tick {tick}: {error}"));
        let expected = servo.tick(RawCount::from(count)).code.get();
        assert_eq!(code, expected, "{format}, tick {tick}, count {count}");
        least = least.min(code);
    }
    // 1 N m of 2 N m, which the stiff part reaches.
    assert_eq!(least, DacCode::MID_SCALE.get() - DacCode::CODES_TO_FULL_SCALE.div_ceil(2));
    let report = board.finish().unwrap();
    assert_eq!((report.dropped, report.overruns), (0, 0));
    // A board reports what it judges itself, which it does by what the environment states there.
    assert_eq!(report.board.alpha, report.compiler.alpha);
    let answers = |stiffness| live_set(&elf, &[(Parameter::Stiffness, stiffness)]).unwrap().taken;
    assert!(answers(30.0) && !answers(50.0));
}

#[test]
#[ignore = "builds for a minute"]
fn an_environment_of_another_crate_plays_in_f32() {
    plays::<f32>(NumberFormat::F32);
}

#[test]
#[ignore = "builds for a minute"]
fn an_environment_of_another_crate_plays_in_fixed_point() {
    plays::<I8F24>(NumberFormat::Fixed);
}
