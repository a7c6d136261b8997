//! Torques of a motor that its command does not state: Coulomb friction and cogging.

use std::f64::consts::TAU;

use haptic_servo::environment::{Anticogging, CoggingError};

/// Cogging: the torque of the magnets on the rotor, which no current makes. It takes no energy in a turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cogging {
    /// Its harmonics over a turn.
    pub harmonics: &'static [Sine],
}

/// The torque `-A sin(N x + p)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    /// Amplitude `A` in N m.
    pub torque: f64,
    /// Periods `N` in a turn, mostly the least common multiple of slots and poles.
    pub count: f64,
    /// Phase `p` in rad.
    pub phase: f64,
}

impl Cogging {
    /// Largest [rate](Self::rate) in rad/s that a simulation follows: thirty times that of a small, strong motor,
    /// 0.1 N m at 84 periods a turn and 1e-6 kg m^2.
    pub const LARGEST_RATE: f64 = 1e5;

    /// Harmonics for the rest of the program: a scene refers to them, as to the table of a torque profile.
    pub fn of(harmonics: Vec<Sine>) -> Self {
        Self { harmonics: harmonics.leak() }
    }

    /// Torque in N m at an angle in rad.
    pub fn at(&self, angle: f64) -> f64 {
        self.harmonics.iter().map(|it| -it.torque * (it.count * angle + it.phase).sin()).sum()
    }

    /// Energy in J that it takes up on the way from rest at 0 to an angle in rad.
    pub fn energy(&self, angle: f64) -> f64 {
        let of = |it: &Sine| {
            let cosine = (it.count * angle + it.phase).cos();
            it.torque / it.count * (it.phase.cos() - cosine)
        };
        self.harmonics.iter().map(of).sum()
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.harmonics.iter().all(|it| it.torque == 0.0)
    }

    /// Bound in N m on its torque.
    pub fn torque(&self) -> f64 {
        self.harmonics.iter().map(|it| it.torque).sum()
    }

    /// Periods in a turn of its highest harmonic, at least 1.
    pub fn highest(&self) -> f64 {
        self.harmonics.iter().fold(1.0, |most, it| most.max(it.count))
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

    /// Bound on its steepest slope in N m/rad.
    pub fn slope(&self) -> f64 {
        self.harmonics.iter().map(|it| it.torque * it.count).sum()
    }

    /// Bound in rad/s on the rate at which an inertia in kg m^2 swings about a stable position of it.
    pub fn rate(&self, inertia: f64) -> f64 {
        (self.slope() / inertia).sqrt()
    }

    /// Angle in rad of a period of its highest harmonic: from one stable position of a sine to the next.
    pub fn pitch(&self) -> f64 {
        TAU / self.highest()
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
        self.friction == 0.0 && self.cogging.is_none()
    }
}

/// Cogging of one sine, for tests.
#[cfg(test)]
pub fn sine(torque: f64, count: f64) -> Cogging {
    Cogging::of(vec![Sine { torque, count, phase: 0.0 }])
}
