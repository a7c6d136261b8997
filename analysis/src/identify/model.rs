//! A rigid device behind an amplifier that lags and a torque that is late.

use std::f64::consts::{FRAC_PI_4, TAU};

use haptic_servo::current::TorqueSource;
use nalgebra::Complex;

use super::torque_source;

/// Images of a held sine on each side that are summed: the omitted part is below 1e-5 of a response at a
/// quarter of the sampling rate, and falls with the third power of the frequency.
const IMAGES: i32 = 40;

/// `1/J = (b + j w m + Z) (1 + j w tau) e^(j w d)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Damping `b` in N m s/rad.
    pub damping: f64,
    /// Inertia `m` in kg m^2.
    pub inertia: f64,
    /// Delay `d` in s from the command to its torque.
    pub delay: f64,
    /// Coulomb friction in N m.
    pub friction: f64,
    /// Time constant `tau` in s of the amplifier.
    pub lag: f64,
    /// The current loop of a board's own bridge, which makes `Z`; `None` for an external amplifier.
    pub source: Option<TorqueSource>,
}

impl Model {
    /// The inverse response in N m s/rad at an angular frequency in rad/s.
    pub fn impedance(&self, omega: f64) -> Complex<f64> {
        self.device(omega) * self.output(omega)
    }

    /// The inverse response that a sine sees whose velocity has this amplitude in rad/s: the first harmonic of
    /// Coulomb friction is `4/pi` of it, in phase with the velocity (theory, section 3.4).
    pub fn impedance_at(&self, omega: f64, speed: f64) -> Complex<f64> {
        self.impedance(omega) + friction_damping(self.friction, speed) * self.output(omega)
    }

    /// The device's factor of it, with the torque that its motion causes through the current loop.
    pub fn device(&self, omega: f64) -> Complex<f64> {
        let path = self
            .source
            .map_or(Complex::from(0.0), |source| torque_source::impedance(&source, omega));
        Complex::new(self.damping, omega * self.inertia) + path
    }

    /// The output's factor of it: lag and delay.
    pub fn output(&self, omega: f64) -> Complex<f64> {
        Complex::new(1.0, omega * self.lag) * Complex::from_polar(1.0, omega * self.delay)
    }

    /// Mean delay in s of the torque's step response: a certificate counts it at low frequencies.
    pub fn mean_delay(&self) -> f64 {
        self.delay + self.lag
    }

    /// Factor by which the images of the held torque change the response `J`.
    ///
    /// A held sine has images around the multiples of the sampling rate; the device answers them and
    /// sampling folds the answer back: the angle is the sum of `(1 - 1/z) / (j w_k)^2 J(j w_k)` over all
    /// `w_k = w + 2 pi k/T`, and the factor that sum by its term at `w`.
    pub fn images(&self, omega: f64, period: f64) -> Complex<f64> {
        let base = self.impedance(omega) * (omega * omega);
        let image = |k: i32| {
            let shifted = omega + TAU * f64::from(k) / period;
            base / (self.impedance(shifted) * (shifted * shifted))
        };
        (1..=IMAGES).fold(Complex::from(1.0), |sum, k| sum + image(k) + image(-k))
    }
}

/// Damping in N m s/rad that friction in N m looks like, at an amplitude of the velocity in rad/s.
pub fn friction_damping(friction: f64, speed: f64) -> f64 {
    friction / (FRAC_PI_4 * speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sampled response of a held device without lag and delay is a rational function of z.
    #[test]
    fn images_add_up_to_the_sampled_response() {
        let (b, m, period) = (0.022, 2.2e-5, 1e-3);
        let model =
            Model { damping: b, inertia: m, friction: 0.0, delay: 0.0, lag: 0.0, source: None };
        for hertz in [1.0, 30.0, 240.0] {
            let (omega, pole) = (TAU * hertz, (-period * b / m).exp());
            let z = Complex::from_polar(1.0, omega * period);
            let sampled = (period / (z - 1.0) - m / b * (1.0 - pole) / (z - pole)) / b;
            let s = Complex::new(0.0, omega);
            let base = (1.0 - 1.0 / z) / (period * s * s * model.impedance(omega));
            let factor = sampled / base;
            assert!((model.images(omega, period) - factor).norm() < 2e-8 + 1e-6 * hertz / 240.0);
        }
    }
}
