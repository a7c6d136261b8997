//! The infimum of a ratio of two polynomials over the half line, enclosed without any rounding.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use super::exact::Polynomial;

/// Largest number of boxes that are examined: a chain of ten masses takes some hundreds.
const MAX_BOXES: usize = 20_000;
/// Largest number of halvings of one box.
const MAX_LEVEL: u32 = 160;

/// The infimum of `p(x) / r(x)` over `x >= 0`.
pub struct Infimum {
    pub lower: BigRational,
    pub upper: BigRational,
    /// The number at which it is reached; infinity: in the limit.
    pub minimizer: f64,
}

/// Encloses the infimum of `p(x) / r(x)` over all `x >= 0`, the limit at infinity included, to
/// within `tolerance` of that infimum. Neither polynomial may be negative anywhere; `r` is not zero
/// at 0 and of no lower degree than `p`.
///
/// With `x = w t/(1 - t)` the powers of `x` are Bernstein polynomials in `0 <= t <= 1`. Where all
/// coefficients `r_i` are positive, `p / r` is a convex mean of the `p_i / r_i`, so the smallest of
/// these is a lower bound; the values at a box's ends are upper bounds. Boxes are halved until both
/// meet, which is quadratic.
pub fn infimum(
    p: &Polynomial,
    r: &Polynomial,
    tolerance: impl Fn(&BigRational) -> BigRational,
) -> Infimum {
    let (degree, w) = (p.degree().max(r.degree()), scale(r));
    let root = Box::new(bernstein(p, degree, w), bernstein(r, degree, w), BigInt::zero(), 0);
    let (zero, infinity) = (root.value(0), root.value(degree));
    let mut best = if infinity < zero {
        (infinity.clone(), BigRational::one())
    } else {
        (zero.clone(), BigRational::zero())
    };
    let mut lower = best.0.clone();
    let (mut waiting, mut seen) = (vec![root], 0);
    while let Some(part) = waiting.pop() {
        seen += 1;
        let is_settled = &part.bound + tolerance(&best.0) >= best.0;
        if is_settled || seen > MAX_BOXES || part.level >= MAX_LEVEL {
            lower = lower.min(part.bound);
            continue;
        }
        let (left, right) = part.halved();
        if right.r[0].is_positive() && right.value(0) < best.0 {
            best = (right.value(0), right.left());
        }
        // The half with the smaller bound first: the other is then settled sooner.
        let ordered = if left.bound < right.bound { [right, left] } else { [left, right] };
        waiting.extend(ordered);
    }
    let reach = &best.0 + tolerance(&best.0);
    let minimizer = match (zero <= reach, infinity <= reach) {
        (true, _) => 0.0,
        (_, true) => f64::INFINITY,
        _ => critical_point(p, r, &best.1, w),
    };
    Infimum { lower, upper: best.0, minimizer }
}

/// A part of `0 <= t <= 1` with the Bernstein coefficients on it, all times one positive number.
struct Box {
    p: Vec<BigInt>,
    r: Vec<BigInt>,
    /// Left end in units of `2^-level`, its width.
    index: BigInt,
    level: u32,
    /// Lower bound of the ratio.
    bound: BigRational,
}

impl Box {
    fn new(p: Vec<BigInt>, r: Vec<BigInt>, index: BigInt, level: u32) -> Self {
        let ratios = p.iter().zip(&r).map(|(p, r)| BigRational::new_raw(p.clone(), r.clone()));
        let least = if r.iter().all(Signed::is_positive) { ratios.min() } else { None };
        let bound = least.unwrap_or_default().max(BigRational::zero());
        Self { p, r, index, level, bound }
    }

    fn value(&self, at: usize) -> BigRational {
        BigRational::new_raw(self.p[at].clone(), self.r[at].clone())
    }

    fn left(&self) -> BigRational {
        BigRational::new_raw(self.index.clone(), BigInt::one() << self.level)
    }

    fn halved(self) -> (Self, Self) {
        let (mut pl, mut pr) = halves(self.p);
        let (mut rl, mut rr) = halves(self.r);
        // Halving without fractions doubles everything; a common power of two is divided out.
        let mut all = [&mut pl, &mut pr, &mut rl, &mut rr];
        let twos = |part: &&mut Vec<BigInt>| part.iter().filter_map(BigInt::trailing_zeros).min();
        let common = all.iter().filter_map(twos).min().unwrap_or(0);
        for coefficient in all.iter_mut().flat_map(|part| part.iter_mut()) {
            *coefficient >>= common;
        }
        let (index, level) = (self.index * 2, self.level + 1);
        let next = &index + 1;
        (Self::new(pl, rl, index, level), Self::new(pr, rr, next, level))
    }
}

/// De Casteljau at the middle, both halves times `2^degree`.
fn halves(mut means: Vec<BigInt>) -> (Vec<BigInt>, Vec<BigInt>) {
    let degree = means.len() - 1;
    let (mut left, mut right) = (Vec::with_capacity(degree + 1), Vec::with_capacity(degree + 1));
    for step in 0..=degree {
        left.push(&means[0] << (degree - step));
        right.push(&means[degree - step] << (degree - step));
        for i in 0..degree - step {
            means[i] = &means[i] + &means[i + 1];
        }
    }
    right.reverse();
    (left, right)
}

/// Bernstein coefficients of `(1 - t)^degree p(w t/(1 - t))`, `w = 2^scale`, times a number that
/// depends on degree and scale alone and makes them whole.
fn bernstein(p: &Polynomial, degree: usize, scale: i64) -> Vec<BigInt> {
    let binomial = |i: usize| {
        (0..i)
            .fold(BigInt::one(), |value, k| value * BigInt::from(degree - k) / BigInt::from(k + 1))
    };
    // The product of all binomials is a common multiple, which is enough; the least one is smaller.
    let common = (0..=degree).map(binomial).product::<BigInt>();
    let coefficient = |i: usize| {
        let power = if scale < 0 { -scale * (degree - i) as i64 } else { scale * i as i64 };
        (p.coefficient(i) * &common / binomial(i)) << power as usize
    };
    (0..=degree).map(coefficient).collect()
}

/// The power of two that is nearest to the geometric mean of the roots' magnitudes.
fn scale(r: &Polynomial) -> i64 {
    let bits = |power: usize| r.coefficient(power).bits() as i64;
    (bits(0) - bits(r.degree())) / r.degree().max(1) as i64
}

/// The root of `p' r - p r'` nearest to `w t/(1 - t)`.
fn critical_point(p: &Polynomial, r: &Polynomial, t: &BigRational, scale: i64) -> f64 {
    let numerator = p.derivative().times(r);
    let slope = numerator.plus(&p.times(&r.derivative()).scaled(&BigInt::from(-1)));
    let sign = |x: f64| BigRational::from_float(x).map(|x| slope.at(&x));
    let falls = |x: f64| sign(x).is_some_and(|slope| slope.is_negative());
    let rises = |x: f64| sign(x).is_some_and(|slope| slope.is_positive());
    let t = t.to_f64().unwrap_or(0.5);
    let near = t / (1.0 - t) * (scale as f64).exp2();
    // The search stops where the ratio is flat, a little beside the root.
    let widths = (0..40).map(|step| 1e-12 * f64::from(step).exp2()).take_while(|&part| part < 0.5);
    let brackets = widths.map(|part| (near * (1.0 - part), near * (1.0 + part)));
    let bracket = brackets.into_iter().find(|&(low, high)| falls(low) && rises(high));
    let Some((mut low, mut high)) = bracket else { return near };
    while let middle = 0.5 * (low + high)
        && low < middle
        && middle < high
    {
        if falls(middle) { low = middle } else { high = middle }
    }
    high
}
