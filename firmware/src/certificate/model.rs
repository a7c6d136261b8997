//! The environments as transfer functions with interval coefficients (theory, section 5), and the bounds on
//! their index if they are one-sided or limited.
//!
//! The certificate is about the servo's coefficients: each is rounded to the number format, and the transfer
//! function is built from the rounded values. For [`Format::F64`] the coefficients are the scene's, as
//! doubles.

use super::loop_intervals::LoopIntervals;
use super::part::{self, Quantity, solved};
use super::validity::check;
use crate::environment::{
    Environment, EnvironmentModel, MAX_DEGREE, Rational, StatedModel, is_late,
};
use crate::number::Format;
use crate::passivity::interval::Interval;
use crate::passivity::polynomial::{Polynomial, UnitRoot};
use crate::passivity::transfer::{Transfer, Unbuildable};
use crate::scene::Scene;

/// Writes `E(z)` into `out`, causal and with a proper denominator.
#[inline(never)]
pub(super) const fn transfer(
    out: &mut Transfer,
    environment: &Environment,
    n: &LoopIntervals,
) -> Result<(), Unbuildable> {
    let is_built = match environment.rational() {
        Some(r) => match rational(r, n) {
            Some(rational) => {
                *out = rational;
                true
            }
            None => false,
        },
        None => part::transfer(out, environment.parts(), n),
    };
    if !is_built {
        return Err(Unbuildable::OutOfRange);
    }
    out.scale = n.solved(out.feedthrough());
    out.check()
}

#[inline(never)]
const fn rational(written: &Rational, n: &LoopIntervals) -> Option<Transfer> {
    let r = written.cancelled();
    let numerator = Polynomial::descending(r.numerator.as_slice(), false);
    let denominator = Polynomial::descending(r.denominator.as_slice(), false);
    let transfer = Transfer {
        shift: -(r.delay as i32),
        ones: r.unit_zeros as i32,
        ..Transfer::new(numerator, denominator)
    };
    if matches!(n.format, Format::F64) || denominator.is_zero() {
        return Some(transfer);
    }
    // A servo multiplies the zeros out and divides by the leading coefficient.
    let Some(numerator) = numerator.times_unit_root(UnitRoot::Plus, r.unit_zeros) else {
        return None;
    };
    let leading = denominator.leading();
    Some(Transfer {
        ones: 0,
        numerator: divided(&numerator, leading, n),
        denominator: divided(&denominator, leading, n),
        ..transfer
    })
}

/// The servo's coefficients of a polynomial over `leading`.
const fn divided(p: &Polynomial, leading: Interval, n: &LoopIntervals) -> Polynomial {
    let mut coefficients = [Interval::ZERO; 2 * MAX_DEGREE + 1];
    let mut i = 0;
    while i < p.len() && i < coefficients.len() {
        coefficients[i] = n.coefficient(p.coefficient(i).div(leading));
        i += 1;
    }
    Polynomial::ascending(&coefficients)
}

/// Upper bound on `alpha` that holds for one-sided walls, switching and a torque limit between environment
/// and coupling (equation 31); `None` if none is known.
///
/// - Wall, `n >= 1`: `K T (n - 1/2) + abs(B)`; a velocity filter has the l1 norm 1 and does not change
///   `sum abs(v(k)) abs(v(k - i))`. On both sides a filter counts (equation 61).
/// - Wall, undelayed: 0 for `B >= 0` without a filter, otherwise `abs(B)`.
/// - A torque profile: equations 46 and 47. A sum: the sum of the bounds (theory, section 14.3).
/// - Canceller: the clipped torque is `g(k) (h * v)(k)` with `g` in `[0, 1]`, so by Young's
///   inequality `alpha <= sum abs(h)`, which for its first-order lag is `be`.
///
/// `solved` bounds the gain from solving a tick: [`largest_solved`]. There is no bound for a rational
/// environment, nor for an environment that cancels damping where the type `E` does not
/// ([`EnvironmentModel::PARTS`]): its program has no code for that bound.
pub(super) const fn nonlinear_bound<E: EnvironmentModel>(
    environment: &Environment,
    solved: Interval,
    n: &LoopIntervals,
) -> Option<Interval> {
    let bound = some!(sum_of::<E>(Quantity::Index, environment, n));
    Some(if matches!(n.format, Format::F64) { bound } else { bound.mul(solved) })
}

/// The factor of the servo's rounded gains on the torque if the loop is solved in the tick: the larger of
/// [`LoopIntervals::solved`] out of contact and in contact. Exactly 1 for a late environment.
///
/// `None` if it is unknown. Not inlined, so that its frame is not on the stack during later calls.
#[inline(never)]
pub(super) const fn largest_solved<E: EnvironmentModel>(
    environment: &Environment,
    n: &LoopIntervals,
) -> Option<Interval> {
    if matches!(n.format, Format::F64) || is_late::<E>(environment) {
        return Some(Interval::ONE);
    }
    let Environment::Parts(parts) = environment else { return None };
    if E::PROFILE.exists && parts.profile.is_some() && parts.count() == 1 {
        // The profile is solved in front of the coupling, without a gain.
        return Some(Interval::ONE);
    }
    let contact = some!(solved::<E>(parts, n, true));
    let has_line = E::PARTS.has_lines() && parts.count() > 1;
    Some(contact.max(if has_line { some!(solved::<E>(parts, n, false)) } else { Interval::ONE }))
}

/// The quantity if a tick is solved exactly; `None` if it is unknown.
const fn sum_of<E: EnvironmentModel>(
    quantity: Quantity,
    environment: &Environment,
    n: &LoopIntervals,
) -> Option<Interval> {
    match environment {
        Environment::Parts(parts) => part::sum_of::<E>(quantity, parts, n),
        Environment::Stated(StatedModel::Bounded { bound, .. }) => {
            Some(Interval::decimal(match quantity {
                Quantity::Index => bound.index,
                Quantity::Gain => bound.gain,
            }))
        }
        Environment::Stated(StatedModel::Linear(_)) | Environment::Rational(_) => None,
    }
}

/// [`nonlinear_bound`], with [`largest_solved`].
pub(super) const fn solved_bound(environment: &Environment, n: &LoopIntervals) -> Option<Interval> {
    let solved = some!(largest_solved::<Environment>(environment, n));
    nonlinear_bound::<Environment>(environment, solved, n)
}

/// The gain of an environment from changes of position to changes of torque, in the l2 norm and times the
/// period, in N m s/rad, including one-sided and limited environments, with `solved` as for
/// [`nonlinear_bound`]. `None` if no bound is known.
///
/// A wall's torque is `K p + B(k) v(k)` with a damper that is switched between zero and `B`; a canceller's
/// torque is a weighted sum of past velocities: two consecutive torques differ by at most twice the sum of
/// the weights' magnitudes.
pub(super) const fn largest_gain<E: EnvironmentModel>(
    environment: &Environment,
    solved: Interval,
    n: &LoopIntervals,
) -> Option<Interval> {
    Some(some!(sum_of::<E>(Quantity::Gain, environment, n)).mul(solved))
}

/// The numbers of a scene and its environment, if all numbers are in range.
const fn valid_environment(
    scene: &Scene,
    format: Format,
) -> Result<(LoopIntervals, Transfer), Unbuildable> {
    if check(scene).is_err() {
        return Err(Unbuildable::OutOfRange);
    }
    if !scene.environment.has_transfer() {
        return Err(Unbuildable::Unstated);
    }
    let n = LoopIntervals::of(scene, format);
    let mut environment = Transfer::ZERO;
    ok!(transfer(&mut environment, &scene.environment, &n));
    Ok((n, environment))
}

/// A scene's linear transfer functions from position (rad) to torque (N m), as in the
/// certificate: for charts, and for simulating uncertified scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopTransfers {
    /// The environment `E` alone.
    pub environment: Transfer,
    /// The total controller `C = E / (1 + V E)` (theory, section 2).
    pub controller: Transfer,
    /// `E'`, which gives the same controller behind the standard coupling (equation 29).
    pub equivalent: Transfer,
}

impl LoopTransfers {
    /// The transfer functions of a scene with unrounded coefficients, without one-sidedness and torque limit.
    ///
    /// # Errors
    /// If the environment is not causal, the loop of coupling and environment has no solution, or a number is
    /// out of range.
    pub const fn of(scene: &Scene) -> Result<Self, Unbuildable> {
        Self::in_format(scene, Format::F64)
    }

    /// The same with the coefficients rounded to a number format.
    ///
    /// # Errors
    /// As [`LoopTransfers::of`].
    pub const fn in_format(scene: &Scene, format: Format) -> Result<Self, Unbuildable> {
        let (n, environment) = ok!(valid_environment(scene, format));
        let controller = ok!(n.behind_coupling(&environment));
        let equivalent = if n.is_standard || n.is_matched {
            environment
        } else {
            ok!(environment.behind(n.excess_compliance()))
        };
        Ok(Self { environment, controller, equivalent })
    }

    /// `E'` for latched torques with missed updates, behind the coupling that is standard for the declared
    /// passivity; judged in addition to [`LoopTransfers::equivalent`]. `None` if no update may be missed.
    ///
    /// # Errors
    /// As [`LoopTransfers::of`].
    pub const fn equivalent_where_latched(scene: &Scene) -> Result<Option<Transfer>, Unbuildable> {
        let (n, environment) = ok!(valid_environment(scene, Format::F64));
        let Some(excess) = n.excess_where_latched() else { return Ok(None) };
        let equivalent = ok!(environment.behind(excess));
        Ok(Some(equivalent))
    }
}
