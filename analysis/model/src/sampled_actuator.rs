//! An amplifier whose current loop is updated a whole number of times in a period (theory, section 13.8):
//! from one update to the next its torque goes in a straight line, and its error shrinks by the same factor.

use haptic_servo::scene::Latency;
use nalgebra::Complex;

/// The amplifier, without the updates before its torque begins, which are a delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledActuator {
    /// Time in s between two updates.
    between: f64,
    /// Fraction of a step that remains after that time.
    left: f64,
}

impl SampledActuator {
    /// For a scene with this period in s; `None` where its amplifier is not updated.
    pub fn of(latency: &Latency, period: f64) -> Option<Self> {
        let updates = latency.actuator_updates;
        let between = period / f64::from(updates);
        let left = (-between / latency.actuator_lag.middle()).exp();
        (updates > 0).then_some(Self { between, left })
    }

    /// Time in s between two updates.
    pub fn between(&self) -> f64 {
        self.between
    }

    /// Number of updates in `time` s, to the nearest.
    pub fn in_time(&self, time: f64) -> u32 {
        (time / self.between).round() as u32
    }

    /// Whether a time in s is a whole number of updates, as far as decimals can say.
    pub fn is_whole(&self, time: f64) -> bool {
        self.after_update(time) == 0.0
    }

    /// Time in s since the last update, a time in s after one; zero where decimals cannot tell it from that.
    pub fn after_update(&self, time: f64) -> f64 {
        const ROUNDING: f64 = 1e-3;
        let updates = time / self.between;
        if (updates - updates.round()).abs() <= ROUNDING {
            return 0.0;
        }
        updates.fract() * self.between
    }

    /// Slope of the torque until the next update in N m/s, for a torque that is 1 N m below its command now, `since` s
    /// after the last update. There it was further below, by what the slope has made since.
    pub fn slope(&self, since: f64) -> f64 {
        let slope = (1.0 - self.left) / self.between;
        slope / (1.0 - slope * since)
    }

    /// Torque from a command that changes at updates only, at an angular frequency in rad/s that is not 0.
    ///
    /// Its step response is that of a first-order lag at the updates, joined by straight lines: the response
    /// to a pulse is constant between updates.
    pub fn response(&self, omega: f64) -> Complex<f64> {
        let step = Complex::from_polar(1.0, -omega * self.between);
        let pulse = (1.0 - step) / Complex::new(0.0, omega * self.between);
        pulse * (1.0 - self.left) / (1.0 - step * self.left)
    }
}
