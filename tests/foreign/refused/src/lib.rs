//! The same knob with too much damping in the detent.
#![no_std]

use haptic_servo::certificate::Certified;
use haptic_servo::environment::DamperWall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// A detent that is computed one sample late.
pub const DETENT: Certified<Scene<DamperWall<1>>> = Scene {
    device: Device { inertia: 1e-5, damping: 0.01, passivity: None },
    timing: Timing { period: 0.0005, worst_period: None },
    coupling: Coupling::Spring { stiffness: 40.0 },
    environment: DamperWall { stiffness: 12.0, damping: 0.008 },
    latency: Latency::NONE,
    torque_limit: None,
}
.certified();

