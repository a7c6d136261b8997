//! The paper's device and coupling, for tests.

use crate::encoder::CounterWidth;
use crate::scene::{Coupling, Device, Latency, Scene, Timing};
use crate::transducers::Transducers;

/// The scene of an environment at 1 kHz.
pub const fn scene<E>(environment: E, torque_limit: Option<f64>) -> Scene<E> {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 1e-3, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment,
        latency: Latency::NONE,
        torque_limit,
    }
}

/// Its encoder and its motor.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    largest_speed: 100.0,
};
