//! The discrete-time tests of theory, section 1: passive, output strictly passive, input strictly passive
//! (equations 1 to 3).

use super::bernstein::{Minimum, Precision, minimum, minimum_of};
use super::chebyshev::{Kernel, Series, at_cosine};
use super::interval::Interval;
use super::poles::{IndexError, Reduced, UndecidedReason, reduce, reduce_velocity};
use super::polynomial::UnitRoot;
use super::tangent;
use super::transfer::Transfer;

/// Smallest real part on the unit circle of a function that satisfies the pole conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RealPart {
    /// Encloses the infimum of `Re G` over the circle.
    pub minimum: Interval,
    /// An enclosure of the `cos(theta)` with the smallest value found; `[-1, 1]` if both ends have it, for
    /// instance for a constant real part.
    pub cos_theta: Interval,
}

impl RealPart {
    /// A value that is reached anywhere on the circle.
    pub(crate) const fn everywhere(minimum: Interval) -> Self {
        Self { minimum, cos_theta: Interval::new(-1.0, 1.0) }
    }

    /// The larger of two, with its place.
    pub(crate) const fn or_larger(self, other: Self) -> Self {
        let Self { cos_theta, .. } =
            if self.minimum.hi() > other.minimum.hi() { self } else { other };
        Self { minimum: self.minimum.max(other.minimum), cos_theta }
    }
}

/// Input strict passivity: checks the pole conditions (equation 4) and encloses
/// `min Re G(e^(j theta))`, the index `f` for which `<u, y> >= f ||u||^2` (equation 3).
///
/// `G` is passive if the minimum is not negative. For `G = (T z / (z - 1)) E` the minimum is
/// `-alpha`. With `widen`, single-number coefficients stand for all decimals that round to them.
#[inline(never)]
pub const fn input_passivity(g: Transfer, widen: bool) -> Result<RealPart, IndexError> {
    let reduced = ok!(reduce(&g, widen));
    real_part(&reduced, &Precision::TIGHT)
}

/// Output strict passivity: the largest `d` for which `<u, y> >= d ||y||^2` (equation 2), as `min Re (1/G)`.
/// `G` must be stable; with a pole on the circle the index is at most 0.
pub const fn output_passivity(g: Transfer, widen: bool) -> Result<RealPart, IndexError> {
    let _ = ok!(reduce(&g, widen));
    input_passivity(g.inverse(), widen)
}

/// The index `alpha_min` of an environment: the least `alpha` for which `alpha + L` is passive,
/// `L = (T z / (z - 1)) E` (equations 20, 21; theory, section 2).
pub const fn index(
    environment: Transfer,
    period: Interval,
    widen: bool,
) -> Result<RealPart, IndexError> {
    index_looked_at(&environment, period, widen, &Precision::TIGHT)
}

/// [`index`], only as tight as necessary to decide on which side of `limit` it is: a sound enclosure at a
/// fraction of the cost if the index is not near. It proves an index to be below the limit if and only if
/// [`index`] does.
pub const fn index_near(
    environment: Transfer,
    period: Interval,
    widen: bool,
    limit: Interval,
) -> Result<RealPart, IndexError> {
    index_looked_at(&environment, period, widen, &Precision::around(limit.neg()))
}

/// [`index`] with an enclosure not tighter than `tolerance` times its magnitude: equally sound, to compare
/// the costs.
pub const fn index_within(
    environment: Transfer,
    period: Interval,
    widen: bool,
    tolerance: f64,
) -> Result<RealPart, IndexError> {
    index_looked_at(&environment, period, widen, &Precision::within(tolerance))
}

/// [`index`] with this precision. The border is one of the real part: the negative of a limit. Not inlined,
/// because the caller would otherwise have its frame several times.
#[inline(never)]
pub const fn index_looked_at(
    environment: &Transfer,
    period: Interval,
    widen: bool,
    closeness: &Precision,
) -> Result<RealPart, IndexError> {
    reduced_index(&reduce_velocity(environment, period, widen), closeness)
}

/// The index of an environment whose `(T z / (z - 1)) E` this is. By reference, because a small board's
/// stack has no room for a second copy.
pub(crate) const fn reduced_index(
    velocity: &Result<Reduced, IndexError>,
    closeness: &Precision,
) -> Result<RealPart, IndexError> {
    let found = match velocity {
        Ok(velocity) => ok!(real_part(velocity, closeness)),
        Err(error) => return Err(*error),
    };
    Ok(RealPart { minimum: found.minimum.neg(), cos_theta: found.cos_theta })
}

#[inline(never)]
const fn real_part(g: &Reduced, closeness: &Precision) -> Result<RealPart, IndexError> {
    ok!(residues_at_real_points(g));
    let (kernel, shift) = kernel_of(g);
    let Some(mut p) = Series::real_part(kernel, shift, &g.numerator, &g.denominator) else {
        return Err(IndexError::Undecided(UndecidedReason::OutOfRange));
    };
    if let Some(sum) = g.pair {
        p = ok!(without_pair(g, &p, sum.half()));
    }
    let r = Series::squared_magnitude(&g.denominator);
    // If the scale's sign exchanges the sides, the enclosure is tight everywhere.
    let border = if g.scale.is_positive() { closeness.border } else { Interval::ENTIRE };
    let left = g.denominator.at_unit_root(UnitRoot::Minus);
    let right = g.denominator.at_unit_root(UnitRoot::Plus);
    let ends = [left.mul(left), right.mul(right)];
    let closeness = Precision { border: border.double().div(g.scale), ..*closeness };
    let mut found = minimum(&p, &r, ends, &closeness);
    if !found.is_precise(&closeness) && g.pair.is_none() {
        found = among_crowded_poles(g, found, &closeness);
    }
    let Minimum { value, at } = found;
    let minimum = value.mul(g.scale).half();
    if minimum.is_finite() {
        Ok(RealPart { minimum, cos_theta: at })
    } else {
        Err(IndexError::Undecided(UndecidedReason::PoleNearCircle))
    }
}

/// The minimum where a Chebyshev series has lost too many digits.
#[inline(never)]
const fn among_crowded_poles(g: &Reduced, found: Minimum, closeness: &Precision) -> Minimum {
    let (kernel, shift) = kernel_of(g);
    let mut function = tangent::real_part(kernel, shift, &g.numerator, &g.denominator);
    let Some(function) = &mut function else { return found };
    let Minimum { value, at } = minimum_of(function, closeness);
    let is_better = value.hi() - value.lo() < found.value.hi() - found.value.lo();
    Minimum { value: value.and(found.value), at: if is_better { at } else { found.at } }
}

/// The kernel of the poles at 1 and -1, and the remaining power of `z`.
pub(super) const fn kernel_of(g: &Reduced) -> (Kernel, i32) {
    // 1 / (z^2 - 2 c0 z + 1) = z^-1 / (2 (c - c0)) on the circle.
    let shift = if g.pair.is_some() { g.shift - 1 } else { g.shift };
    match (g.at_one, g.at_minus_one) {
        (false, false) => (Kernel::One, shift),
        (true, false) => (Kernel::AtOne, shift - 1),
        (false, true) => (Kernel::AtMinusOne, shift),
        (true, true) => (Kernel::AtBoth, shift - 1),
    }
}

/// Residues at `z = 1` and `z = -1`: `k = residue / z_0` must be positive.
pub(super) const fn residues_at_real_points(g: &Reduced) -> Result<(), IndexError> {
    if g.at_one {
        let residue = residue_at(g, UnitRoot::Plus);
        if residue.is_negative() {
            return Err(IndexError::NegativeResidue { residue });
        }
        if !residue.is_positive() {
            return Err(IndexError::Undecided(UndecidedReason::ResidueSign));
        }
    }
    if g.at_minus_one {
        let k = residue_at(g, UnitRoot::Minus).neg();
        if k.is_negative() {
            return Err(IndexError::ResidueAngle { cos_theta: Interval::ONE.neg() });
        }
        if !k.is_positive() {
            return Err(IndexError::Undecided(UndecidedReason::ResidueSign));
        }
    }
    Ok(())
}

const fn residue_at(g: &Reduced, root: UnitRoot) -> Interval {
    let mut value = g.scale.mul(g.numerator.at_unit_root(root));
    value = value.div(g.denominator.at_unit_root(root));
    let two = Interval::exact(2.0);
    match root {
        UnitRoot::Plus => {
            if g.at_minus_one {
                value = value.half();
            }
            if let Some(sum) = g.pair {
                value = value.div(two.sub(sum));
            }
        }
        UnitRoot::Minus => {
            if g.shift % 2 != 0 {
                value = value.neg();
            }
            if g.at_one {
                value = value.half().neg();
            }
            if let Some(sum) = g.pair {
                value = value.div(two.add(sum));
            }
        }
    }
    value
}

/// Divides the real part by `2 (c - c0)`. The remainder is the imaginary part of the residue over
/// the pole: it must vanish exactly, and the residue's real part must be positive.
#[inline(never)]
const fn without_pair(g: &Reduced, p: &Series, c0: Interval) -> Result<Series, IndexError> {
    let (quotient, remainder) = p.over_linear(c0);
    if !remainder.contains(0.0) {
        return Err(IndexError::ResidueAngle { cos_theta: c0 });
    }
    if !remainder.is_zero() {
        return Err(IndexError::Undecided(UndecidedReason::ResidueSign));
    }
    let (kernel, shift) = kernel_of(g);
    let (real, imaginary) = at_cosine(c0, shift, &g.numerator, &g.denominator);
    // Imaginary part of K(z) z^shift n conj(d), times a positive factor, by kernel.
    let sign = match kernel {
        Kernel::One => imaginary,
        Kernel::AtOne => imaginary.mul(Interval::ONE.sub(c0)).sub(real),
        Kernel::AtMinusOne => imaginary.mul(Interval::ONE.add(c0)).sub(real),
        Kernel::AtBoth => real.neg(),
    };
    let k = sign.mul(g.scale);
    if k.is_negative() {
        Err(IndexError::ResidueAngle { cos_theta: c0 })
    } else if k.is_positive() {
        Ok(quotient)
    } else {
        Err(IndexError::Undecided(UndecidedReason::ResidueSign))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::gamma;
    use crate::passivity::polynomial::Polynomial;

    fn function(numerator: &[f64], denominator: &[f64]) -> Transfer {
        Transfer::new(
            Polynomial::descending(numerator, false),
            Polynomial::descending(denominator, false),
        )
    }

    fn minimum(numerator: &[f64], denominator: &[f64]) -> Result<Interval, IndexError> {
        input_passivity(function(numerator, denominator), false).map(|found| found.minimum)
    }

    /// `Q` of equation 19 by the general test against its closed form.
    #[test]
    fn coupling_spring_is_output_strictly_passive_by_gamma() {
        let (k, t, delta) = (Interval::exact(500.0), Interval::exact(0.0009765625), 0.5);
        let delta = Interval::exact(delta);
        let excess = Interval::ONE.div(k).sub(t.div(delta.double()));
        let q = Transfer { scale: excess.div(t), shift: -1, ones: 1, ..function(&[1.0], &[1.0]) };
        let general = output_passivity(q, false).unwrap().minimum;
        let formula = gamma(k, t, delta).unwrap();
        assert!(general.lo() <= formula.hi() && formula.lo() <= general.hi());
        assert!(general.hi() - general.lo() < 1e-13);
        assert_eq!(gamma(Interval::exact(2000.0), t, delta), None);
    }

    #[test]
    fn strictness_of_first_order_lags() {
        // 1 / (z - a) times (1 - a) z: real parts from (1 - a)/(1 + a) at z = -1 to 1 at z = 1.
        assert!(minimum(&[0.5, 0.0], &[1.0, -0.5]).unwrap().contains(1.0 / 3.0));
        let lag = output_passivity(function(&[0.5, 0.0], &[1.0, -0.5]), false).unwrap();
        assert!(lag.minimum.contains(1.0));
        // Trapezoidal integrator and differentiator: lossless, with a pole on the circle each.
        assert!(minimum(&[1.0, 1.0], &[1.0, -1.0]).unwrap().is_zero());
        assert!(minimum(&[1.0, -1.0], &[1.0, 1.0]).unwrap().is_zero());
        // Both at once: (z^2 + 1) / (z^2 - 1), residues 1 at 1 and 1 at -1.
        assert!(minimum(&[1.0, 0.0, 1.0], &[1.0, 0.0, -1.0]).unwrap().is_zero());
    }

    /// `abs(z + a)^2` at `z = -1` is `(1 - a)^2`, which as a sum of squares is lost at 1e-8.
    #[test]
    fn poles_may_be_as_near_the_circle_as_doubles_tell() {
        for nearness in [1e-6, 1e-9, 1e-12, 1e-15] {
            for sign in [1.0, -1.0] {
                let a = 1.0 - nearness;
                // Its real part is least on the other side of the circle.
                let found = minimum(&[1.0, 0.0], &[1.0, sign * a]);
                let found = found.unwrap_or_else(|why| panic!("{nearness} {sign}: {why:?}"));
                let wanted = 1.0 / (1.0 + a);
                assert!((found.lo() - wanted).abs() + (found.hi() - wanted).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn boundary_poles_are_told_apart() {
        let at = |n: &[f64], d: &[f64]| minimum(n, d).unwrap_err();
        assert!(matches!(at(&[-1.0], &[1.0, -1.0]), IndexError::NegativeResidue { .. }));
        assert!(matches!(at(&[1.0], &[1.0, 1.0]), IndexError::ResidueAngle { .. }));
        assert!(matches!(at(&[1.0], &[1.0, -2.0, 1.0]), IndexError::RepeatedUnitPole { .. }));
        assert!(matches!(at(&[1.0], &[1.0, 2.0, 1.0]), IndexError::RepeatedUnitPole { .. }));
        // A pair at cos(theta) = 0.625 beside a stable pole: found by the exact recursion.
        assert!(matches!(
            at(&[1.0, 0.0], &[1.0, -1.75, 1.625, -0.5]),
            IndexError::ResidueAngle { .. }
        ));
        // The same pair twice.
        assert!(matches!(
            at(&[1.0], &[1.0, -2.5, 3.5625, -2.5, 1.0]),
            IndexError::RepeatedUnitPole { .. }
                | IndexError::Undecided(UndecidedReason::SeveralPolePairs)
        ));
        assert!(matches!(at(&[1.0], &[1.0, -2.5, 1.0]), IndexError::UnstablePole { .. }));
    }

    #[test]
    fn a_circle_pole_pair_that_is_cancelled_is_no_pole() {
        let found = minimum(&[1.0, -1.25, 1.0], &[1.0, -1.25, 1.0]).unwrap();
        assert!(found.contains(1.0) && found.is_exact());
    }
}
