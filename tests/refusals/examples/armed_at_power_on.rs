//! The same with a reason.
use firmware::certificate::Certified;
use firmware::cycle::Options;
use firmware::encoder::CounterWidth;
use firmware::environment::*;
use firmware::scene::{Coupling, Device, Scene, Timing};
use firmware::servo::Transducers;

const SCENE: Scene<DelayedSpring<1>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: DelayedSpring { stiffness: 11.0 },
    torque_limit: Some(1.0),
};
const CERTIFIED: Certified<Scene<DelayedSpring<1>>> = SCENE.certified();
const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    largest_speed: 100.0,
};

firmware::scene_program! {
    scene: SCENE: DelayedSpring<1>,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: f32,
    options: Options::DEFAULT.armed_at_power_on("a demonstration behind glass"),
}
