//! An enclosure of the exponential function, which is not available in `const fn`.

use super::interval::Interval;

/// Terms of the series, whose last one is below `2^-60` for arguments of at most a half.
const TERMS: u32 = 15;
/// `exp(-x)` is zero in doubles beyond this.
const VANISHES: f64 = 746.0;

impl Interval {
    /// `exp(-self)` of a number that is not negative; negative numbers count as 0.
    ///
    /// The argument is halved until it is at most a half; there the alternating series lies between any two
    /// consecutive partial sums. The result is squared as often as the argument was halved.
    #[inline(never)]
    pub const fn exp_of_negative(self) -> Self {
        let fastest = one_end(self.hi().max(0.0)).lo();
        let slowest = one_end(self.lo().max(0.0)).hi();
        Self::new(fastest.max(0.0), slowest.min(1.0))
    }
}

const fn one_end(x: f64) -> Interval {
    if x.is_nan() || x >= VANISHES {
        return Interval::new(0.0, f64::MIN_POSITIVE);
    }
    let (mut halvings, mut small) = (0, x);
    while small > 0.5 {
        // Exact, as a power of two.
        small *= 0.5;
        halvings += 1;
    }
    let mut value = series(small);
    while halvings > 0 {
        value = value.mul(value);
        halvings -= 1;
    }
    value
}

/// `1 - x (1 - x/2 (1 - x/3 (...)))`, whose innermost bracket is between 0 and 1.
const fn series(x: f64) -> Interval {
    let x = Interval::exact(x);
    let mut bracket = Interval::new(0.0, 1.0);
    let mut k = TERMS;
    while k > 0 {
        let term = x.div(Interval::exact(k as f64));
        bracket = Interval::ONE.sub(term.mul(bracket));
        k -= 1;
    }
    bracket
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encloses_what_the_library_of_the_host_computes() {
        for i in 0..4000 {
            let x = f64::from(i) * f64::from(i) * 4e-5;
            let found = Interval::exact(x).exp_of_negative();
            let wanted = (-x).exp();
            // The library is off by less than a unit of the last place.
            assert!(found.lo() <= wanted.next_up() && wanted.next_down() <= found.hi(), "{x}");
            let width = (found.hi() - found.lo()) / wanted;
            assert!(width < 1e-15 * (4.0 + 4.0 * x) || x > 700.0, "{x}: {width}");
        }
    }

    #[test]
    fn is_between_nothing_and_one() {
        let of = |lo, hi| Interval::new(lo, hi).exp_of_negative();
        assert_eq!(of(0.0, 0.0), Interval::ONE);
        assert_eq!(of(f64::INFINITY, f64::INFINITY).lo(), 0.0);
        assert!(of(1e9, 1e9).hi() <= f64::MIN_POSITIVE);
        let range = of(1.0, 2.0);
        assert!(range.lo() <= (-2.0_f64).exp() && (-1.0_f64).exp() <= range.hi());
        assert_eq!(Interval::ENTIRE.exp_of_negative().lo(), 0.0);
    }
}
