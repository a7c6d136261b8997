//! Functions on the unit circle in the tangent of half the angle: `z = (1 + s)/(1 - s)`, `s = j tan(theta/2)`
//! (theory, section 7).
//!
//! Poles that crowd at `z = 1` leave nothing of the sums that a Chebyshev series is made of: eight of them at
//! a distance of 0.06 give a squared magnitude of `1e-20` from products of about 1000. In powers of `s` each
//! coefficient has the size that belongs to such poles, and is the only sum that cancels: it is computed
//! without rounding. All sums after that are of numbers of one size.

use super::bernstein::{Bernstein, Precision, SIZE, binomial, minimum_of};
use super::chebyshev::Kernel;
use super::exact_sum::ExactSum;
use super::interval::Interval;
use super::polynomial::Polynomial;

/// Coefficients in ascending powers, of `s` or of its square.
type Coefficients = [Interval; SIZE];

/// `2 Re(K(z) z^shift n(z) conj(d(z)))` and `abs(d(z))^2`, over a common factor, in Bernstein form. `None`
/// for other kernels than 1 and that of a pole at 1, and beyond the largest degree.
#[inline(never)]
pub(super) const fn real_part(
    kernel: Kernel,
    shift: i32,
    n: &Polynomial,
    d: &Polynomial,
) -> Option<Bernstein> {
    let (above, below) = if shift > 0 { (shift as usize, 0) } else { (0, -shift as usize) };
    let (over, under) = (n.degree() + above, d.degree() + below);
    let degree = if over > under { over } else { under };
    if degree >= SIZE {
        return None;
    }
    let (n, d) = (Parts::of(n, above, degree), Parts::of(d, below, degree));
    let real = n.even.times(&d.even).plus(&n.odd.times(&d.odd).raised());
    let p = match kernel {
        Kernel::One => real.plus(&real),
        // z/(z - 1) = 1/2 + 1/(2 s): the imaginary part over s is a polynomial.
        Kernel::AtOne => real.plus(&n.odd.times(&d.even)).plus(&n.even.times(&d.odd).negative()),
        Kernel::AtMinusOne | Kernel::AtBoth => return None,
    };
    let r = d.squared_magnitude();
    Some(Bernstein { p: p.in_bernstein(degree), r: r.in_bernstein(degree), degree })
}

/// Whether all roots are proved to be inside of the unit circle: those of the middle of its coefficients are,
/// and no root crosses the circle on the way to others, because the polynomial is nowhere on it as small as
/// they change it (the theorem of Rouché).
#[inline(never)]
pub(super) const fn has_all_roots_inside(p: &Polynomial) -> bool {
    let mut middle = [Interval::ZERO; SIZE];
    let mut change = Interval::ZERO;
    each!(i in 0..p.len() => {
        let c = p.coefficient(i);
        middle[i] = Interval::exact(c.midpoint());
        change = change.add(Interval::exact(c.hi()).sub(Interval::exact(c.lo())));
    });
    let middle = Polynomial::ascending(&middle);
    // The theorem counts roots inside: all of them only if the degree is the same.
    middle.degree() == p.degree()
        && is_hurwitz(&middle)
        && (change.is_zero() || is_larger_on_circle(&middle, change))
}

/// Whether all roots are proved to be inside of the unit circle: those in `s` are in the left half-plane, by
/// Routh's array.
#[inline(never)]
const fn is_hurwitz(p: &Polynomial) -> bool {
    let degree = p.degree();
    let mut rows = [[Interval::ZERO; SIZE]; 2];
    each!(power in 0..=degree => {
        let from_top = degree - power;
        rows[from_top % 2][from_top / 2] = in_tangent(p, 0, degree, power);
    });
    let sign = if rows[0][0].is_negative() { Interval::ONE.neg() } else { Interval::ONE };
    each!(row in 0..=degree => {
        let [above, below] = &rows;
        if !above[0].mul(sign).is_positive() {
            return false;
        }
        let mut next = [Interval::ZERO; SIZE];
        if row < degree {
            let ratio = above[0].div(below[0]);
            let mut i = 0;
            while i + 1 < SIZE {
                next[i] = above[i + 1].sub(ratio.mul(below[i + 1]));
                i += 1;
            }
        }
        rows = [*below, next];
    });
    true
}

/// Whether the magnitude of a polynomial is proved to be larger than `change` on the whole circle.
#[inline(never)]
const fn is_larger_on_circle(p: &Polynomial, change: Interval) -> bool {
    let degree = p.degree();
    let square = change.mul(change);
    let mut squared = Bernstein {
        p: Parts::of(p, 0, degree).squared_magnitude().in_bernstein(degree),
        // That of (1 + t^2)^degree.
        r: [Interval::ONE; SIZE],
        degree,
    };
    minimum_of(&mut squared, &Precision::around(square)).value.lo() > square.hi()
}

/// A polynomial at `s = jt`: `even(t^2) + jt odd(t^2)`.
struct Parts {
    even: Squared,
    odd: Squared,
}

impl Parts {
    /// Those of `z^shift p(z) (1 - s)^degree`.
    #[inline(never)]
    const fn of(p: &Polynomial, shift: usize, degree: usize) -> Self {
        let mut parts = [[Interval::ZERO; SIZE]; 2];
        each!(power in 0..=degree => {
            let value = in_tangent(p, shift, degree, power);
            // (jt)^2 = -t^2
            let half = power / 2;
            parts[power % 2][half] = if half % 2 == 0 { value } else { value.neg() };
        });
        Self { even: Squared(parts[0]), odd: Squared(parts[1]) }
    }

    const fn squared_magnitude(&self) -> Squared {
        self.even.times(&self.even).plus(&self.odd.times(&self.odd).raised())
    }
}

/// A polynomial in `t^2`.
#[derive(Clone, Copy)]
struct Squared(Coefficients);

impl Squared {
    const fn plus(&self, other: &Self) -> Self {
        let mut out = *self;
        each!(k in 0..SIZE => {
            out.0[k] = out.0[k].add(other.0[k]);
        });
        out
    }

    const fn negative(&self) -> Self {
        let mut out = *self;
        each!(k in 0..SIZE => {
            out.0[k] = out.0[k].neg();
        });
        out
    }

    /// The product, whose degree is below the capacity.
    #[inline(never)]
    const fn times(&self, other: &Self) -> Self {
        let mut out = Self([Interval::ZERO; SIZE]);
        each!(i in 0..SIZE => {
            let mut j = 0;
            while i + j < SIZE {
                if !self.0[i].is_zero() && !other.0[j].is_zero() {
                    out.0[i + j] = out.0[i + j].add(self.0[i].mul(other.0[j]));
                }
                j += 1;
            }
        });
        out
    }

    /// Times `t^2`.
    const fn raised(&self) -> Self {
        let mut out = Self([Interval::ZERO; SIZE]);
        each!(k in 1..SIZE => {
            out.0[k] = self.0[k - 1];
        });
        out
    }

    /// Over `(1 + t^2)^degree`: with `t^2 = (1 - c)/(1 + c)` the power `k` is the Bernstein polynomial of
    /// `degree - k`, over its binomial coefficient.
    const fn in_bernstein(&self, degree: usize) -> Coefficients {
        let mut out = [Interval::ZERO; SIZE];
        each!(k in 0..=degree => {
            out[degree - k] = self.0[k].div(Interval::exact(binomial(degree, k)));
        });
        out
    }
}

/// The coefficient of `s^power` in `z^shift p(z) (1 - s)^degree`, that is in the sum of the
/// `p_i (1 + s)^(i + shift) (1 - s)^(degree - i - shift)`; rounded only at the end.
const fn in_tangent(p: &Polynomial, shift: usize, degree: usize, power: usize) -> Interval {
    let (mut low, mut high) = (ExactSum::<CAPACITY>::EMPTY, ExactSum::<CAPACITY>::EMPTY);
    each!(i in 0..p.len() => {
        let weight = krawtchouk(degree, i + shift, power);
        let c = p.coefficient(i);
        let (lo, hi) = if weight < 0.0 { (c.hi(), c.lo()) } else { (c.lo(), c.hi()) };
        low.add_product(lo, weight);
        high.add_product(hi, weight);
    });
    if low.is_finite && high.is_finite {
        Interval::new(low.rounded_down(), -high.negative_rounded_down())
    } else {
        Interval::ENTIRE
    }
}

/// Two parts of each of the products.
const CAPACITY: usize = 2 * SIZE;

/// The coefficient of `s^power` in `(1 + s)^i (1 - s)^(degree - i)`: a whole number of at most 16 bits.
const fn krawtchouk(degree: usize, i: usize, power: usize) -> f64 {
    let mut sum = 0.0;
    each!(m in 0..=power => {
        if m <= degree - i && power - m <= i {
            let term = binomial(degree - i, m) * binomial(i, power - m);
            sum += if m % 2 == 0 { term } else { -term };
        }
    });
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_that_comes_from_infinity_is_not_inside() {
        let about_zero = Interval::new(-1e-20, 1e-20);
        assert!(!has_all_roots_inside(&Polynomial::ascending(&[Interval::ONE, about_zero])));
        let near = Interval::new(1.0 - 1e-12, 1.0 + 1e-12);
        for (root, is_inside) in [(-0.5, true), (-0.999_999, true), (-1.0, false), (-2.0, false)] {
            let p = Polynomial::ascending(&[Interval::exact(root), near]);
            assert_eq!(has_all_roots_inside(&p), is_inside, "{root}");
        }
    }

    /// `1e300 - 1e300 + 1` and the like.
    #[test]
    fn coefficients_are_sums_without_rounding() {
        let p = Polynomial::descending(&[1e300, 1.0, -1e300, 0.25], false);
        assert_eq!(in_tangent(&p, 0, 3, 0), Interval::exact(1.25));
        // At z = -1: -1e300 + 1 + 1e300 + 0.25, the leading coefficient times -1 to the degree.
        assert_eq!(in_tangent(&p, 0, 3, 3), Interval::exact(-1.25));
    }
}
