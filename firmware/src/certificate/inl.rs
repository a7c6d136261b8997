//! Linear scenes whose encoder has an integral nonlinearity (INL), `eta`, by the exact rule (theory, section
//! 18.3).

use super::linearity::is_delay_alone;
use super::problem::PassivityProblem;
use crate::passivity::bernstein::{Precision, minimum};
use crate::passivity::chebyshev::Series;
use crate::passivity::discrete::RealPart;
use crate::passivity::interval::Interval;
use crate::passivity::lagged::{LagIntervals, ripple_of_mixture, stable};
use crate::passivity::poles::{IndexError, UndecidedReason, zeros_multiplied};
use crate::passivity::polynomial::{Polynomial, UnitRoot};
use crate::passivity::transfer::Transfer;

const OUT_OF_RANGE: IndexError = IndexError::Undecided(UndecidedReason::OutOfRange);
const UNPROVED: IndexError = IndexError::Undecided(UndecidedReason::NoProofWithInl);

impl PassivityProblem {
    /// The index at the port of a linear scene through the encoder, for the passivity of its device, and the
    /// least sufficient passivity on request (equation 66).
    #[inline(never)]
    pub(super) const fn through_inl(
        &self,
        closeness: &Precision,
        and_needed: bool,
    ) -> Result<(RealPart, Interval), IndexError> {
        let n = &self.numbers;
        if n.misses_updates || self.has_no_transfer() {
            return Err(UNPROVED);
        }
        let (found, needed, delay) = match &n.latency {
            None => {
                let found = ok!(self.without_delay(closeness));
                (found, found.minimum, Interval::ZERO)
            }
            Some(lagging) if is_delay_alone(&lagging.latency) => {
                let (found, needed) = ok!(self.over_cells(closeness, and_needed));
                let delay = Interval::decimal(lagging.latency.output_delay.most).div(n.period);
                (found, needed, delay)
            }
            Some(_) => return Err(UNPROVED),
        };
        let memory = ok!(self.memory(delay));
        let least = if and_needed { needed } else { n.delta };
        let minimum = found.minimum.add(memory.cost(n.linearity, n.period, n.delta));
        let needed = needed.add(memory.cost(n.linearity, n.period, least));
        Ok((RealPart { minimum, ..found }, needed))
    }

    /// The largest gains of the controller over all pieces of the delay in periods.
    #[inline(never)]
    const fn memory(&self, delay: Interval) -> Result<Memory, IndexError> {
        let controller = match self.numbers.behind_coupling(&self.environment) {
            Ok(controller) => ok!(stable(&controller)),
            Err(_) => return Err(OUT_OF_RANGE),
        };
        let is_delayed = !delay.is_zero();
        let ripple = if is_delayed { ripple_of_mixture(delay, delay) } else { Interval::ZERO };
        let lags = [Interval::ZERO, Interval::ZERO];
        let pieces = LagIntervals { delay, lags, updates: 0, between: false };
        let mut memory = Memory { at_rest: Interval::ZERO, moving: Interval::ZERO, ripple };
        each!(piece in 0..pieces.pieces() => {
            let whole = delay.lo().max(0.0) as i32 + piece as i32;
            let part = delay.sub(Interval::exact(whole as f64)).and(Interval::new(0.0, 1.0));
            let (at_rest, moving) = ok!(gains(&controller, whole, part));
            memory.at_rest = memory.at_rest.max(at_rest);
            memory.moving = memory.moving.max(moving);
        });
        if is_delayed {
            let (_, largest) = ok!(largest_gain(&controller));
            memory.ripple = ripple.mul(largest);
        }
        Ok(memory)
    }
}

/// The gains on which the cost of a nonlinear encoder depends.
#[derive(Clone, Copy)]
struct Memory {
    /// `abs(H(1))`.
    at_rest: Interval,
    /// The largest `abs((H(z) - H(1))/(z - 1))` on the circle.
    moving: Interval,
    /// `D/T^2` times the largest `abs(H)^2`.
    ripple: Interval,
}

impl Memory {
    const fn cost(&self, eta: Interval, period: Interval, delta: Interval) -> Interval {
        let cost = eta.mul(period).mul(self.at_rest.half().add(self.moving));
        if self.ripple.is_zero() {
            return cost;
        }
        let ripple = self.ripple.mul(period).mul(period).div(delta.double().double());
        cost.add(eta.mul(Interval::ONE.add(eta)).mul(ripple))
    }
}

/// Numerator and denominator of a controller, as polynomials with the same magnitude on the circle.
const fn fraction(h: &Transfer, whole: i32) -> Option<(Polynomial, Polynomial)> {
    let numerator = some!(zeros_multiplied(h)).scaled(h.scale);
    let shift = h.shift - whole;
    if shift >= 0 {
        return Some((some!(numerator.shifted_up(shift as usize)), h.denominator));
    }
    Some((numerator, some!(h.denominator.shifted_up(-shift as usize))))
}

/// `abs(H(1))` and the largest `abs((H(z) - H(1))/(z - 1))` of a controller after a delay.
#[inline(never)]
const fn gains(
    h: &Transfer,
    whole: i32,
    part: Interval,
) -> Result<(Interval, Interval), IndexError> {
    let later = if part.is_zero() { whole } else { whole + 1 };
    let Some((mut numerator, denominator)) = fraction(h, later) else { return Err(OUT_OF_RANGE) };
    if !part.is_zero() {
        let held = Polynomial::ascending(&[part, Interval::ONE.sub(part)]);
        match numerator.times(&held) {
            Some(product) => numerator = product,
            None => return Err(OUT_OF_RANGE),
        }
    }
    let at_rest =
        numerator.at_unit_root(UnitRoot::Plus).div(denominator.at_unit_root(UnitRoot::Plus));
    let rest = numerator.plus(&denominator.scaled(at_rest.neg())).over_unit_root(UnitRoot::Plus);
    let square = ok!(largest_square(&rest, &denominator));
    Ok((at_rest.abs(), square.sqrt()))
}

/// The largest `abs(H)` and its square on the circle.
#[inline(never)]
const fn largest_gain(h: &Transfer) -> Result<(Interval, Interval), IndexError> {
    let Some((numerator, denominator)) = fraction(h, 0) else { return Err(OUT_OF_RANGE) };
    let square = ok!(largest_square(&numerator, &denominator));
    Ok((square.sqrt(), square))
}

const fn largest_square(
    numerator: &Polynomial,
    denominator: &Polynomial,
) -> Result<Interval, IndexError> {
    let p = Series::squared_magnitude(numerator).scaled(Interval::ONE.neg());
    let (left, right) =
        (denominator.at_unit_root(UnitRoot::Minus), denominator.at_unit_root(UnitRoot::Plus));
    let ends = [left.mul(left), right.mul(right)];
    let r = Series::squared_magnitude(denominator);
    let largest = minimum(&p, &r, ends, &Precision::TIGHT).value.neg();
    if largest.is_finite() { Ok(largest.max(Interval::ZERO)) } else { Err(OUT_OF_RANGE) }
}
