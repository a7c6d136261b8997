//! Polynomial remainder sequences over the integers: common divisors, Sturm's theorem on the
//! number of real roots, and Routh's test, all from one subresultant sequence.

use crate::exact::Q;
use crate::poly::Poly;
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Signed, Zero};

/// Remainders of a pair of polynomials. Each is a *positive* multiple of the true remainder (or of
/// its negative, in a Sturm chain), so signs may be read from it.
pub struct Chain(Vec<Vec<BigInt>>);

impl Chain {
    /// Euclid's sequence of `a` and `b`, `b` not zero.
    pub fn of(a: &Poly, b: &Poly) -> Self {
        Self::run(integral(a), integral(b), false)
    }

    /// Sturm's sequence of `f`, which must not be constant.
    pub fn sturm(f: &Poly) -> Self {
        Self::run(integral(f), integral(&f.derivative()), true)
    }

    /// Collins' subresultant sequence: dividing by `beta` keeps the coefficients short, and its
    /// sign is dropped so that only positive factors are taken out.
    fn run(a: Vec<BigInt>, b: Vec<BigInt>, negate: bool) -> Self {
        let (a, b) = if !negate && a.len() < b.len() { (b, a) } else { (a, b) };
        let mut chain = vec![a, b];
        let mut psi = BigInt::one();
        loop {
            let [.., a, b] = chain.as_slice() else { unreachable!("two at least") };
            let gap = u32::try_from(a.len() - b.len()).unwrap_or(u32::MAX);
            let first = chain.len() == 2;
            let lead_a = a[a.len() - 1].abs();
            let mut next = pseudo_remainder(a, b);
            if next.is_empty() {
                return Self(chain);
            }
            let beta = if first { BigInt::one() } else { lead_a * psi.pow(gap) };
            let lead_b = b[b.len() - 1].abs();
            psi = if gap == 0 { psi } else { lead_b.pow(gap) / psi.pow(gap - 1) };
            for c in &mut next {
                debug_assert!((&*c % &beta).is_zero(), "subresultants divide exactly");
                *c /= &beta;
                if negate {
                    *c = -&*c;
                }
            }
            chain.push(next);
        }
    }

    /// The last one, which is the greatest common divisor.
    pub fn last(&self) -> Poly {
        let last = self.0.last().map_or(&[][..], Vec::as_slice);
        Poly::ascending(last.iter().cloned().map(Q::from_integer).collect())
    }

    /// Number of sign changes along the chain at a whole number `x`.
    pub fn variations(&self, x: i64) -> usize {
        let signs = self.0.iter().map(|p| value(p, x).signum()).filter(|s| !s.is_zero());
        let signs: Vec<BigInt> = signs.collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }

    /// Whether each remainder is one degree below the one before, down to a constant, with leading
    /// coefficients of one sign: the first column of Routh's array.
    pub fn is_routh_stable(&self) -> bool {
        let sign = |p: &Vec<BigInt>| p.last().map(BigInt::is_positive);
        self.0
            .windows(2)
            .all(|pair| pair[0].len() == pair[1].len() + 1 && sign(&pair[0]) == sign(&pair[1]))
            && self.0.last().is_some_and(|p| p.len() == 1)
    }
}

/// A positive multiple of `f` with whole coefficients that have no common divisor.
fn integral(f: &Poly) -> Vec<BigInt> {
    let denominator = f.coefficients().iter().fold(BigInt::one(), |d, c| d.lcm(c.denom()));
    let whole: Vec<BigInt> =
        f.coefficients().iter().map(|c| c.numer() * (&denominator / c.denom())).collect();
    let content = whole.iter().fold(BigInt::zero(), |g, c| g.gcd(c));
    if content.is_zero() { whole } else { whole.iter().map(|c| c / &content).collect() }
}

/// `|lead(b)|^(gap + 1) a mod b`.
fn pseudo_remainder(a: &[BigInt], b: &[BigInt]) -> Vec<BigInt> {
    let mut rest = a.to_vec();
    let lead = &b[b.len() - 1];
    for shift in (0..=a.len() - b.len()).rev() {
        let top = rest.pop().unwrap_or_else(BigInt::zero);
        let (scale, factor) = (lead.abs(), if lead.is_negative() { -top } else { top });
        for (i, c) in rest.iter_mut().enumerate() {
            *c *= &scale;
            if i >= shift {
                *c -= &factor * &b[i - shift];
            }
        }
    }
    while rest.last().is_some_and(Zero::is_zero) {
        rest.pop();
    }
    rest
}

fn value(p: &[BigInt], x: i64) -> BigInt {
    p.iter().rev().fold(BigInt::zero(), |sum, c| sum * x + c)
}

/// Number of different real roots of `f` in the open interval `(-1, 1)`.
pub fn roots_inside(f: &Poly) -> usize {
    let (f, _) = f.without(&Poly::integers(&[-1, 1]));
    let (f, _) = f.without(&Poly::integers(&[1, 1]));
    if f.degree() == 0 {
        return 0;
    }
    let chain = Chain::sturm(&f);
    chain.variations(-1) - chain.variations(1)
}

/// Whether every root of `f` lies strictly inside the unit circle. The disk is mapped to the left
/// half plane by `z = (1 + s) / (1 - s)`, where Routh decides.
pub fn is_schur(f: &Poly) -> bool {
    let (f, _) = f.without(&Poly::integers(&[0, 1]));
    let n = f.degree();
    if n == 0 {
        return true;
    }
    let mapped = f.coefficients().iter().enumerate().fold(Poly::integers(&[]), |sum, (i, c)| {
        sum.plus(&power(&[1, 1], i).times(&power(&[1, -1], n - i)).scaled(c))
    });
    mapped.degree() == n && is_hurwitz(&mapped)
}

/// Whether every root of `f` has a negative real part.
pub fn is_hurwitz(f: &Poly) -> bool {
    let n = f.degree();
    if n == 0 {
        return true;
    }
    let part = |parity: usize| {
        let keep = |(i, c): (usize, &Q)| if (n - i) % 2 == parity { c.clone() } else { Q::zero() };
        Poly::ascending(f.coefficients().iter().enumerate().map(keep).collect())
    };
    let odd = part(1);
    !odd.is_zero() && Chain::of(&part(0), &odd).is_routh_stable()
}

fn power(base: &[i64], n: usize) -> Poly {
    (0..n).fold(Poly::integers(&[1]), |p, _| p.times(&Poly::integers(base)))
}
