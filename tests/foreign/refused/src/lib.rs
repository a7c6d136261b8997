//! The same knob with too much damping in the detent.
#![no_std]

use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// A detent that is computed one sample late.
pub const DETENT: Certified<Scene> = Scene {
    device: Device { inertia: 1e-5, damping: 0.01, passivity: None },
    timing: Timing { period: 0.0005, worst_period: None },
    coupling: Coupling::Spring { stiffness: 40.0 },
    environment: Wall::damped(12.0, 0.008, 1).alone(),
    latency: Latency::NONE,
    torque_limit: None,
}
.certified();
