//! The surroundings of the servo in a simulation: a hand, an encoder, and the motion between them.

use serde::{Deserialize, Serialize};

/// A passive hand that holds the device; all three numbers are 0 or more, and with all at 0 there is no hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hand {
    /// Inertia `m_h` in kg m^2 that moves with the device.
    pub inertia: f64,
    /// Damping `b_h` in N m s/rad towards the hand's set-point.
    pub damping: f64,
    /// Stiffness `k_h` in N m/rad towards the same point.
    pub stiffness: f64,
}

/// How the device moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Angle in rad.
    pub position: f64,
    /// Angular velocity in rad/s.
    pub velocity: f64,
}

/// Set-point of the hand over one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandSetpoint {
    /// Angle in rad at the start of the tick.
    pub from: f64,
    /// Angle in rad at its end.
    pub to: f64,
}

/// Energy in J that passed between hand and device.
///
/// In every tick the work of the hand's torque on the device is computed exactly from the energy
/// balance of the bare device, `W = d(m x'^2 / 2) + b int x'^2 dt - u dx`. Work that is positive
/// over a tick counts as given, work that is negative as got back, so a hand that pushes a spring
/// in and eases out again gives and gets back about the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Energy {
    /// Energy that the hand gave to the device.
    pub given: f64,
    /// Energy that the device returned to the hand.
    pub got_back: f64,
}

impl Energy {
    /// Adds one tick's work of the hand on the device, in J.
    pub fn add(&mut self, work: f64) {
        if work > 0.0 {
            self.given += work;
        } else {
            self.got_back -= work;
        }
    }
}

/// An incremental encoder: converts an angle to the whole counts below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedEncoder {
    counts_per_radian: f64,
}

impl SimulatedEncoder {
    /// An encoder with `counts_per_turn` counts a turn.
    pub fn new(counts_per_turn: f64) -> Self {
        Self { counts_per_radian: counts_per_turn / std::f64::consts::TAU }
    }

    /// The 32-bit counter at an angle in rad; it wraps.
    pub fn read(&self, position: f64) -> i32 {
        (position * self.counts_per_radian).floor() as i64 as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoder_floors_and_wraps() {
        let encoder = SimulatedEncoder::new(std::f64::consts::TAU * 10.0);
        assert_eq!(encoder.read(0.19), 1);
        assert_eq!(encoder.read(-0.01), -1);
        assert_eq!(encoder.read(214_748_364.85), i32::MIN);
    }
}
