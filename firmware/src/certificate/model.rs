//! The environments as transfer functions with interval coefficients (theory, section 5), and the bounds on
//! their index if they are one-sided or limited.
//!
//! The certificate is about the servo's coefficients: each is rounded to the number format, and the transfer
//! function is built from the rounded values. For [`Format::F64`] the coefficients are the scene's, as
//! doubles.

use super::loop_intervals::LoopIntervals;
use super::profile::{profile_bound, profile_gain};
use super::validity::check;
use crate::environment::{
    Canceller, Environment, EnvironmentModel, MAX_DEGREE, Parts, Rational, StatedModel, Wall,
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
        None => sum(out, environment.parts(), n),
    };
    if !is_built {
        return Err(Unbuildable::OutOfRange);
    }
    out.scale = n.solved(out.feedthrough());
    out.check()
}

/// The sum over the parts with a transfer function; `false` if its degree is too high. A late torque profile,
/// or an environment that is stated only by its bound and late, is without feedthrough.
#[inline(never)]
const fn sum(out: &mut Transfer, parts: &Parts, n: &LoopIntervals) -> bool {
    match (&parts.canceller, &parts.wall) {
        (Some(canceller), None) => *out = free_mode(canceller, n),
        (Some(canceller), Some(w)) => {
            *out = free_mode(canceller, n);
            return out.add(&wall(w, n));
        }
        (None, Some(w)) => *out = wall(w, n),
        (None, None) => *out = Transfer::ZERO,
    }
    true
}

/// `z^-n (K + B (1 - a)(z - 1) / (T (z - a)))`, `a = 0` without a filter (equation 24).
const fn wall(w: &Wall, n: &LoopIntervals) -> Transfer {
    let k = n.coefficient(Interval::decimal(w.stiffness));
    let Washout { gain: b, pole: a } = damper(w, n);
    let denominator = Polynomial::ascending(&[a.neg().mul(n.period), n.period]);
    let shift = -(w.delay as i32);
    if k.is_zero() {
        // A pure damper keeps its exact zero at z = 1; so does a wall whose stiffness is rounded to zero.
        let numerator = Polynomial::ascending(&[b]);
        return Transfer { shift, ones: 1, ..Transfer::new(numerator, denominator) };
    }
    let kt = k.mul(n.period);
    let numerator = Polynomial::ascending(&[kt.mul(a).add(b).neg(), kt.add(b)]);
    Transfer { shift, ..Transfer::new(numerator, denominator) }
}

/// `(gain / T) (z - 1) / (z - pole)`, as a servo computes it: from the gain over the period and
/// from the rate `1 - pole`.
pub(super) struct Washout {
    pub gain: Interval,
    pub pole: Interval,
}

impl Washout {
    /// From the unrounded gain over the period and the unrounded rate.
    const fn rounded(gain: Interval, rate: Interval, n: &LoopIntervals) -> Self {
        let gain = n.coefficient(gain).mul(n.period);
        Self { gain, pole: Interval::ONE.sub(n.coefficient(rate)) }
    }

    /// `sum abs(h)` of its impulse response from velocity to torque.
    const fn l1_norm(&self) -> Interval {
        self.gain.abs().div(Interval::ONE.sub(self.pole.abs()))
    }
}

/// The damper of a wall.
pub(super) const fn damper(w: &Wall, n: &LoopIntervals) -> Washout {
    let b = Interval::decimal(w.damping());
    let rate = match w.filter() {
        Some(a) if w.damping() != 0.0 => Interval::ONE.sub(Interval::decimal(a)),
        _ => Interval::ONE,
    };
    match (n.format, w.filter()) {
        (Format::F64, Some(a)) if w.damping() != 0.0 => {
            Washout { gain: b.mul(rate), pole: Interval::decimal(a) }
        }
        (Format::F64, _) => Washout { gain: b, pole: Interval::ZERO },
        _ => Washout::rounded(b.div(n.period).mul(rate), rate, n),
    }
}

/// `-be K (z - 1) / ((K T + be) z - be)`, for a rigid coupling `-be (z - 1) / (T z)` (equation
/// 23, generalised from `K = 2 b / T` to any coupling spring), late by the canceller's delay.
pub(super) const fn free_mode(canceller: &Canceller, n: &LoopIntervals) -> Transfer {
    let be = n.cancelled;
    let (gain, denominator) = match (n.format, n.coupling) {
        (Format::F64, Some(k)) => {
            let kt = k.mul(n.period);
            (be.mul(k), Polynomial::ascending(&[be.neg(), kt.add(be)]))
        }
        (Format::F64, None) => (be, Polynomial::ascending(&[Interval::ZERO, n.period])),
        _ => {
            let Washout { gain, pole } = self::canceller(n);
            (gain, Polynomial::ascending(&[pole.neg().mul(n.period), n.period]))
        }
    };
    let numerator = Polynomial::ascending(&[gain.neg()]);
    let shift = -(canceller.delay as i32);
    Transfer { shift, ones: 1, ..Transfer::new(numerator, denominator) }
}

/// The canceller as a servo computes it, with the opposite sign.
pub(super) const fn canceller(n: &LoopIntervals) -> Washout {
    let be = n.cancelled;
    match n.coupling {
        Some(k) => {
            let kt = k.mul(n.period);
            let leading = kt.add(be);
            Washout::rounded(be.mul(k).div(leading), kt.div(leading), n)
        }
        None => Washout::rounded(be.div(n.period), Interval::ONE, n),
    }
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
///   `sum abs(v(k)) abs(v(k - i))`. On both sides a filter counts: [`filtered_bound`].
/// - Wall, undelayed: 0 for `B >= 0` without a filter, otherwise `abs(B)`.
/// - A torque profile: [`profile_bound`]. A sum: the sum of the bounds (theory, section 14.3).
/// - Canceller: the clipped torque is `g(k) (h * v)(k)` with `g` in `[0, 1]`, so by Young's
///   inequality `alpha <= sum abs(h)`, which for the first-order lag of [`free_mode`] is `be`.
///
/// `solved` bounds the gain from solving a tick: [`largest_solved`]. There is no bound for a rational
/// environment, nor for an environment that cancels damping where the type `E` does not
/// ([`EnvironmentModel::CANCELS_DAMPING`]): its program has no code for that bound.
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
    if matches!(n.format, Format::F64) || environment.is_late() {
        return Some(Interval::ONE);
    }
    let parts = environment.parts();
    if E::PROFILE.exists && parts.profile.is_some() && parts.count() == 1 {
        // The profile is solved in front of the coupling, without a gain.
        return Some(Interval::ONE);
    }
    let Some(contact) = scale::<E>(environment, n) else { return None };
    Some(match &parts.canceller {
        Some(canceller) if E::CANCELS_DAMPING && parts.count() > 1 => {
            n.solved(free_mode(canceller, n).feedthrough()).max(contact)
        }
        _ => contact.max(Interval::ONE),
    })
}

/// The factor of the servo's rounded gains, from an environment's [feedthrough](Transfer::feedthrough): for a
/// wall and a canceller the sum of both. `None` for a rational environment, where no bound needs it.
const fn scale<E: EnvironmentModel>(
    environment: &Environment,
    n: &LoopIntervals,
) -> Option<Interval> {
    let Environment::Parts(Parts { canceller, wall, profile }) = environment else { return None };
    if profile.is_some() && !E::PROFILE.is_composed {
        return None;
    }
    let mut feedthrough = match wall {
        Some(w) => self::wall(w, n).feedthrough(),
        None => Interval::ZERO,
    };
    if let Some(canceller) = canceller {
        if !E::CANCELS_DAMPING {
            return None;
        }
        feedthrough = feedthrough.add(free_mode(canceller, n).feedthrough());
    }
    let scale = n.solved(feedthrough);
    if scale.is_finite() { Some(scale) } else { None }
}

/// A quantity of an environment, the sum of those of its parts.
#[derive(Clone, Copy)]
enum Quantity {
    /// [`nonlinear_bound`].
    Index,
    /// [`largest_gain`].
    Gain,
}

/// The quantity if a tick is solved exactly; `None` if it is unknown of a part, or if the program of the type
/// `E` has no such sum.
const fn sum_of<E: EnvironmentModel>(
    quantity: Quantity,
    environment: &Environment,
    n: &LoopIntervals,
) -> Option<Interval> {
    let parts = match environment {
        Environment::Parts(parts) => parts,
        Environment::Stated(StatedModel::Bounded { bound, .. }) => {
            return Some(Interval::decimal(match quantity {
                Quantity::Index => bound.index,
                Quantity::Gain => bound.gain,
            }));
        }
        Environment::Stated(StatedModel::Linear(_)) | Environment::Rational(_) => return None,
    };
    let is_alone = parts.count() == 1;
    let mut sum = match (quantity, &parts.wall) {
        (_, None) => Interval::ZERO,
        (Quantity::Gain, Some(w)) => wall_gain(w, n),
        // A negative spring is not a monotone law.
        (Quantity::Index, Some(w)) if w.stiffness < 0.0 => return None,
        (Quantity::Index, Some(w)) if is_alone => wall_alone_bound(w, n),
        (Quantity::Index, Some(w)) => wall_bound(w, n),
    };
    if let Some(profile) = &parts.profile {
        if !E::PROFILE.exists || !is_alone && !E::PROFILE.is_composed {
            return None;
        }
        let of_profile = match quantity {
            Quantity::Gain => some!(profile_gain::<E>(profile, n)),
            Quantity::Index if !is_alone && profile.snap.is_some() => return None,
            Quantity::Index => some!(profile_bound::<E>(profile, n)),
        };
        sum = of_profile.add(sum);
    }
    if parts.canceller.is_some() {
        if !E::CANCELS_DAMPING {
            return None;
        }
        let bound = some!(canceller_bound(n));
        sum = sum.add(match quantity {
            Quantity::Index => bound,
            Quantity::Gain => bound.double(),
        });
    }
    Some(sum)
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

const fn wall_gain(w: &Wall, n: &LoopIntervals) -> Interval {
    let k = n.coefficient(Interval::decimal(w.stiffness)).abs();
    k.mul(n.period).add(switched_damping(w, n).double())
}

/// Sum of the magnitudes of a wall's torques for a unit of velocity.
pub(super) const fn switched_damping(w: &Wall, n: &LoopIntervals) -> Interval {
    match n.format {
        Format::F64 => Interval::decimal(w.damping()).abs(),
        _ => damper(w, n).l1_norm(),
    }
}

const fn wall_bound(w: &Wall, n: &LoopIntervals) -> Interval {
    let damping = switched_damping(w, n);
    if w.delay == 0 {
        let passive = w.filter().is_none() && w.damping() >= 0.0;
        return if passive { Interval::ZERO } else { damping };
    }
    let samples = Interval::exact(w.delay as f64 - 0.5);
    let k = n.coefficient(Interval::decimal(w.stiffness));
    k.mul(n.period).mul(samples).add(damping)
}

/// The same for a wall that is the only part.
const fn wall_alone_bound(w: &Wall, n: &LoopIntervals) -> Interval {
    let bound = wall_bound(w, n);
    if w.filter().is_none() {
        return bound;
    }
    match filtered_bound(w, n) {
        Some(filtered) => filtered.min(bound),
        None => bound,
    }
}

/// The same for a wall on both sides whose velocity is filtered: `(2 n - 1) B (1 - a) / (1 + a)` in place of
/// `abs(B)`, and 0 without delay (equation 61). `None` if the wall or the filter is another.
const fn filtered_bound(w: &Wall, n: &LoopIntervals) -> Option<Interval> {
    let Washout { gain, pole } = damper(w, n);
    let is_filter = gain.lo() >= 0.0 && pole.lo() >= 0.0 && pole.hi() < 1.0;
    if w.is_one_sided() || !is_filter {
        return None;
    }
    if w.delay == 0 {
        return Some(Interval::ZERO);
    }
    let samples = Interval::exact(w.delay as f64 - 0.5);
    let k = n.coefficient(Interval::decimal(w.stiffness));
    let damping = gain.double().div(Interval::ONE.add(pole));
    Some(k.mul(n.period).add(damping).mul(samples))
}

/// Sum of the magnitudes of a canceller's torques for a unit of velocity; `None` if there is none.
pub(super) const fn canceller_bound(n: &LoopIntervals) -> Option<Interval> {
    let be = n.cancelled;
    match (n.format, n.coupling) {
        (Format::F64, Some(k)) if be.lo() < 0.0 => {
            // Added damping: the lag's pole be / (K T + be) is negative, its l1 norm larger.
            let kt = k.mul(n.period);
            let room = kt.sub(be.abs().double());
            if room.is_positive() { Some(kt.mul(be.abs()).div(room)) } else { None }
        }
        (Format::F64, _) => Some(be.abs()),
        _ => {
            let canceller = canceller(n);
            let settles = Interval::ONE.sub(canceller.pole.abs()).is_positive();
            if settles { Some(canceller.l1_norm()) } else { None }
        }
    }
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
