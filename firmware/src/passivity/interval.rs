//! Outward-rounded interval arithmetic in `f64`, usable in `const fn`.
//!
//! Every operation returns an interval that contains the exact result of every choice of numbers from its
//! operands. An operation whose result is exact in `f64` keeps it exact: sums by their rounding error
//! (Dekker's two-sum), products and quotients by counting significant bits. This distinguishes a pole at
//! exactly `z = 1` from a pole near it. Only IEEE additions, multiplications and divisions are used, so the
//! end points have the same bits in the compiler, on the host and on the target.
//!
//! On a board no operation is inlined: with emulated doubles, inlining would fill a tenth of the smallest
//! flash.

use super::rounding::{
    add_down, div_down, div_up, half_down, is_not_negative, is_zero, mul_down, mul_up,
};

/// A closed interval of reals; `lo <= hi`, never NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// The number 0.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };
    /// The number 1.
    pub const ONE: Self = Self { lo: 1.0, hi: 1.0 };
    /// All reals: nothing is known.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// The interval from `lo` to `hi`; [`Interval::ENTIRE`] if these are not in order or NaN.
    pub const fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi { Self { lo, hi } } else { Self::ENTIRE }
    }

    /// The double itself; [`Interval::ENTIRE`] for NaN and infinities.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn exact(value: f64) -> Self {
        if value.is_finite() { Self { lo: value, hi: value } } else { Self::ENTIRE }
    }

    /// All decimal numbers that this double may stand for.
    ///
    /// `0.001` has no binary representation; the double nearest to it stands for all decimals that
    /// round to it. Whole numbers below 2^53 are exact in both notations.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn decimal(value: f64) -> Self {
        const EXACT_BELOW: f64 = 9_007_199_254_740_992.0;
        if !value.is_finite() {
            return Self::ENTIRE;
        }
        if value.abs() < EXACT_BELOW && (value as i64) as f64 == value {
            return Self::exact(value);
        }
        Self { lo: value.next_down(), hi: value.next_up() }
    }

    /// Lower end.
    pub const fn lo(self) -> f64 {
        self.lo
    }

    /// Upper end.
    pub const fn hi(self) -> f64 {
        self.hi
    }

    /// Middle of the interval, rounded.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn midpoint(self) -> f64 {
        self.lo * 0.5 + self.hi * 0.5
    }

    /// Whether the interval is a single number.
    pub const fn is_exact(self) -> bool {
        self.lo == self.hi
    }

    /// Whether the interval is the number 0 and nothing else.
    pub const fn is_zero(self) -> bool {
        is_zero(self.lo) && is_zero(self.hi)
    }

    /// Whether `value` is inside.
    pub const fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether every number of the interval is below every number of `other`.
    pub const fn is_below(self, other: Self) -> bool {
        self.hi < other.lo
    }

    /// Whether every number of the interval is above 0.
    pub const fn is_positive(self) -> bool {
        !is_not_negative(-self.lo)
    }

    /// Whether every number of the interval is below 0.
    pub const fn is_negative(self) -> bool {
        !is_not_negative(self.hi)
    }

    /// Whether both ends are finite.
    pub const fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// `-self`, exact.
    pub const fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }

    /// `self + other`.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn add(self, other: Self) -> Self {
        Self { lo: add_down(self.lo, other.lo), hi: -add_down(-self.hi, -other.hi) }
    }

    /// `self - other`.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    /// `self * other`.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn mul(self, other: Self) -> Self {
        let (a, b, c, d) = (self.lo, self.hi, other.lo, other.hi);
        // The end points that give the smallest and the largest product.
        let (p, q, r, s) = if is_not_negative(a) {
            if is_not_negative(c) {
                (a, c, b, d)
            } else if is_not_negative(-d) {
                (b, c, a, d)
            } else {
                (b, c, b, d)
            }
        } else if is_not_negative(-b) {
            if is_not_negative(c) {
                (a, d, b, c)
            } else if is_not_negative(-d) {
                (b, d, a, c)
            } else {
                (a, d, a, c)
            }
        } else if is_not_negative(c) {
            (a, d, b, d)
        } else if is_not_negative(-d) {
            (b, c, a, c)
        } else {
            return Self {
                lo: mul_down(a, d).min(mul_down(b, c)),
                hi: mul_up(a, c).max(mul_up(b, d)),
            };
        };
        Self { lo: mul_down(p, q), hi: mul_up(r, s) }
    }

    /// `self / other`; [`Interval::ENTIRE`] if `other` contains 0.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn div(self, other: Self) -> Self {
        if other.is_positive() {
            let lo = div_down(self.lo, if is_not_negative(self.lo) { other.hi } else { other.lo });
            let hi = div_up(self.hi, if is_not_negative(self.hi) { other.lo } else { other.hi });
            Self { lo, hi }
        } else if other.is_negative() {
            self.neg().div(other.neg())
        } else {
            Self::ENTIRE
        }
    }

    /// `self / 2`.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn half(self) -> Self {
        Self { lo: half_down(self.lo), hi: -half_down(-self.hi) }
    }

    /// `2 self`, exact unless it overflows.
    pub const fn double(self) -> Self {
        self.add(self)
    }

    /// Largest absolute value inside.
    pub const fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// `abs(self)`.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn abs(self) -> Self {
        if is_not_negative(self.lo) {
            self
        } else if is_not_negative(-self.hi) {
            self.neg()
        } else {
            Self { lo: 0.0, hi: self.magnitude() }
        }
    }

    /// The larger of two numbers, one from each interval.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn max(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The intersection of two enclosures of the same number.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn and(self, other: Self) -> Self {
        Self::new(self.lo.max(other.lo), self.hi.min(other.hi))
    }

    /// The smaller of two numbers, one from each interval.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn min(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi) }
    }

    /// Non-negative square root of the non-negative part; [`Interval::ENTIRE`] if there is none.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn sqrt(self) -> Self {
        if self.hi < 0.0 || !self.is_finite() {
            return Self::ENTIRE;
        }
        let lo = if self.lo > 0.0 { sqrt_enclosure(self.lo).lo } else { 0.0 };
        Self { lo, hi: sqrt_enclosure(self.hi).hi }
    }
}

/// Newton's iteration, then the quotient on the other side of the root: `r` and `x / r` enclose
/// it for any `r`.
const fn sqrt_enclosure(x: f64) -> Interval {
    if x == 0.0 {
        return Interval::ZERO;
    }
    // Halving the exponent gives a start within a factor of 1.5 of the root.
    let mut root = f64::from_bits((x.to_bits() >> 1) + (1023 << 51));
    each!(_step in 0..6 => {
        root = 0.5 * (root + x / root);
    });
    let (below, above) = (div_down(x, root), div_up(x, root));
    Interval::new(below.min(root), above.max(root))
}

#[cfg(test)]
mod tests {
    use super::Interval;

    #[test]
    fn what_is_not_exact_widens_and_what_is_not_known_is_entire() {
        let third = Interval::ONE.div(Interval::exact(3.0));
        assert!(!third.is_exact() && third.lo() < third.hi());
        assert!(!Interval::exact(0.1).add(Interval::exact(0.2)).is_exact());
        assert!(Interval::decimal(44.0).is_exact() && !Interval::decimal(0.1).is_exact());
        assert_eq!(Interval::ONE.div(Interval::ZERO), Interval::ENTIRE);
        assert_eq!(Interval::exact(-1.0).sqrt(), Interval::ENTIRE);
    }

    #[test]
    fn square_roots_are_tight() {
        for x in [2.0, 0.25, 1e-300, 1e300, f64::MIN_POSITIVE / 8.0, 3.0] {
            let root = Interval::exact(x).sqrt();
            assert!(root.hi() - root.lo() <= 1e-15 * root.hi() || x < 1e-307);
        }
    }
}
