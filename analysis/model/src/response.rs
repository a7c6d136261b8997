//! A transfer function in `f64`: its value at any `z`, and its difference equation.
//!
//! The coefficients come from the certificate's [`Transfer`], so that a formula has one home.

use haptic_servo::passivity::polynomial::{Polynomial, UnitRoot};
use haptic_servo::passivity::transfer::Transfer;
use nalgebra::Complex;

/// `numerator(z) / denominator(z)` with ascending coefficients; causal.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    transfer: Transfer,
}

impl Response {
    /// The response of a transfer function whose coefficients are narrow intervals.
    pub fn new(transfer: Transfer) -> Self {
        Self { transfer }
    }

    /// `(T z / (z - 1)) G`, from backward-difference velocity (theory, section 2).
    pub fn from_velocity(&self, period: f64) -> Self {
        let period = haptic_servo::passivity::interval::Interval::exact(period);
        Self::new(self.transfer.from_velocity(period))
    }

    /// The transfer function.
    pub fn transfer(&self) -> &Transfer {
        &self.transfer
    }

    /// Value at `z`; infinite or not a number on a pole.
    pub fn at(&self, z: Complex<f64>) -> Complex<f64> {
        let t = &self.transfer;
        let one = Complex::new(1.0, 0.0);
        let factors = z.powi(t.shift) * (z - one).powi(t.ones) * (z + one).powi(t.minus_ones);
        factors * t.scale.midpoint() * horner(&t.numerator, z) / horner(&t.denominator, z)
    }

    /// Value on the unit circle at the angle `theta` in rad.
    pub fn at_angle(&self, theta: f64) -> Complex<f64> {
        // From a library, not from the system: the last digits differ between systems, and the verdict states
        // the angle.
        self.at(Complex::new(libm::cos(theta), libm::sin(theta)))
    }

    /// The difference equation; `None` if the degree is beyond the certificate's limit.
    pub fn filter(&self) -> Option<Filter> {
        let t = &self.transfer;
        let up = |power: i32| power.max(0) as usize;
        let build = |p: &Polynomial, sign: i32| {
            p.shifted_up(up(sign * t.shift))?
                .times_unit_root(UnitRoot::Plus, up(sign * t.ones))?
                .times_unit_root(UnitRoot::Minus, up(sign * t.minus_ones))
        };
        let (numerator, denominator) = (build(&t.numerator, 1)?, build(&t.denominator, -1)?);
        let degree = denominator.degree();
        let leading = denominator.leading().midpoint();
        let scale = t.scale.midpoint();
        // Descending powers, so that index k multiplies the sample of k ticks ago.
        let newest_first = |p: &Polynomial, factor: f64| -> Vec<f64> {
            (0..=degree).map(|k| factor * p.coefficient(degree - k).midpoint() / leading).collect()
        };
        Some(Filter {
            numerator: newest_first(&numerator, scale),
            denominator: newest_first(&denominator, 1.0),
            state: vec![0.0; degree + 1],
        })
    }
}

fn horner(p: &Polynomial, z: Complex<f64>) -> Complex<f64> {
    (0..p.len()).rev().fold(Complex::new(0.0, 0.0), |sum, power| {
        sum * z + Complex::new(p.coefficient(power).midpoint(), 0.0)
    })
}

/// A difference equation, at rest at zero to begin with (direct form II, transposed).
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
    state: Vec<f64>,
}

impl Filter {
    /// Coefficients of the input of this tick, of one tick ago, and so on.
    pub fn numerator(&self) -> &[f64] {
        &self.numerator
    }

    /// Coefficients of the output, likewise; the first is 1.
    pub fn denominator(&self) -> &[f64] {
        &self.denominator
    }

    /// One tick.
    pub fn tick(&mut self, input: f64) -> f64 {
        let output = self.numerator[0] * input + self.state[0];
        for k in 1..self.state.len() {
            self.state[k - 1] =
                self.numerator[k] * input - self.denominator[k] * output + self.state[k];
        }
        output
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{STANDARD, on_paddle};
    use haptic_servo::certificate::LoopTransfers;
    use haptic_servo::environment::Wall;
    use haptic_servo::scene::Scene;

    fn wall(delay: usize) -> Scene {
        on_paddle(Wall::damped(22.0, 0.01, delay).alone(), STANDARD)
    }

    #[test]
    fn value_and_difference_equation_of_a_wall() {
        let environment = Response::new(LoopTransfers::of(&wall(1)).unwrap().environment);
        // z^-1 (K + B (z - 1) / (T z)) at z = -1
        let at = environment.at_angle(std::f64::consts::PI);
        assert!((at.re + 22.0 + 2.0 * 10.0).abs() < 1e-12 && at.im.abs() < 1e-12);
        let mut filter = environment.filter().unwrap();
        let impulse: Vec<f64> = (0..4).map(|k| filter.tick(f64::from(k == 0))).collect();
        for (is, should) in impulse.iter().zip([0.0, 32.0, -10.0, 0.0]) {
            assert!((is - should).abs() < 1e-12, "{impulse:?}");
        }
    }

    #[test]
    fn controller_is_environment_behind_the_coupling() {
        for delay in 0..4 {
            let found = LoopTransfers::of(&wall(delay)).unwrap();
            let [e, c] = [found.environment, found.controller].map(Response::new);
            for theta in [0.1, 1.0, 3.0] {
                let one = Complex::new(1.0, 0.0);
                let should = e.at_angle(theta) / (one + e.at_angle(theta) / 44.0);
                assert!((c.at_angle(theta) - should).norm() < 1e-10);
            }
        }
    }
}
