//! The continuous-time tests of theory, section 1, for rational functions of `s`.
//!
//! `s = w (z - 1)/(z + 1)` maps the left half plane to the unit disk, `s = 0` to `z = 1` and
//! infinity to `z = -1`, and leaves the values on the boundary as they are. A rational function is
//! positive real in `s` exactly if its image is in `z`, with the conditions on boundary poles
//! carried over; so the discrete test answers the continuous question, with the same enclosure.

use haptic_servo::passivity::discrete::{RealPart, input_passivity};
use haptic_servo::passivity::interval::Interval;
use haptic_servo::passivity::poles::{IndexError, UndecidedReason};
use haptic_servo::passivity::polynomial::{MAX_DEGREE, Polynomial, UnitRoot};
use haptic_servo::passivity::transfer::Transfer;

/// `G(s) = s^zeros numerator(s) / denominator(s)`; coefficients in descending powers of `s`.
///
/// `zeros` may be negative for poles at 0; declaring them keeps them exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousTransfer {
    /// Numerator.
    pub numerator: Polynomial,
    /// Denominator.
    pub denominator: Polynomial,
    /// Power of `s`.
    pub zeros: i32,
}

impl ContinuousTransfer {
    /// From descending coefficients, taken as the doubles they are.
    pub const fn new(numerator: &[f64], denominator: &[f64]) -> Self {
        let numerator = Polynomial::descending(numerator, false);
        let denominator = Polynomial::descending(denominator, false);
        let (zeros, poles) = (numerator.trailing_zeros(), denominator.trailing_zeros());
        Self {
            numerator: numerator.shifted_down(zeros),
            denominator: denominator.shifted_down(poles),
            zeros: zeros as i32 - poles as i32,
        }
    }

    /// The free-mode environment of equation 22, position to torque:
    /// `E(s) = -2 b be s / (T be s + 2 b)`, `be = b - epsilon`.
    pub const fn free_mode(b: Interval, be: Interval, period: Interval) -> Self {
        let two_b = b.double();
        Self {
            numerator: Polynomial::ascending(&[two_b.mul(be).neg()]),
            denominator: Polynomial::ascending(&[two_b, period.mul(be)]),
            zeros: 1,
        }
    }

    /// `G(s) / s`: from velocity instead of position.
    pub const fn of_velocity(self) -> Self {
        Self { zeros: self.zeros - 1, ..self }
    }

    /// `1 / G(s)`.
    pub const fn inverse(self) -> Self {
        Self { numerator: self.denominator, denominator: self.numerator, zeros: -self.zeros }
    }

    /// The image under `s = w (z - 1)/(z + 1)`, `w` a power of two near the size of the poles and
    /// zeros.
    const fn image(&self) -> Option<Transfer> {
        let w = frequency_scale(&self.denominator, &self.numerator);
        let (Some(numerator), Some(denominator)) =
            (image_of(&self.numerator, w), image_of(&self.denominator, w))
        else {
            return None;
        };
        // (z + 1)^degree multiplied each polynomial.
        let raised = self.numerator.degree() as i32 - self.denominator.degree() as i32;
        let mut scale = Interval::ONE;
        let mut i = 0;
        while i < self.zeros.abs() {
            scale = if self.zeros > 0 { scale.mul(w) } else { scale.div(w) };
            i += 1;
        }
        Some(Transfer {
            scale,
            shift: 0,
            ones: self.zeros,
            minus_ones: -raised - self.zeros,
            numerator,
            denominator,
        })
    }
}

/// `sum of a_i w^i (z - 1)^i (z + 1)^(n - i)`.
const fn image_of(p: &Polynomial, w: Interval) -> Option<Polynomial> {
    let n = p.degree();
    let mut sum = Polynomial::ZERO;
    let mut power = Interval::ONE;
    let mut i = 0;
    while i <= n && !p.is_zero() {
        let term = Polynomial::ascending(&[p.coefficient(i).mul(power)]);
        let Some(term) = term.times_unit_root(UnitRoot::Plus, i) else { return None };
        let Some(term) = term.times_unit_root(UnitRoot::Minus, n - i) else { return None };
        sum = sum.plus(&term);
        power = power.mul(w);
        i += 1;
    }
    Some(sum)
}

/// A power of two near the geometric mean of the roots' magnitudes.
const fn frequency_scale(denominator: &Polynomial, numerator: &Polynomial) -> Interval {
    let p = if denominator.degree() > 0 { denominator } else { numerator };
    let n = p.degree() as i32;
    if n == 0 {
        return Interval::ONE;
    }
    let exponent = (binary_exponent(p.coefficient(0)) - binary_exponent(p.leading())) / n;
    let clamped = if exponent > 200 {
        200
    } else if exponent < -200 {
        -200
    } else {
        exponent
    };
    Interval::exact(f64::from_bits(((1023 + clamped) as u64) << 52))
}

const fn binary_exponent(value: Interval) -> i32 {
    ((value.magnitude().to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// Input strict passivity in continuous time: checks the poles (left half plane; simple on the
/// axis, with positive residues) and encloses `min Re G(j w)` over all frequencies, infinity
/// included (equation 3). The function is passive if the minimum is not negative.
///
/// `cos_theta` of the result belongs to the image: `tan(theta / 2)` is the frequency over the
/// scale.
pub const fn input_passivity_of(g: ContinuousTransfer) -> Result<RealPart, IndexError> {
    if g.denominator.is_zero() || g.numerator.degree() > MAX_DEGREE {
        return Err(IndexError::Undecided(UndecidedReason::OutOfRange));
    }
    match g.image() {
        // A pole at s = w lands at infinity, where the denominator has lost its degree.
        Some(image) if image.relative_degree() > 0 => {
            Err(IndexError::UnstablePole { reflection: Interval::new(f64::MAX, f64::INFINITY) })
        }
        Some(image) => input_passivity(image, false),
        None => Err(IndexError::Undecided(UndecidedReason::OutOfRange)),
    }
}

/// Output strict passivity in continuous time: `min Re (1/G(j w))` of a passive `G` (equation 2).
pub const fn output_passivity_of(g: ContinuousTransfer) -> Result<RealPart, IndexError> {
    match input_passivity_of(g) {
        Ok(_) => input_passivity_of(g.inverse()),
        Err(obstacle) => Err(obstacle),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn minimum(numerator: &[f64], denominator: &[f64]) -> Result<Interval, IndexError> {
        input_passivity_of(ContinuousTransfer::new(numerator, denominator)).map(|r| r.minimum)
    }

    #[test]
    fn mechanical_elements() {
        // Velocity to force: mass, damper, spring, and all three.
        assert!(minimum(&[0.5, 0.0], &[1.0]).unwrap().contains(0.0));
        assert!(minimum(&[0.25], &[1.0]).unwrap().contains(0.25));
        assert!(minimum(&[30.0], &[1.0, 0.0]).unwrap().contains(0.0));
        assert!(minimum(&[0.5, 0.25, 30.0], &[1.0, 0.0]).unwrap().contains(0.25));
        assert!(matches!(minimum(&[-30.0], &[1.0, 0.0]), Err(IndexError::NegativeResidue { .. })));
    }

    #[test]
    fn a_mass_damper_is_output_strictly_passive_by_its_damping() {
        let admittance = ContinuousTransfer::new(&[1.0], &[0.05, 0.5]);
        let d = output_passivity_of(admittance).unwrap().minimum;
        assert!(d.contains(0.5) && d.hi() - d.lo() < 1e-12);
    }

    #[test]
    fn free_mode_needs_what_it_cancels() {
        let (b, be) = (Interval::exact(1.0), Interval::decimal(0.95));
        let e = ContinuousTransfer::free_mode(b, be, Interval::decimal(0.001));
        let found = input_passivity_of(e.of_velocity()).unwrap();
        assert!(found.minimum.contains(-0.95));
    }

    #[test]
    fn what_is_not_positive_real_is_found() {
        // Non-collocated resonance: 1 / (s^2 + s + 1).
        assert!(minimum(&[1.0], &[1.0, 1.0, 1.0]).unwrap().is_negative());
        assert!(matches!(minimum(&[1.0], &[1.0, -1.0]), Err(IndexError::UnstablePole { .. })));
        // s / (s^2 + 1): lossless. 1 / (s^2 + 1): residue of the wrong angle.
        assert!(minimum(&[1.0, 0.0], &[1.0, 0.0, 1.0]).unwrap().is_zero());
        assert!(matches!(minimum(&[1.0], &[1.0, 0.0, 1.0]), Err(IndexError::ResidueAngle { .. })));
        assert!(matches!(
            minimum(&[1.0], &[1.0, 0.0, 0.0]),
            Err(IndexError::RepeatedUnitPole { .. })
        ));
    }
}
