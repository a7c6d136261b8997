//! Polynomials with interval coefficients, up to the degree of a scene.

use super::exact_sum::ExactSum;
use super::interval::Interval;

/// Largest degree: eight of the environment, eight of the delay.
pub const MAX_DEGREE: usize = 16;
const CAPACITY: usize = MAX_DEGREE + 1;

/// A polynomial; coefficients in ascending powers, the leading one not exactly zero, unless the
/// polynomial is zero (no coefficients).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial {
    coefficients: [Interval; CAPACITY],
    len: usize,
}

impl Polynomial {
    /// The zero polynomial.
    pub const ZERO: Self = Self { coefficients: [Interval::ZERO; CAPACITY], len: 0 };

    /// From ascending coefficients. Those beyond [`MAX_DEGREE`] must be zero.
    pub const fn ascending(values: &[Interval]) -> Self {
        let mut out = Self::ZERO;
        let mut i = 0;
        while i < values.len() && i < CAPACITY {
            out.coefficients[i] = values[i];
            i += 1;
        }
        out.len = i;
        out.trimmed()
    }

    /// From descending doubles, exact or as the decimals they stand for.
    pub const fn descending(values: &[f64], decimal: bool) -> Self {
        let mut out = Self::ZERO;
        let mut i = 0;
        while i < values.len() && i < CAPACITY {
            let value = values[values.len() - 1 - i];
            out.coefficients[i] =
                if decimal { Interval::decimal(value) } else { Interval::exact(value) };
            i += 1;
        }
        out.len = i;
        out.trimmed()
    }

    const fn trimmed(mut self) -> Self {
        self.trim();
        self
    }

    const fn trim(&mut self) {
        while self.len > 0 && self.coefficients[self.len - 1].is_zero() {
            self.len -= 1;
        }
    }

    /// Whether this is the zero polynomial.
    pub const fn is_zero(&self) -> bool {
        self.len == 0
    }

    /// Number of coefficients: the degree plus one, 0 for the zero polynomial.
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no coefficients; the same as [`Polynomial::is_zero`].
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Degree; 0 for the zero polynomial.
    pub const fn degree(&self) -> usize {
        self.len.saturating_sub(1)
    }

    /// Coefficient of `z^power`.
    pub const fn coefficient(&self, power: usize) -> Interval {
        if power < self.len { self.coefficients[power] } else { Interval::ZERO }
    }

    /// Coefficient of the highest power; zero for the zero polynomial.
    pub const fn leading(&self) -> Interval {
        self.coefficient(self.degree())
    }

    /// Number of lowest coefficients that are exactly zero: the power of `z` that divides the polynomial.
    pub const fn trailing_zeros(&self) -> usize {
        let mut n = 0;
        while n < self.len && self.coefficients[n].is_zero() {
            n += 1;
        }
        n
    }

    /// Divides by `z^power`, dropping the lowest coefficients.
    pub const fn shifted_down(&self, power: usize) -> Self {
        let mut out = Self::ZERO;
        each!(i in power..self.len => {
            out.coefficients[i - power] = self.coefficients[i];
        });
        out.len = self.len.saturating_sub(power);
        out
    }

    /// Multiplies by `z^power`; `None` past [`MAX_DEGREE`].
    #[inline(never)]
    pub const fn shifted_up(&self, power: usize) -> Option<Self> {
        let mut out = *self;
        if out.shift_up(power) { Some(out) } else { None }
    }

    /// The same in place, so that a small board's stack holds it once; `false` past [`MAX_DEGREE`].
    pub(crate) const fn shift_up(&mut self, power: usize) -> bool {
        if self.len == 0 || power == 0 {
            return true;
        }
        if self.len + power > CAPACITY {
            return false;
        }
        let mut i = self.len + power;
        while i > 0 {
            i -= 1;
            self.coefficients[i] =
                if i < power { Interval::ZERO } else { self.coefficients[i - power] };
        }
        self.len += power;
        true
    }

    /// `self * factor`.
    #[inline(never)]
    pub const fn scaled(&self, factor: Interval) -> Self {
        let mut out = *self;
        out.scale(factor);
        out
    }

    /// The same in place.
    #[inline(never)]
    pub(crate) const fn scale(&mut self, factor: Interval) {
        each!(i in 0..self.len => {
            self.coefficients[i] = self.coefficients[i].mul(factor);
        });
        self.trim();
    }

    /// `self + other`.
    #[inline(never)]
    pub const fn plus(&self, other: &Self) -> Self {
        let mut out = *self;
        out.add(other);
        out
    }

    /// The same in place.
    #[inline(never)]
    pub(crate) const fn add(&mut self, other: &Self) {
        let len = if self.len > other.len { self.len } else { other.len };
        each!(i in 0..len => {
            self.coefficients[i] = self.coefficient(i).add(other.coefficient(i));
        });
        self.len = len;
        self.trim();
    }

    /// `self * other`; `None` past [`MAX_DEGREE`].
    #[inline(never)]
    pub const fn times(&self, other: &Self) -> Option<Self> {
        let mut out = *self;
        if out.multiply(other) { Some(out) } else { None }
    }

    /// The same in place; `false` past [`MAX_DEGREE`].
    #[inline(never)]
    pub(crate) const fn multiply(&mut self, other: &Self) -> bool {
        if self.len == 0 || other.len == 0 {
            *self = Self::ZERO;
            return true;
        }
        let len = self.len + other.len - 1;
        if len > CAPACITY {
            return false;
        }
        // From the top: each sum is of coefficients from its own place downwards.
        let mut k = len;
        while k > 0 {
            k -= 1;
            let mut sum = Interval::ZERO;
            let mut i = if k < other.len { 0 } else { k + 1 - other.len };
            while i <= k && i < self.len {
                sum = sum.add(self.coefficients[i].mul(other.coefficients[k - i]));
                i += 1;
            }
            self.coefficients[k] = sum;
        }
        self.len = len;
        self.trim();
        true
    }

    /// `self * (z - root)^power`, `root` being 1 or -1; `None` past [`MAX_DEGREE`].
    #[inline(never)]
    pub const fn times_unit_root(&self, root: UnitRoot, power: usize) -> Option<Self> {
        let mut out = *self;
        if out.multiply_by_unit_root(root, power) { Some(out) } else { None }
    }

    /// The same in place; `false` past [`MAX_DEGREE`].
    #[inline(never)]
    pub(super) const fn multiply_by_unit_root(&mut self, root: UnitRoot, power: usize) -> bool {
        if self.len == 0 {
            return true;
        }
        if self.len + power > CAPACITY {
            return false;
        }
        each!(_factor in 0..power => {
            let lowest = root.times(self.coefficients[0]).neg();
            // Coefficient i of the product is c[i - 1] - root c[i]; from the top, in place.
            let mut i = self.len;
            while i > 0 {
                let upper = if i < self.len { self.coefficients[i] } else { Interval::ZERO };
                self.coefficients[i] = self.coefficients[i - 1].sub(root.times(upper));
                i -= 1;
            }
            self.coefficients[0] = lowest;
            self.len += 1;
        });
        true
    }

    /// Quotient by `(z - root)`; the remainder is dropped.
    pub const fn over_unit_root(&self, root: UnitRoot) -> Self {
        if self.len == 0 {
            return Self::ZERO;
        }
        let mut out = Self::ZERO;
        let mut carry = Interval::ZERO;
        let mut i = self.len - 1;
        while i > 0 {
            carry = self.coefficients[i].add(root.times(carry));
            out.coefficients[i - 1] = carry;
            i -= 1;
        }
        out.len = self.len - 1;
        out.trimmed()
    }

    /// Quotient and remainder (constant, linear) by `z^2 - sum z + 1`.
    pub const fn over_pair(&self, sum: Interval) -> (Self, Interval, Interval) {
        if self.len < 3 {
            return (Self::ZERO, self.coefficient(0), self.coefficient(1));
        }
        let mut out = Self::ZERO;
        let (mut next, mut after) = (Interval::ZERO, Interval::ZERO);
        let mut i = self.len - 1;
        while i >= 2 {
            let q = self.coefficients[i].add(sum.mul(next)).sub(after);
            out.coefficients[i - 2] = q;
            (after, next) = (next, q);
            i -= 1;
        }
        out.len = self.len - 2;
        let linear = self.coefficients[1].add(sum.mul(next)).sub(after);
        let constant = self.coefficients[0].sub(next);
        (out.trimmed(), constant, linear)
    }

    /// Value at 1 or -1.
    pub const fn at_unit_root(&self, root: UnitRoot) -> Interval {
        let mut sum = Interval::ZERO;
        let mut i = self.len;
        while i > 0 {
            i -= 1;
            sum = self.coefficients[i].add(root.times(sum));
        }
        sum
    }

    /// Single numbers become all decimals that round to them.
    pub(super) const fn widen(&mut self) {
        each!(i in 0..self.len => {
            let c = self.coefficients[i];
            self.coefficients[i] = if c.is_exact() { Interval::decimal(c.lo()) } else { c };
        });
        self.trim();
    }

    /// Whether every coefficient is a single number.
    pub const fn is_exact(&self) -> bool {
        each!(i in 0..self.len => {
            if !self.coefficients[i].is_exact() {
                return false;
            }
        });
        true
    }

    /// Whether every coefficient has finite ends.
    pub const fn is_finite(&self) -> bool {
        each!(i in 0..self.len => {
            if !self.coefficients[i].is_finite() {
                return false;
            }
        });
        true
    }

    /// Whether the polynomial is proved to vanish at 1 or -1: its coefficients are single numbers
    /// whose sum, without any rounding, is zero.
    pub const fn vanishes_at(&self, root: UnitRoot) -> bool {
        if self.len == 0 || !self.is_exact() || !self.is_finite() {
            return false;
        }
        let mut sum = ExactSum::<CAPACITY>::EMPTY;
        each!(i in 0..self.len => {
            let x = self.coefficients[i].lo();
            sum.add(if matches!(root, UnitRoot::Minus) && i % 2 == 1 { -x } else { x });
        });
        sum.is_finite && sum.is_zero()
    }
}

/// One of the two real points of the unit circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitRoot {
    /// `z = 1`.
    Plus,
    /// `z = -1`.
    Minus,
}

impl UnitRoot {
    const fn times(self, value: Interval) -> Interval {
        match self {
            Self::Plus => value,
            Self::Minus => value.neg(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn poly(descending: &[f64]) -> Polynomial {
        Polynomial::descending(descending, false)
    }

    #[test]
    fn factors_at_the_real_unit_roots() {
        let p = poly(&[3.0, -2.0, 5.0]);
        for root in [UnitRoot::Plus, UnitRoot::Minus] {
            let product = p.times_unit_root(root, 3).unwrap();
            assert!(product.vanishes_at(root));
            let back = product.over_unit_root(root).over_unit_root(root).over_unit_root(root);
            assert_eq!(back, p);
            assert!(!p.vanishes_at(root));
        }
    }

    #[test]
    fn zero_sums_are_exact() {
        assert!(poly(&[0.1, -0.1]).vanishes_at(UnitRoot::Plus));
        assert!(!poly(&[0.1, 0.2, -0.3]).vanishes_at(UnitRoot::Plus));
        assert!(poly(&[1e300, 1.0, -1e300, -1.0]).vanishes_at(UnitRoot::Plus));
        assert!(!poly(&[1e300, 1.0, -1e300, -0.5]).vanishes_at(UnitRoot::Plus));
    }

    #[test]
    fn pair_division_leaves_no_remainder() {
        let pair = poly(&[1.0, -1.25, 1.0]);
        let p = poly(&[2.0, 0.0, -7.0, 1.0]);
        let (quotient, constant, linear) = p.times(&pair).unwrap().over_pair(Interval::exact(1.25));
        assert_eq!(quotient, p);
        assert!(constant.is_zero() && linear.is_zero());
    }
}
