//! Classifies poles: exactly on the unit circle, certainly inside, certainly outside.

use super::interval::Interval;
use super::polynomial::{Polynomial, UnitRoot};
use super::tangent;
use super::transfer::Transfer;
use crate::text::words;

/// A transfer function with separated circle poles, whose other poles are proved inside:
///
/// `G = scale z^shift numerator / (denominator (z-1)^at_one (z+1)^at_minus_one pair)` with
/// `pair = z^2 - 2 cos(theta_0) z + 1` if present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduced {
    /// Constant factor.
    pub scale: Interval,
    /// Power of `z`.
    pub shift: i32,
    /// Whether there is a pole at `z = 1`; always simple.
    pub at_one: bool,
    /// Whether there is a pole at `z = -1`.
    pub at_minus_one: bool,
    /// `2 cos(theta_0)` of the complex pair on the circle.
    pub pair: Option<Interval>,
    /// Numerator.
    pub numerator: Polynomial,
    /// Denominator, strictly Schur, lowest coefficient not exactly zero.
    pub denominator: Polynomial,
}

/// An obstacle to a passivity index other than the real part (conditions of equation 4), or an undecided
/// condition.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "each variant's description names its field")]
pub enum IndexError {
    /// A pole outside the unit circle; the reflection coefficient that shows it is at least 1 (Schur-Cohn recursion).
    UnstablePole { reflection: Interval },
    /// A repeated pole on the unit circle, at this cosine of its angle.
    RepeatedUnitPole { cos_theta: Interval },
    /// A simple circle pole at `z != 1`, at this cosine of its angle, whose residue does not have that angle.
    ResidueAngle { cos_theta: Interval },
    /// The residue at `z = 1` is negative; in N m s/rad for a velocity-to-torque function.
    NegativeResidue { residue: Interval },
    /// Not decided; never counts as passive.
    Undecided(UndecidedReason),
}

words! {
    /// The reason why a condition could not be decided.
    #[allow(missing_docs, reason = "the sentences describe the variants")]
    UndecidedReason {
    PoleNearCircle "rounding hides whether all poles are inside the unit circle: one is near it, or \
        several are close together",
    SeveralPolePairs "the environment has several pole pairs on the unit circle",
    ResidueSign "rounding hides the sign of a residue on the unit circle; declare exact zeros at z = 1 \
        as unit_zeros",
    OutOfRange "numbers or degrees are out of the range of the computation",
    TooClose "the index is too close to its limit to tell",
    NoNonlinearBound "no bound is known for a general rational environment with a torque limit",
    NoTransferFunction "the environment is stated by a bound, without a transfer function",
    MissedWithLatency "no proof is known for updates that are missed where torques lag: leave out the \
        worst period",
    NoBoundAtPort "without a coupling no bound is known for this environment with this limit, or with \
        these times: updates that are missed beside two lags, or beside a lag and jitter, or torques \
        and counts that both jitter beside a lag; couple it by a spring or, where torques lag, by the \
        matched coupling",
    NotBelowBound "without a coupling the bound on what the scene needs is not below delta, and it is \
        not known whether it needs as much",
    NoSnapBound "no proof is known for a snap point whose torque comes more than one sample late, \
        without a coupling, or beside another part: the jump of each snap would add energy in every \
        late tick; give it a delay of 0 or 1, a coupling spring or, where torques lag, the matched \
        coupling, and nothing beside it",
    NoProofWithInl "no proof is known for a nonlinear encoder with this coupling and these times: leave \
        the coupling out, or correct the angle and state the linearity of the rest",
    }
}

/// Separates the circle poles of `G`, cancels exact common factors, and proves the other poles inside.
///
/// The structure (the factors) is read from the exact doubles; the subsequent enclosure takes them as the
/// decimals they stand for, unless a circle pole at `z != 1` makes the result depend on exact values.
#[inline(never)]
pub const fn reduce(g: &Transfer, widen: bool) -> Result<Reduced, IndexError> {
    if g.numerator.is_zero() {
        return Ok(constant_zero());
    }
    let mut work = Work::of(g);
    work.separate(widen);
    work.reduced()
}

/// The same for `(T z / (z - 1)) G`, without a copy of it on the stack of a small board.
#[inline(never)]
pub(crate) const fn reduce_velocity(
    g: &Transfer,
    period: Interval,
    widen: bool,
) -> Result<Reduced, IndexError> {
    if g.numerator.is_zero() {
        return Ok(constant_zero());
    }
    let mut work = Work::of(g);
    let (scale, shift, ones) = g.velocity_factors(period);
    (work.exact.scale, work.exact.shift, work.exact.ones) = (scale, shift, ones);
    (work.wide.scale, work.wide.shift, work.wide.ones) = (scale, shift, ones);
    work.separate(widen);
    work.reduced()
}

/// `G` with its exact common factors at 0, 1 and -1 cancelled and other such factors moved to the exponents,
/// as are zeros at 1, which decimals would not sum to; coefficients as the decimals they stand for.
#[inline(never)]
pub const fn cancelled(g: &Transfer) -> Transfer {
    if g.numerator.is_zero() {
        return *g;
    }
    let mut work = Work::of(g);
    work.separate(true);
    work.strip_unit_root(UnitRoot::Plus, true);
    work.wide
}

/// The same with the exact coefficients.
#[inline(never)]
pub const fn cancelled_exactly(g: &Transfer) -> Transfer {
    if g.numerator.is_zero() {
        return *g;
    }
    let mut work = Work::of(g);
    work.separate(false);
    work.exact
}

const fn constant_zero() -> Reduced {
    Reduced {
        scale: Interval::ONE,
        shift: 0,
        at_one: false,
        at_minus_one: false,
        pair: None,
        numerator: Polynomial::ZERO,
        denominator: Polynomial::ascending(&[Interval::ONE]),
    }
}

pub(crate) const fn zeros_multiplied(g: &Transfer) -> Option<Polynomial> {
    let ones = if g.ones > 0 { g.ones as usize } else { 0 };
    let minus = if g.minus_ones > 0 { g.minus_ones as usize } else { 0 };
    let mut p = g.numerator;
    let is_in_range = p.multiply_by_unit_root(UnitRoot::Plus, ones)
        && p.multiply_by_unit_root(UnitRoot::Minus, minus);
    if is_in_range { Some(p) } else { None }
}

/// The same transfer function twice: with exact doubles, and with decimals.
struct Work {
    exact: Transfer,
    wide: Transfer,
}

impl Work {
    #[inline(always)]
    const fn of(g: &Transfer) -> Self {
        Self { wide: *g, exact: *g }
    }

    /// Moves the exact factors at 0, 1 and -1 into the exponents; with `widen`, the other function becomes
    /// that of decimals. In place: it is the largest value on a small board's stack.
    #[inline(never)]
    const fn separate(&mut self, widen: bool) {
        if widen {
            self.wide.numerator.widen();
            self.wide.denominator.widen();
        }
        let (at_one, at_minus_one) = (self.exact.ones < 0, self.exact.minus_ones < 0);
        self.strip_origin();
        self.strip_unit_root(UnitRoot::Plus, at_one);
        self.strip_unit_root(UnitRoot::Minus, at_minus_one);
    }

    /// [`reduce`], with the factors moved.
    #[inline(never)]
    const fn reduced(&mut self) -> Result<Reduced, IndexError> {
        if self.exact.ones < -1 {
            return Err(IndexError::RepeatedUnitPole { cos_theta: Interval::ONE });
        }
        if self.exact.minus_ones < -1 {
            return Err(IndexError::RepeatedUnitPole { cos_theta: Interval::ONE.neg() });
        }
        let pair = ok!(self.strip_pairs());
        let exactly = pair.is_some() || self.exact.minus_ones < 0;
        let kept = if exactly { &self.exact } else { &self.wide };
        ok!(strictly_schur(&kept.denominator));
        let Some(numerator) = zeros_multiplied(kept) else {
            return Err(IndexError::Undecided(UndecidedReason::OutOfRange));
        };
        Ok(Reduced {
            scale: kept.scale,
            shift: kept.shift,
            at_one: kept.ones < 0,
            at_minus_one: kept.minus_ones < 0,
            pair,
            numerator,
            denominator: kept.denominator,
        })
    }

    /// Powers of `z` do not change magnitudes on the circle: they become part of the shift.
    const fn strip_origin(&mut self) {
        let zeros = self.exact.numerator.trailing_zeros();
        let poles = self.exact.denominator.trailing_zeros();
        self.divide(zeros, poles);
    }

    const fn divide(&mut self, zeros: usize, poles: usize) {
        self.exact.numerator = self.exact.numerator.shifted_down(zeros);
        self.wide.numerator = self.wide.numerator.shifted_down(zeros);
        self.exact.denominator = self.exact.denominator.shifted_down(poles);
        self.wide.denominator = self.wide.denominator.shifted_down(poles);
        self.exact.shift += zeros as i32 - poles as i32;
        self.wide.shift = self.exact.shift;
    }

    /// Moves the exact factors `z - root` of the denominator, and of the numerator if they cancel poles or on
    /// request, into the exponents.
    const fn strip_unit_root(&mut self, root: UnitRoot, strips_zeros: bool) {
        let mut change = 0;
        while self.exact.denominator.vanishes_at(root) {
            self.exact.denominator = self.exact.denominator.over_unit_root(root);
            self.wide.denominator = self.wide.denominator.over_unit_root(root);
            change -= 1;
        }
        if strips_zeros || change < 0 {
            while self.exact.numerator.vanishes_at(root) {
                self.exact.numerator = self.exact.numerator.over_unit_root(root);
                self.wide.numerator = self.wide.numerator.over_unit_root(root);
                change += 1;
            }
        }
        match root {
            UnitRoot::Plus => {
                self.exact.ones += change;
                self.wide.ones = self.exact.ones;
            }
            UnitRoot::Minus => {
                self.exact.minus_ones += change;
                self.wide.minus_ones = self.exact.minus_ones;
            }
        }
    }

    /// Finds the complex pair of circle poles that remains after cancellation.
    const fn strip_pairs(&mut self) -> Result<Option<Interval>, IndexError> {
        let mut found: Option<Interval> = None;
        loop {
            let sum = match circle_pair(&self.exact.denominator) {
                Ok(Some(sum)) => sum,
                Ok(None) => return Ok(found),
                Err(doubt) => return Err(IndexError::Undecided(doubt)),
            };
            let (quotient, ..) = self.exact.denominator.over_pair(sum);
            self.exact.denominator = quotient;
            let (reduced, constant, linear) = self.exact.numerator.over_pair(sum);
            if constant.is_zero() && linear.is_zero() && !reduced.is_zero() {
                self.exact.numerator = reduced;
                self.wide = self.exact;
            } else if let Some(before) = found {
                // A second pair: an equal pair is a repeated pole; a different pair is not supported.
                let same = before.lo() == sum.lo() && before.hi() == sum.hi();
                return Err(if same {
                    IndexError::RepeatedUnitPole { cos_theta: sum.half() }
                } else {
                    IndexError::Undecided(UndecidedReason::SeveralPolePairs)
                });
            } else {
                found = Some(sum);
            }
        }
    }
}

/// Cosine of the angle of a hidden mode on the unit circle: the numerator has the same root, so the transfer
/// function does not have the pole, but a difference equation with these polynomials has the mode.
#[inline(never)]
pub const fn hidden_mode(g: &Transfer) -> Option<Interval> {
    let one = g.denominator.vanishes_at(UnitRoot::Plus);
    if one && (g.ones > 0 || g.numerator.vanishes_at(UnitRoot::Plus)) {
        return Some(Interval::ONE);
    }
    let minus_one = g.denominator.vanishes_at(UnitRoot::Minus);
    if minus_one && (g.minus_ones > 0 || g.numerator.vanishes_at(UnitRoot::Minus)) {
        return Some(Interval::ONE.neg());
    }
    let mut denominator = g.denominator;
    while let Ok(Some(sum)) = circle_pair(&denominator) {
        let (quotient, constant, linear) = g.numerator.over_pair(sum);
        if constant.is_zero() && linear.is_zero() && !quotient.is_zero() {
            return Some(sum.half());
        }
        (denominator, ..) = denominator.over_pair(sum);
    }
    None
}

/// `2 cos(theta_0)` of an exact factor `z^2 - 2 cos(theta_0) z + 1` of `p`.
///
/// The greatest common divisor of `p` and its reverse holds exactly the circle roots and the mirrored pairs.
/// It is found by the Schur-Cohn recursion without divisions, which is exact while the coefficients are short
/// enough; otherwise no pair is found, and [`strictly_schur`] reports the pole as undecided.
#[inline(never)]
const fn circle_pair(p: &Polynomial) -> Result<Option<Interval>, UndecidedReason> {
    let mut p = *p;
    while p.len() >= 3 && p.is_exact() && p.is_finite() {
        let n = p.degree();
        let (first, last) = (p.coefficient(0), p.coefficient(n));
        if first.lo() == last.lo() && is_palindrome(&p) {
            if n > 2 {
                return Err(UndecidedReason::SeveralPolePairs);
            }
            let sum = p.coefficient(1).div(last).neg();
            return Ok(if sum.abs().is_below(Interval::exact(2.0)) { Some(sum) } else { None });
        }
        let mut next = [Interval::ZERO; super::polynomial::MAX_DEGREE];
        each!(i in 1..=n => {
            let kept = last.mul(p.coefficient(i));
            next[i - 1] = kept.sub(first.mul(p.coefficient(n - i)));
        });
        p = Polynomial::ascending(next.split_at(n).0);
        let zeros = p.trailing_zeros();
        if p.len() < n || zeros > 0 {
            p = p.shifted_down(zeros);
        }
    }
    Ok(None)
}

const fn is_palindrome(p: &Polynomial) -> bool {
    let n = p.degree();
    each!(i in 0..=n / 2 => {
        if p.coefficient(i).lo() != p.coefficient(n - i).lo() {
            return false;
        }
    });
    true
}

/// Proves that all roots are inside the unit circle, or that a root is outside.
#[inline(never)]
pub const fn strictly_schur(p: &Polynomial) -> Result<(), IndexError> {
    match schur_cohn(p) {
        // Where roots crowd at 1, rounding loses less in the tangent of half the angle.
        Err(IndexError::Undecided(_)) if tangent::has_all_roots_inside(p) => Ok(()),
        decided => decided,
    }
}

/// The Schur-Cohn recursion.
const fn schur_cohn(p: &Polynomial) -> Result<(), IndexError> {
    let mut p = *p;
    while p.degree() > 0 {
        let n = p.degree();
        let reflection = p.coefficient(0).div(p.coefficient(n));
        let size = reflection.abs();
        if !size.is_below(Interval::ONE) {
            return Err(if Interval::ONE.is_below(size) {
                IndexError::UnstablePole { reflection: size }
            } else if size.is_exact() && n <= 2 && !on_circle(&p) {
                // The magnitudes multiply to one and the roots are not on the circle.
                IndexError::UnstablePole { reflection: size }
            } else {
                IndexError::Undecided(UndecidedReason::PoleNearCircle)
            });
        }
        let mut next = [Interval::ZERO; super::polynomial::MAX_DEGREE];
        each!(i in 1..=n => {
            next[i - 1] = p.coefficient(i).sub(reflection.mul(p.coefficient(n - i)));
        });
        p = Polynomial::ascending(next.split_at(n).0);
        if p.degree() != n - 1 || p.leading().contains(0.0) {
            return Err(IndexError::Undecided(UndecidedReason::PoleNearCircle));
        }
    }
    Ok(())
}

/// Whether a polynomial of degree at most two with a reflection coefficient of magnitude one may
/// have its roots on the circle.
const fn on_circle(p: &Polynomial) -> bool {
    if p.degree() < 2 {
        return true;
    }
    let sum = p.coefficient(1).div(p.coefficient(2)).abs();
    let mirrored = p.coefficient(0).lo() == p.coefficient(2).lo();
    if mirrored { !Interval::exact(2.0).is_below(sum) } else { sum.contains(0.0) }
}
