//! Torques of a motor that its command does not state: Coulomb friction and cogging.

use std::f64::consts::TAU;

use haptic_servo::environment::{Anticogging, CoggingError};

use crate::nonlinear_encoder::shown;

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

    /// The largest torque in N m of it together with what opposes it, which reads its map through an encoder of this
    /// [linearity](shown). It is the largest of samples, 16 or more between two angles of the map and in a period of
    /// the highest harmonic: enough for a torque to be told apart, and no bound.
    pub fn remaining(&self, learnt: &Anticogging, linearity: f64) -> f64 {
        let map: Vec<f64> = learnt.torques().collect();
        let samples = 16 * map.len().max(self.highest() as usize);
        let opposed = |angle: f64| {
            let place = (angle / TAU).rem_euclid(1.0) * map.len() as f64;
            let [from, to] = [0, 1].map(|next| map[(place as usize + next) % map.len()]);
            learnt.share * (from + (to - from) * place.fract())
        };
        let remains = |i: usize| {
            let angle = TAU * i as f64 / samples as f64;
            self.at(angle) - opposed(shown(angle, linearity))
        };
        (0..samples).map(|i| remains(i).abs()).fold(0.0, f64::max)
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A map against what it was learnt of leaves the sagitta of its chords, half of a period off it doubles
    /// the cogging, and of a share the rest remains.
    #[test]
    fn a_map_leaves_little_of_its_own_cogging_and_doubles_the_opposite() {
        let [cogging, opposite] =
            [0.0, PI].map(|phase| Cogging::of(vec![Sine { torque: 0.005, count: 84.0, phase }]));
        let learnt = cogging.learnt(2048).unwrap();
        let chord = 0.005 * (1.0 - (84.0 * PI / 2048.0).cos());
        let remains = cogging.remaining(&learnt, 0.0);
        assert!((0.9 * chord..chord + 5e-7).contains(&remains), "{remains} {chord}");
        let near = |remains: f64, expected: f64| {
            assert!((remains / expected - 1.0).abs() < 1e-3, "{remains} {expected}");
        };
        near(opposite.remaining(&learnt, 0.0), 0.01);
        near(opposite.remaining(&learnt.sharing(0.4), 0.0), 0.007);
        near(Cogging::default().remaining(&learnt, 0.0), 0.005);
        assert!((cogging.remaining(&learnt.sharing(0.4), 0.0) - 0.003).abs() < 0.5 * chord);
    }

    /// The map is over the angle that the encoder shows.
    #[test]
    fn a_map_is_read_through_the_encoder() {
        const LINEARITY: f64 = 0.04;
        let cogging = sine(0.005, 84.0);
        let angle_of = |shown_angle: f64| {
            (0..40).fold(shown_angle, |angle, _| shown_angle - LINEARITY * angle.sin())
        };
        let torques = (0..2048).map(|i| cogging.at(angle_of(TAU * f64::from(i) / 2048.0)));
        let units = vec![0; 2048].leak();
        let learnt = Anticogging::learnt(&torques.collect::<Vec<_>>(), units).unwrap();
        assert!(cogging.remaining(&learnt, LINEARITY) < 1e-4);
        assert!(cogging.remaining(&learnt, 0.0) > 0.009);
    }
}
