//! The scene and its device: a wall of spring and damper at 1 kHz.

use haptic_servo::boot::Program;
use haptic_servo::certificate::{Certified, TimingChecked};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::Wall;
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::scene_type::Typed;
use haptic_servo::servo::{Latched, RenderingOptions, Transducers};
use haptic_servo::servo_loop::Options;

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Wall::damped(22.0, 0.01, 1).behind(0.0).alone(),
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

/// Its certificate, with coefficients rounded to `f32`: a scene that could oscillate in a hand is a compile
/// error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified().certified_in(Format::F32);

haptic_servo::scene_type! {
    /// The structure of the scene.
    pub ThisScene: CERTIFIED
}

/// The environment that the servo renders: the parts of the scene and no others.
pub type Rendered = Typed<ThisScene>;

/// The scene's delay must be that of a DAC latched by a timer; otherwise this does not compile.
pub const TIMED: TimingChecked<Scene<Rendered>, Latched> =
    Rendered::certified().timing_checked::<Latched>();

/// The board's program. Numbers that no board can run do not compile.
pub const PROGRAM: Program<Rendered> = Program {
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
