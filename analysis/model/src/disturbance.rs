//! Torques of a motor that its command does not state: Coulomb friction and cogging.

use std::f64::consts::TAU;

use haptic_servo::environment::{Anticogging, CoggingError};

/// Cogging: the torque `-A sin(N x)` of the magnets on the rotor, which no current makes. It takes no energy in
/// a turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cogging {
    /// Amplitude `A` in N m.
    pub torque: f64,
    /// Periods `N` in a turn, mostly the least common multiple of slots and poles.
    pub count: f64,
}

impl Cogging {
    /// Torque in N m at an angle in rad.
    pub fn at(&self, angle: f64) -> f64 {
        -self.torque * (self.count * angle).sin()
    }

    /// Energy in J that it takes up on the way from rest at 0 to an angle in rad.
    pub fn energy(&self, angle: f64) -> f64 {
        if self.torque == 0.0 {
            return 0.0;
        }
        self.torque / self.count * (1.0 - (self.count * angle).cos())
    }

    /// All of it opposed, from a map of so many angles.
    ///
    /// # Errors
    /// If there is no such map.
    pub fn learnt(&self, angles: usize) -> Result<Anticogging, CoggingError> {
        let torques = (0..angles).map(|i| self.at(TAU * i as f64 / angles as f64));
        let units = Box::leak(vec![0; angles].into_boxed_slice());
        Anticogging::learnt(&torques.collect::<Vec<_>>(), units)
    }

    /// Steepest slope in N m/rad.
    pub fn slope(&self) -> f64 {
        self.torque * self.count
    }

    /// Angle in rad from one stable position to the next.
    pub fn pitch(&self) -> f64 {
        TAU / self.count
    }
}

/// Friction and cogging of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disturbance {
    /// Coulomb friction in N m.
    pub friction: f64,
    /// Cogging.
    pub cogging: Cogging,
}

impl Disturbance {
    /// Whether there is neither friction nor cogging.
    pub fn is_none(&self) -> bool {
        self.friction == 0.0 && self.cogging.torque == 0.0
    }
}
