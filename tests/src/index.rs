//! The passivity index of a rational environment, decided exactly (theory, sections 1 and 7).
//!
//! Poles on the unit circle are split off with their residues; the rest has a real part `p(c) / r(c)` on the
//! circle, `c` the cosine of the angle, `r > 0`. The index `alpha` is minus its least value, so
//! `alpha < lambda` is `p + lambda r > 0` on `[-1, 1]`, which Sturm's theorem answers for any rational
//! `lambda` without computing `alpha`.

use crate::exact::Q;
use crate::poly::Poly;
use crate::remainders::{is_schur, roots_inside};
use num_traits::{One, Signed, Zero};
use std::cmp::Ordering;

/// Why an environment has no index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defect {
    /// More zeros than poles: the output would precede the input.
    Improper,
    /// A pole outside the closed unit disk.
    UnstablePole,
    /// A repeated pole on the unit circle.
    RepeatedUnitPole,
    /// A pole on the circle whose residue does not point along the pole.
    ResidueAngle,
    /// A pole on the circle whose residue points against the pole.
    NegativeResidue,
}

impl Defect {
    /// The contract's reason code.
    pub fn code(self) -> &'static str {
        match self {
            Self::Improper => "improper",
            Self::UnstablePole => "unstable_pole",
            Self::RepeatedUnitPole => "repeated_unit_pole",
            Self::ResidueAngle => "residue_angle",
            Self::NegativeResidue => "negative_residue",
        }
    }
}

/// An index that exists.
#[derive(Clone, Debug)]
pub struct Index {
    real: Poly,
    norm: Poly,
}

impl Index {
    /// The index of `L = T z / (z - 1) * numerator / denominator`.
    ///
    /// # Errors
    /// Where the environment is not passive at any finite index.
    ///
    /// # Panics
    /// If `denominator` is zero.
    pub fn of(numerator: &Poly, denominator: &Poly, period: &Q) -> Result<Self, Defect> {
        if numerator.degree() > denominator.degree() {
            return Err(Defect::Improper);
        }
        if numerator.is_zero() {
            return Ok(Self { real: numerator.clone(), norm: Poly::integers(&[1]) });
        }
        let over = numerator.raised(1).scaled(period);
        let under = denominator.times(&Poly::integers(&[-1, 1]));
        let common = over.gcd(&under);
        let (over, under) = (over.divided(&common).0, under.divided(&common).0);
        let circle = under.gcd(&under.reversed());
        let inner = under.divided(&circle).0;
        if !is_schur(&inner) {
            return Err(Defect::UnstablePole);
        }
        let rest = without_circle_poles(&over, &inner, &circle)?;
        Ok(Self { real: real_part(&rest, &inner), norm: real_part(&inner, &inner) })
    }

    /// Where `alpha` lies relative to `lambda`.
    pub fn compare(&self, lambda: &Q) -> Ordering {
        let f = self.real.plus(&self.norm.scaled(lambda));
        if f.is_zero() {
            return Ordering::Equal;
        }
        if is_negative_somewhere(&f) {
            return Ordering::Greater;
        }
        let mut ends = ends(&f).into_iter();
        let touches = ends.any(|end| end.is_zero()) || roots_inside(&f) > 0;
        if touches { Ordering::Equal } else { Ordering::Less }
    }
}

/// Whether `f` is negative anywhere on `[-1, 1]`.
fn is_negative_somewhere(f: &Poly) -> bool {
    !f.is_zero() && (ends(f).iter().any(Signed::is_negative) || changes_sign(f))
}

fn ends(f: &Poly) -> [Q; 2] {
    [f.at(&Q::one()), f.at(&-Q::one())]
}

/// Whether `f` is negative anywhere in the open interval: a root of odd multiplicity there, or
/// none at all and a negative value.
fn changes_sign(f: &Poly) -> bool {
    let mut rest = f.clone();
    let mut sign_changing = Poly::integers(&[1]);
    // Yun: in each round `simple` are the roots of one multiplicity.
    let mut multiplicity = 1;
    while rest.degree() > 0 {
        let repeated = rest.gcd(&rest.derivative());
        let all = rest.divided(&repeated).0;
        let higher = repeated.gcd(&all);
        let simple = all.divided(&higher).0;
        if multiplicity % 2 == 1 {
            sign_changing = sign_changing.times(&simple);
        }
        (rest, multiplicity) = (repeated, multiplicity + 1);
    }
    roots_inside(&sign_changing) > 0 || is_negative_inside(f)
}

/// The sign of `f`, which changes no sign inside, at a point where it is not zero.
fn is_negative_inside(f: &Poly) -> bool {
    let points = (0..=i64::try_from(f.degree()).unwrap_or(i64::MAX))
        .map(|i| Q::new(1.into(), (i + 2).into()));
    let mut values = points.map(|x| f.at(&x));
    values.find(|v| !v.is_zero()).is_some_and(|v| v.is_negative())
}

/// `Re(P(z) / D(z)) |D|^2` on the circle, as a polynomial in the cosine.
fn real_part(p: &Poly, d: &Poly) -> Poly {
    let longest = p.degree().max(d.degree());
    let mut by_distance = vec![Q::zero(); longest + 1];
    for (i, a) in p.coefficients().iter().enumerate() {
        for (j, b) in d.coefficients().iter().enumerate() {
            by_distance[i.abs_diff(j)] += a * b;
        }
    }
    let terms = by_distance.iter().zip(chebyshev(longest));
    terms.fold(Poly::integers(&[]), |sum, (c, t)| sum.plus(&t.scaled(c)))
}

/// Chebyshev polynomials `T_0 ..= T_n`.
fn chebyshev(n: usize) -> Vec<Poly> {
    let mut all = vec![Poly::integers(&[1]), Poly::integers(&[0, 1])];
    for k in 2..=n {
        let twice = all[k - 1].raised(1).scaled(&Q::from_integer(2.into()));
        all.push(twice.plus(&all[k - 2].scaled(&-Q::one())));
    }
    all
}

/// The numerator over `inner` of `P / (inner circle)` less its circle poles. Each of those adds the
/// constant `-k / 2` to the real part, which is put back.
fn without_circle_poles(over: &Poly, inner: &Poly, circle: &Poly) -> Result<Poly, Defect> {
    if circle.degree() == 0 {
        return Ok(over.scaled(&(Q::one() / circle.leading())));
    }
    if circle.gcd(&circle.derivative()).degree() > 0 {
        return Err(Defect::RepeatedUnitPole);
    }
    let mut rest = over.clone();
    let mut constant = Q::zero();
    for (factor, cosine) in circle_factors(circle)? {
        let others = circle.divided(&factor).0.times(inner);
        let k = strength(over, &others, &factor, &cosine)?;
        // k z0 / (z - z0), or for a pair k (2 c z - 2) / (z^2 - 2 c z + 1).
        let pole = if factor.degree() == 1 {
            Poly::ascending(vec![cosine])
        } else {
            Poly::ascending(vec![Q::from_integer((-2).into()), cosine * Q::from_integer(2.into())])
        };
        constant += &k * Q::new(factor.degree().into(), 2.into());
        rest = rest.plus(&pole.times(&others).scaled(&-k));
    }
    let (rest, remainder) = rest.divided(circle);
    debug_assert!(remainder.is_zero(), "the circle poles are gone");
    Ok(rest.plus(&inner.scaled(&-constant)))
}

/// The factors of `circle` with the cosine of their angle: `z - 1`, `z + 1`, one complex pair.
fn circle_factors(circle: &Poly) -> Result<Vec<(Poly, Q)>, Defect> {
    let mut factors = Vec::new();
    let mut rest = circle.monic();
    for sign in [1, -1] {
        let factor = Poly::integers(&[-sign, 1]);
        let (without, count) = rest.without(&factor);
        if count > 0 {
            factors.push((factor, Q::from_integer(sign.into())));
        }
        rest = without;
    }
    if rest.degree() == 2 {
        let cosine = -&rest.coefficients()[1] / Q::from_integer(2.into());
        if cosine.abs() >= Q::one() {
            return Err(Defect::UnstablePole);
        }
        factors.push((rest, cosine));
    } else if rest.degree() > 0 {
        // Every factor is its own mirror image; only one pair is needed by any test here.
        unimplemented!("more than one pair of poles that mirror each other");
    }
    Ok(factors)
}

/// `k = rho / z0` of a pole: real and positive, or the defect. Numbers are `a + b w` with
/// `w^2 = c^2 - 1`, so that `z0 = c + w` is exact.
fn strength(over: &Poly, others: &Poly, factor: &Poly, cosine: &Q) -> Result<Q, Defect> {
    let square = cosine * cosine - Q::one();
    let times = |(a, b): &(Q, Q), (c, d): &(Q, Q)| (a * c + b * d * &square, a * d + b * c);
    let single = factor.degree() == 1;
    let z0 = (cosine.clone(), if single { Q::zero() } else { Q::one() });
    let at = |p: &Poly| {
        p.coefficients().iter().rev().fold((Q::zero(), Q::zero()), |sum, c| {
            let (a, b) = times(&sum, &z0);
            (a + c, b)
        })
    };
    // The other pole of a pair is z0's conjugate: z0 - z0* = 2 w.
    let apart = if single { (Q::one(), Q::zero()) } else { (Q::zero(), Q::from_integer(2.into())) };
    let under = times(&times(&at(others), &apart), &z0);
    let conjugate = (under.0.clone(), -under.1.clone());
    let k = times(&at(over), &conjugate);
    let norm = times(&under, &conjugate).0;
    match (k.1.is_zero(), k.0.is_positive()) {
        (false, _) => Err(Defect::ResidueAngle),
        (true, false) => Err(Defect::NegativeResidue),
        (true, true) => Ok(k.0 / norm),
    }
}
