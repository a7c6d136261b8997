//! The readings of an encoder: how old they are, how far off, and how many may fail (theory, section 18).
//!
//! A quadrature encoder with a perfect disk reads the present position up to a count. A magnetic encoder with a
//! serial interface reads an older one, with an integral nonlinearity (INL) and noise.

use crate::time_range::{TimeRange, is_zero};

/// The readings of an encoder. An encoder that predicts the position from the velocity has none of these: it
/// has no certificate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderReading {
    /// Age in s of the position at the instant of its count, anywhere in the range in each tick.
    pub age: TimeRange,
    /// Length in s of the window before that age over whose positions the encoder takes the mean.
    pub window: f64,
    /// Largest slope of the angle's error over the angle, `eta`: from the angle `x` the encoder reads
    /// `x + e(x)` with `abs(e') <= eta`.
    pub linearity: f64,
    /// Peak of the noise in counts.
    pub noise: f64,
    /// Hysteresis in counts.
    pub hysteresis: f64,
    /// Coulomb friction in N m of the device at the motor, as far as an endless torque profile relies on it.
    pub friction: f64,
    /// Readings in a row that may be dropped; each is replaced by the reading before.
    pub dropped: u16,
}

impl EncoderReading {
    /// A quadrature encoder with a perfect disk.
    pub const IDEAL: Self = Self {
        age: TimeRange::ZERO,
        window: 0.0,
        linearity: 0.0,
        noise: 0.0,
        hysteresis: 0.0,
        friction: 0.0,
        dropped: 0,
    };

    /// The same, for a scene.
    pub const fn ideal() -> &'static Self {
        const { &Self::IDEAL }
    }

    /// Whether it reads as a quadrature encoder with a perfect disk does, but for noise and hysteresis.
    pub const fn is_ideal(&self) -> bool {
        self.age.is_zero() && is_zero(self.linearity) && is_zero(self.window) && self.dropped == 0
    }

    /// Whether a tick whose reading is dropped is left out, a missed update that the torque lasts through, in a
    /// servo with this period and this longest time between updates in s. If not, the law gets the reading before.
    ///
    /// A law of more than one position would see a handle that stands still and then jumps: its certificate is that
    /// of missed updates (theory, section 18.1).
    pub const fn leaves_out(&self, period: f64, worst_period: Option<f64>) -> bool {
        const ROUNDED: f64 = 1.0 - 1e-9;
        let held = (self.dropped as f64 + 1.0) * period;
        matches!(worst_period, Some(worst) if worst >= held * ROUNDED)
    }

    /// The most in s by which an age deviates from the middle of its range.
    pub const fn deviation_of_age(&self) -> f64 {
        0.5 * (self.age.most - self.age.least)
    }

    /// Largest error of a reading at rest, over that of half a count.
    pub const fn steps(&self) -> f64 {
        1.0 + 2.0 * self.noise + self.hysteresis
    }
}
