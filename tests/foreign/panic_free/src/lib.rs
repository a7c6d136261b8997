//! One tick of each kind of law and number, none of which may contain a path that panics.

use std::hint::black_box;

use fixed::types::{I8F24, I16F16};
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::coupling::Response;
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::energy::EnergyMonitor;
use haptic_servo::environment::{
    Canceller, Coefficients, Discretize, Environment, Law, Parts, Rational, RationalLaw, Wall,
};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::scene_type::Typed;
use haptic_servo::servo::{Latched, Output, PreparedServo, RenderingOptions, Servo, Transducers};
use haptic_servo::servo_loop::{Frame, FrameQueue, FrameSink, Frames, State};
use no_panic::no_panic;

const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 1.0,
    largest_speed: 100.0,
};

const fn scene(environment: Environment) -> Scene {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 0.001, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment,
        latency: Latency::NONE,
        torque_limit: None,
    }
}

const DETENT: Certified<Scene> =
    scene(Wall::damped(11.0, 0.005, 1).behind(0.0).alone()).certified();
haptic_servo::scene_type!(Detent: DETENT);
type Walled = PreparedServo<Typed<Detent>, f32, Latched>;

/// What a cycle does in a usual tick: rendering, with or without injected damping, energy, frame.
#[no_panic]
#[inline(never)]
fn cycle(
    rendering: &mut Walled,
    energy: &mut EnergyMonitor,
    frames: &mut Frames<'_, 4>,
    raw: RawCount,
) {
    let Output { code, limit } = rendering.tick(raw, energy);
    energy.observe::<Latched>(raw.bits().cast_signed(), code);
    frames.push(Frame { tick: 1, count: 2, code, limit, state: State::Running, slack: 3 });
}

fn rendering(injection: Option<f64>) -> Walled {
    let timed: TimingChecked<_, Latched> = Typed::<Detent>::certified().timing_checked();
    let options = RenderingOptions { injection, ..RenderingOptions::DEFAULT };
    PreparedServo::new(&timed, &TRANSDUCERS, &options).expect("it fits the format")
}

/// No program renders one, so it has no servo here.
#[no_panic]
#[inline(never)]
fn rational(law: &mut RationalLaw<f32>, x: f32) -> Response<f32> {
    law.update(x);
    law.evaluate(x)
}

fn rational_law() -> RationalLaw<f32> {
    let rational = Rational {
        numerator: Coefficients::new(&[8.0, -2.0]).expect("few enough"),
        denominator: Coefficients::new(&[1.0, -0.5]).expect("few enough"),
        delay: 1,
        unit_zeros: 0,
    };
    rational.law(&DETENT.scene().context()).expect("it fits the format")
}

macro_rules! ticks {
    ($($name:ident: $number:ty = $environment:expr;)*) => {
        $(
            mod $name {
                use super::*;

                const CERTIFIED: Certified<Scene> = scene($environment).certified();
                haptic_servo::scene_type!(pub Of: CERTIFIED);

                #[no_panic]
                #[inline(never)]
                pub fn $name(servo: &mut Servo<Typed<Of>, $number>, raw: RawCount) -> Output {
                    servo.tick(raw)
                }
            }
        )*

        fn main() {
            $(
                let certified = Typed::<$name::Of>::certified();
                let mut servo = Servo::new(&certified, &TRANSDUCERS).expect("it fits the format");
                black_box($name::$name(black_box(&mut servo), black_box(RawCount::from(7_u16))));
            )*
            black_box(rational(black_box(&mut rational_law()), black_box(0.1)));
            let mut queue = FrameQueue::new();
            let (mut frames, _reader) = queue.split();
            let mut energy = EnergyMonitor::default();
            for injection in [None, Some(0.005)] {
                let mut rendering = rendering(black_box(injection));
                let raw = black_box(RawCount::from(7_u16));
                cycle(black_box(&mut rendering), &mut energy, &mut frames, raw);
            }
        }
    };
}

ticks! {
    spring: f32 = Wall::spring(22.0, 1).alone();
    spring_fixed: I8F24 = Wall::spring(22.0, 1).alone();
    undelayed: f32 = Wall::damped(22.0, 0.01, 0).behind(0.0).alone();
    wall: f32 = Wall::damped(22.0, 0.01, 1).behind(0.0).alone();
    wall_fixed: I8F24 = Wall::damped(22.0, 0.01, 1).behind(0.0).alone();
    canceller: f32 = Canceller::to(0.001).alone();
    canceller_fixed: I16F16 = Canceller::to(0.001).alone();
    behind: f32 = Parts {
        canceller: Some(Canceller::to(0.02)),
        wall: Some(Wall::damped(4.0, 0.002, 2).filtered(0.5).behind(0.1)),
        ..Parts::NONE
    }
    .sum();
}
