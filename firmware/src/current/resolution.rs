//! The deviation of the current from its model by the resolution of converter and timer.

use super::motor::Winding;
use super::plant::Plant;

/// The resolution of the torque of a current loop in N m (theory, section 15.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentResolution {
    /// Torque of a count of the current.
    pub step: f64,
    /// Largest deviation of the settled torque from the model's, because counts, compare values and offsets
    /// are whole numbers.
    pub deviation: f64,
    /// Largest additional deviation after the current has changed its sign, from an instant in which the
    /// compensation of the dead time has the wrong sign.
    pub zero_crossing: f64,
    /// Largest ripple of the modulation, from peak to peak, at the highest supply. At the instants of the
    /// samples the ripple is zero.
    pub ripple: f64,
}

/// The quantities that determine the resolution, in SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quanta {
    pub plant: Plant,
    pub resistance: f64,
    pub inductance: f64,
    pub torque_constant: f64,
    pub amps_per_count: f64,
    /// The highest supply in V.
    pub supply: f64,
    /// Reload value of the timer.
    pub counts: u16,
    /// Period of the modulation, and dead time, in s.
    pub instant: f64,
    pub dead_time: f64,
}

impl Quanta {
    /// The resolution of a motor with this winding.
    pub(super) const fn resolution(&self, winding: Winding) -> CurrentResolution {
        // The factors from the errors of two phases to the current, from the errors of compare values and
        // dead times to the voltage, and from the supply to the ripple in the middle of the range.
        let (current, voltage, dead, swing) = match winding {
            // Half the difference of two counts; the compare values differ by the rounded number.
            Winding::Brushed => (1.0, 0.5, 2.0, 1.0 / 8.0),
            // The vector of `i_u` and `(i_u + 2 i_v)/sqrt 3` is at most twice a phase's error; the vector of
            // the three phases' voltages is at most 4/3 of one phase's.
            Winding::Brushless { .. } => (2.0, 4.0 / 3.0 * 0.5, 4.0 / 3.0, 1.0 / 12.0),
        };
        // Half a count of the sample, and half a count of the offset.
        let counts = current * self.amps_per_count;
        let compare = voltage * self.supply / self.counts as f64;
        // During the dead time the current's sign decides whether the phase loses or gains voltage. A
        // compensation with the wrong sign makes the voltage wrong by twice as much, in one instant only.
        let crossing = 2.0 * dead * self.supply * self.dead_time / self.instant;
        CurrentResolution {
            step: self.torque_constant * self.amps_per_count
                / if winding.is_brushed() { 2.0 } else { 1.0 },
            deviation: self.torque_constant * (counts + self.admittance() * compare),
            zero_crossing: self.torque_constant * self.plant.gain * crossing,
            ripple: self.torque_constant * swing * self.supply * self.instant / self.inductance,
        }
    }

    /// Largest current in A caused by any voltage error of up to one volt: the sum of the impulse response
    /// (theory, section 15.3).
    const fn admittance(&self) -> f64 {
        let part = (1.0 - self.plant.decay) / self.plant.feedback;
        2.0 / self.resistance * part.min(1.0)
    }
}

impl Winding {
    const fn is_brushed(self) -> bool {
        matches!(self, Self::Brushed)
    }
}
