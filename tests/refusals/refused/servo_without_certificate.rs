//! A servo from a scene that nobody certified: there is no such constructor.
use firmware::encoder::CounterWidth;
use firmware::environment::DelayedSpring;
use firmware::scene::{Coupling, Device, Scene, Timing};
use firmware::servo::{Servo, Transducers};

const SCENE: Scene<DelayedSpring<1>> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: DelayedSpring { stiffness: 22.0 },
    torque_limit: None,
};
const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 4096.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    largest_speed: 100.0,
};

fn main() {
    let _ = Servo::<DelayedSpring<1>, f32>::new(&SCENE, &TRANSDUCERS);
}
