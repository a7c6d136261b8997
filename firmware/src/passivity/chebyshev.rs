//! Real parts on the unit circle as Chebyshev series in `c = cos(theta)` (theory, section 7, equation 32).
//!
//! With `n(z)`, `d(z)` real polynomials, `2 Re(K(z) n(z) conj(d(z)))` is a sum over the lags `m = i - j` of
//! the cross-correlation of their coefficients times `2 Re(K(z) z^m)`. For the kernels `K` of circle poles at
//! 1 and -1 this is a short sum of `T_k(c)` with integer coefficients, in which the pole itself has already
//! cancelled.

use super::interval::Interval;
use super::polynomial::{MAX_DEGREE, Polynomial};

const CAPACITY: usize = MAX_DEGREE + 2;

/// `sum of a_k T_k(c)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series {
    coefficients: [Interval; CAPACITY],
    len: usize,
}

/// The kernel `K(z)` in `2 Re(K(z) z^m)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// `1`.
    One,
    /// `z / (z - 1)`.
    AtOne,
    /// `1 / (z + 1)`.
    AtMinusOne,
    /// `z / (z^2 - 1)`.
    AtBoth,
}

impl Series {
    /// The zero series.
    pub const ZERO: Self = Self { coefficients: [Interval::ZERO; CAPACITY], len: 1 };

    /// A constant series.
    pub const fn constant(value: Interval) -> Self {
        Self::linear(value, Interval::ZERO)
    }

    /// `value + slope c`.
    pub const fn linear(value: Interval, slope: Interval) -> Self {
        let mut out = Self::ZERO;
        out.coefficients[0] = value;
        out.coefficients[1] = slope;
        out.len = if slope.is_zero() { 1 } else { 2 };
        out
    }

    /// `self + other`.
    pub const fn plus(&self, other: &Self) -> Self {
        let mut out = *self;
        out.len = if self.len > other.len { self.len } else { other.len };
        each!(k in 0..other.len => {
            out.coefficients[k] = out.coefficients[k].add(other.coefficients[k]);
        });
        out
    }

    /// `self - other`.
    pub const fn minus(&self, other: &Self) -> Self {
        self.plus(&other.scaled(Interval::ONE.neg()))
    }

    /// `factor self`.
    pub const fn scaled(&self, factor: Interval) -> Self {
        let mut out = *self;
        each!(k in 0..self.len => {
            out.coefficients[k] = self.coefficients[k].mul(factor);
        });
        out
    }

    /// `self other`, by `2 T_i T_j = T_(i+j) + T_|i-j|`; `None` beyond the capacity.
    #[inline(never)]
    pub const fn times(&self, other: &Self) -> Option<Self> {
        if self.len + other.len - 1 > CAPACITY {
            return None;
        }
        let mut out = Self::ZERO;
        out.len = self.len + other.len - 1;
        each!(i in 0..self.len => {
            each!(j in 0..other.len => {
                let half = self.coefficients[i].mul(other.coefficients[j]).half();
                out.coefficients[i + j] = out.coefficients[i + j].add(half);
                let apart = i.abs_diff(j);
                out.coefficients[apart] = out.coefficients[apart].add(half);
            });
        });
        Some(out)
    }

    /// The value at one `c`, by Clenshaw's recurrence.
    pub const fn at(&self, c: Interval) -> Interval {
        let (mut next, mut after) = (Interval::ZERO, Interval::ZERO);
        let mut k = self.len - 1;
        while k > 0 {
            (after, next) = (next, self.coefficients[k].add(c.double().mul(next)).sub(after));
            k -= 1;
        }
        self.coefficients[0].add(c.mul(next)).sub(after)
    }

    /// Coefficient of `T_k`.
    pub const fn coefficient(&self, k: usize) -> Interval {
        if k < self.len { self.coefficients[k] } else { Interval::ZERO }
    }

    /// Highest `k` whose coefficient may be nonzero.
    pub const fn degree(&self) -> usize {
        self.len - 1
    }

    const fn accumulate(&mut self, k: usize, weight: f64, value: Interval) {
        let term = value.mul(Interval::exact(weight));
        self.coefficients[k] = self.coefficients[k].add(term);
        if k >= self.len {
            self.len = k + 1;
        }
    }

    /// Adds `value * 2 Re(K(z) z^lag)`.
    const fn add_lag(&mut self, kernel: Kernel, lag: i32, value: Interval) {
        let m = lag.unsigned_abs() as usize;
        match kernel {
            Kernel::One => self.accumulate(m, 2.0, value),
            // cot(theta/2) sin(m theta) = 1 + 2 cos(theta) + ... + 2 cos((m-1) theta) + cos(m theta)
            Kernel::AtOne if lag >= 0 => self.add_dirichlet(m, value),
            Kernel::AtOne => self.add_dirichlet(m - 1, value.neg()),
            // The same with theta replaced by pi - theta.
            Kernel::AtMinusOne if lag > 0 => self.add_alternating(m - 1, m % 2 == 1, value),
            Kernel::AtMinusOne => self.add_alternating(m, m.is_multiple_of(2), value),
            // sin(m theta) / sin(theta)
            Kernel::AtBoth => {
                let value = if lag < 0 { value.neg() } else { value };
                let mut k = m;
                while k > 0 {
                    self.accumulate(k - 1, if k == 1 { 1.0 } else { 2.0 }, value);
                    k = k.saturating_sub(2);
                }
            }
        }
    }

    /// Adds `value (1 + 2 T_1 + ... + 2 T_n)`.
    const fn add_dirichlet(&mut self, n: usize, value: Interval) {
        each!(k in 0..=n => {
            self.accumulate(k, if k == 0 { 1.0 } else { 2.0 }, value);
        });
    }

    /// Adds `value (1 - 2 T_1 + 2 T_2 - ...)` up to `T_n`, or its negative.
    const fn add_alternating(&mut self, n: usize, positive: bool, value: Interval) {
        each!(k in 0..=n => {
            let sign = if (k % 2 == 0) == positive { 1.0 } else { -1.0 };
            self.accumulate(k, if k == 0 { sign } else { 2.0 * sign }, value);
        });
    }

    /// `2 Re(K(z) z^shift n(z) conj(d(z)))`; `None` if a lag is beyond the capacity.
    #[inline(never)]
    pub const fn real_part(
        kernel: Kernel,
        shift: i32,
        n: &Polynomial,
        d: &Polynomial,
    ) -> Option<Self> {
        let mut out = Self::ZERO;
        let (first, last) = (-(d.degree() as i32), n.degree() as i32);
        each!(lag in first..=last => {
            let moved = lag + shift;
            if moved.unsigned_abs() as usize >= CAPACITY {
                return None;
            }
            out.add_lag(kernel, moved, correlation(n, d, lag));
        });
        Some(out)
    }

    /// `abs(d(z))^2`.
    pub const fn squared_magnitude(d: &Polynomial) -> Self {
        let mut out = Self::ZERO;
        each!(lag in 0..d.len() => {
            out.accumulate(lag, if lag == 0 { 1.0 } else { 2.0 }, correlation(d, d, lag as i32));
        });
        out
    }

    /// Quotient and remainder by `2 (c - c0)`, Clenshaw's recurrence.
    pub const fn over_linear(&self, c0: Interval) -> (Self, Interval) {
        let mut quotient = Self::ZERO;
        let (mut next, mut after) = (Interval::ZERO, Interval::ZERO);
        let mut k = self.len - 1;
        while k > 0 {
            let b = self.coefficients[k].add(c0.double().mul(next)).sub(after);
            // p(c) - p(c0) = (c - c0) (b_1 + 2 b_2 T_1 + 2 b_3 T_2 + ...)
            quotient.coefficients[k - 1] = if k == 1 { b.half() } else { b };
            (after, next) = (next, b);
            k -= 1;
        }
        quotient.len = if self.len > 1 { self.len - 1 } else { 1 };
        (quotient, self.coefficients[0].add(c0.mul(next)).sub(after))
    }
}

/// Sum of `n_i d_j` over `i - j = lag`.
const fn correlation(n: &Polynomial, d: &Polynomial, lag: i32) -> Interval {
    let mut sum = Interval::ZERO;
    let mut j = if lag < 0 { (-lag) as usize } else { 0 };
    while j < d.len() {
        let i = (j as i32 + lag) as usize;
        if i >= n.len() {
            break;
        }
        sum = sum.add(n.coefficient(i).mul(d.coefficient(j)));
        j += 1;
    }
    sum
}

/// `A = sum g_m T_|m|(c)` and `B = sum g_m sign(m) U_{|m|-1}(c)` at one `c`: real part, and
/// imaginary part over `sin(theta)`, of `z^shift n(z) conj(d(z))`.
pub const fn at_cosine(
    c: Interval,
    shift: i32,
    n: &Polynomial,
    d: &Polynomial,
) -> (Interval, Interval) {
    let (mut real, mut imaginary) = (Interval::ZERO, Interval::ZERO);
    each!(lag in (-(d.degree() as i32))..=n.degree() as i32 => {
        let g = correlation(n, d, lag);
        let (t, u) = chebyshev_pair(c, (lag + shift).unsigned_abs());
        real = real.add(g.mul(t));
        let signed = if lag + shift < 0 { g.neg() } else { g };
        imaginary = imaginary.add(signed.mul(u));
    });
    (real, imaginary)
}

/// `T_m(c)` and `U_{m-1}(c)`.
const fn chebyshev_pair(c: Interval, m: u32) -> (Interval, Interval) {
    let (mut t, mut u) = (Interval::ONE, Interval::ZERO);
    each!(_step in 0..m => {
        // T_{k+1} = c T_k - (1 - c^2) U_{k-1}, U_k = c U_{k-1} + T_k
        let next_t = c.mul(t).sub(Interval::ONE.sub(c.mul(c)).mul(u));
        u = c.mul(u).add(t);
        t = next_t;
    });
    (t, u)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every kernel against complex arithmetic at points that are no special angles.
    #[test]
    fn lags_are_real_parts() {
        let n = Polynomial::descending(&[2.0, -3.0, 0.5, 1.0], false);
        let d = Polynomial::descending(&[1.0, 0.25, -0.5], false);
        for theta in [0.3f64, 1.1, 2.0, 2.9] {
            for shift in -4..4 {
                let z = |m: f64| ((m * theta).cos(), (m * theta).sin());
                let mul =
                    |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
                let inverse = |a: (f64, f64)| {
                    let s = a.0 * a.0 + a.1 * a.1;
                    (a.0 / s, -a.1 / s)
                };
                let mut g = (0.0, 0.0);
                for i in 0..n.len() {
                    for j in 0..d.len() {
                        let w = n.coefficient(i).lo() * d.coefficient(j).lo();
                        let e = z((i as i32 - j as i32 + shift) as f64);
                        g = (g.0 + w * e.0, g.1 + w * e.1);
                    }
                }
                let z1 = z(1.0);
                let z2 = z(2.0);
                for (kernel, k) in [
                    (Kernel::One, (1.0, 0.0)),
                    (Kernel::AtOne, mul(z1, inverse((z1.0 - 1.0, z1.1)))),
                    (Kernel::AtMinusOne, inverse((z1.0 + 1.0, z1.1))),
                    (Kernel::AtBoth, mul(z1, inverse((z2.0 - 1.0, z2.1)))),
                ] {
                    let series = Series::real_part(kernel, shift, &n, &d).unwrap();
                    let value: f64 = (0..=series.degree())
                        .map(|i| series.coefficient(i).midpoint() * (i as f64 * theta).cos())
                        .sum();
                    let wanted = 2.0 * mul(g, k).0;
                    assert!((value - wanted).abs() < 1e-12, "{kernel:?} {shift} {value} {wanted}");
                }
            }
        }
    }
}
