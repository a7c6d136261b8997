//! The difference between the current and its model that converter and timer leave by their resolution.

use super::motor::Winding;
use super::plant::Plant;

/// How fine the torque of a current loop is, in N m (theory, section 15.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentResolution {
    /// Torque of a count of the current.
    pub step: f64,
    /// Largest deviation of the settled torque from the model's, of counts and compare values that are whole
    /// numbers, and of offsets that are.
    pub deviation: f64,
    /// Largest deviation after the current has changed its sign, and with it the side on which the dead time
    /// takes voltage away: beside the other, from an instant in which the voltage for it has the wrong sign.
    pub zero_crossing: f64,
    /// Largest ripple of the modulation, from peak to peak, at the highest supply. At the instants of the
    /// samples there is none of it.
    pub ripple: f64,
}

/// What the resolution comes from, in SI units.
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
        // Of the errors of two phases, the part in the current; of the errors of the phases' compare values
        // and dead times, the part in its voltage; of the supply, the ripple in the middle of its range.
        let (current, voltage, dead, swing) = match winding {
            // Half the difference of two counts; the compare values differ by the rounded number.
            Winding::Brushed => (1.0, 0.5, 2.0, 1.0 / 8.0),
            // Of `i_u` and `(i_u + 2 i_v)/sqrt 3` the vector is at most twice a phase's; of the three phases'
            // voltages it is at most 4/3 of one's.
            Winding::Brushless { .. } => (2.0, 4.0 / 3.0 * 0.5, 4.0 / 3.0, 1.0 / 12.0),
        };
        // Half a count of the sample, and half a one of the offset.
        let counts = current * self.amps_per_count;
        let compare = voltage * self.supply / self.counts as f64;
        // A side that switches on later than the other switches off takes its voltage for that time in each
        // period, and another sign of the current gives it: where it is given back with the wrong sign, the
        // voltage is off by twice as much. That is so in one instant, of whose current no more comes later.
        let crossing = 2.0 * dead * self.supply * self.dead_time / self.instant;
        CurrentResolution {
            step: self.torque_constant * self.amps_per_count
                / if winding.is_brushed() { 2.0 } else { 1.0 },
            deviation: self.torque_constant * (counts + self.admittance() * compare),
            zero_crossing: self.torque_constant * self.plant.gain * crossing,
            ripple: self.torque_constant * swing * self.supply * self.instant / self.inductance,
        }
    }

    /// Largest current in A of a voltage that is off by up to a volt, in any way: the sum of its impulse response
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
