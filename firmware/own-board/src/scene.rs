//! The scene and its device: a wall of spring and damper at 1 kHz.

use haptic_servo::boot::Program;
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::{DamperWall, OneSided};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{Latched, RenderingOptions, Transducers};
use haptic_servo::servo_loop::Options;

/// The environment that the hand feels.
pub type Environment = OneSided<DamperWall<1>>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: OneSided { face: 0.0, wall: DamperWall { stiffness: 22.0, damping: 0.01 } },
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

/// Its certificate, with coefficients rounded to `f32`: a scene that could oscillate in a hand is a compile
/// error here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified().certified_in(Format::F32);

/// The scene's delay must be that of a DAC latched by a timer; otherwise this does not compile.
pub const TIMED: TimingChecked<Scene<Environment>, Latched> = CERTIFIED.timing_checked::<Latched>();

/// The board's program. Numbers that no board can run do not compile.
pub const PROGRAM: Program<Environment> = Program {
    scene: *TIMED.scene(),
    transducers: Transducers {
        counts_per_turn: 61_440.0,
        counter: CounterWidth::Bits16,
        full_scale_torque: 2.0,
        largest_speed: 100.0,
    },
    rendering: RenderingOptions::DEFAULT,
    options: Options::DEFAULT,
}
.checked();
