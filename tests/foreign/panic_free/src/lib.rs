//! One tick of each kind of law and number, none of which may contain a path that panics.

use std::hint::black_box;

use haptic_servo::certificate::TimingChecked;
use haptic_servo::servo_loop::{Frame, FrameQueue, FrameSink, Frames, State};
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::environment::{
    Coefficients, DamperWall, DelayedSpring, FilteredWall, FreeMode, FreeModeWall, OneSided,
    Rational,
};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::energy::EnergyMonitor;
use haptic_servo::servo::{Latched, Output, PreparedServo, RenderingOptions, Servo, Transducers};
use fixed::types::{I8F24, I16F16};
use no_panic::no_panic;

const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 1.0,
    largest_speed: 100.0,
};

fn scene<E>(environment: E) -> Scene<E> {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 0.001, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment,
        latency: Latency::NONE,
        torque_limit: None,
    }
}

type Wall = OneSided<DamperWall<1>>;
type Walled = PreparedServo<Wall, f32, Latched>;

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
    let wall = DamperWall { stiffness: 11.0, damping: 0.005 };
    let certified = scene(OneSided { face: 0.0, wall }).certify().expect("a safe scene");
    let timed: TimingChecked<_, Latched> = certified.timing_checked();
    let options = RenderingOptions { injection, ..RenderingOptions::DEFAULT };
    PreparedServo::new(&timed, &TRANSDUCERS, &options).expect("it fits the format")
}

macro_rules! ticks {
    ($($name:ident: $environment:ty, $number:ty = $value:expr;)*) => {
        $(
            #[no_panic]
            #[inline(never)]
            fn $name(servo: &mut Servo<$environment, $number>, raw: RawCount) -> Output {
                servo.tick(raw)
            }
        )*

        fn main() {
            $(
                let certified = scene::<$environment>($value).certify().expect("a safe scene");
                let mut servo = Servo::new(&certified, &TRANSDUCERS).expect("it fits the format");
                black_box($name(black_box(&mut servo), black_box(RawCount::from(7_u16))));
            )*
            let mut queue = FrameQueue::new();
            let (mut frames, _reader) = queue.split();
            let mut energy = EnergyMonitor::default();
            for injection in [None, Some(0.005)] {
                let mut rendering = rendering(black_box(injection));
                let raw = black_box(RawCount::from(7_u16));
                cycle(black_box(&mut rendering), &mut energy, &mut frames, raw);
            }
            #[cfg(feature = "control")]
            black_box(control(black_box(&[1, 2]), black_box(1)));
        }
    };
}

ticks! {
    spring: DelayedSpring<1>, f32 = DelayedSpring { stiffness: 22.0 };
    spring_fixed: DelayedSpring<1>, I8F24 = DelayedSpring { stiffness: 22.0 };
    undelayed: OneSided<DamperWall<0>>, f32 =
        OneSided { face: 0.0, wall: DamperWall { stiffness: 22.0, damping: 0.01 } };
    wall: OneSided<DamperWall<1>>, f32 =
        OneSided { face: 0.0, wall: DamperWall { stiffness: 22.0, damping: 0.01 } };
    wall_fixed: OneSided<DamperWall<1>>, I8F24 =
        OneSided { face: 0.0, wall: DamperWall { stiffness: 22.0, damping: 0.01 } };
    canceller: FreeMode<0>, f32 = FreeMode { residual: 0.001 };
    canceller_fixed: FreeMode<0>, I16F16 = FreeMode { residual: 0.001 };
    behind: FreeModeWall<OneSided<FilteredWall<2>>>, f32 = FreeModeWall {
        residual: 0.02,
        wall: OneSided {
            face: 0.1,
            wall: FilteredWall { stiffness: 4.0, damping: 0.002, filter: 0.5 },
        },
    };
    rational: Rational, f32 = Rational {
        numerator: Coefficients::new(&[8.0, -2.0]).expect("few enough"),
        denominator: Coefficients::new(&[1.0, -0.5]).expect("few enough"),
        delay: 1,
        unit_zeros: 0,
    };
}

#[cfg(feature = "control")]
#[no_panic]
#[inline(never)]
fn control(values: &[u8], index: usize) -> u8 {
    values[index]
}
