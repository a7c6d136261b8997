//! Poles on the unit circle, where a Nyquist curve goes to infinity (equation 4).

use std::f64::consts::PI;

use haptic_servo::passivity::transfer::Transfer;
use nalgebra::{Complex, DMatrix};

use crate::response::Response;
use crate::stability::eigenvalues;

/// Distance from the unit circle below which a pole is drawn as lying on it: a picture cannot show the
/// difference. The certificate, which decides, is more exact.
const ON_CIRCLE: f64 = 1e-7;

/// Relative rounding error of a residue.
const ROUNDING: f64 = 1e-6;

/// A pole on the upper half of the unit circle; each has its mirror image on the lower half.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitCirclePole {
    /// Its angle in rad, from 0 to pi.
    pub theta: f64,
    /// `k = rho / z0` in N m s/rad of a simple pole. A positive `k` is passive: the curve closes through infinity
    /// on the right. `None`: more than one pole at the same place, which is never passive.
    pub k: Option<Complex<f64>>,
}

impl UnitCirclePole {
    /// Whether the pole meets the condition of equation 4.
    pub fn is_passive(&self) -> bool {
        self.residue().is_some_and(|residue| residue > 0.0)
    }

    /// Whether its way through infinity is drawn: the way around several poles at one place is longer than a
    /// picture's frame.
    pub fn is_simple(&self) -> bool {
        self.k.is_some()
    }

    /// The residue, if it is real: then the curve closes on the right or on the left, and otherwise askew.
    pub fn residue(&self) -> Option<f64> {
        self.k.filter(|k| k.im.abs() <= ROUNDING * k.norm()).map(|k| k.re)
    }
}

/// The poles of a transfer function on the upper half of the unit circle, by their angles.
pub fn poles(g: &Transfer) -> Vec<UnitCirclePole> {
    let mut found = Vec::new();
    let response = Response::new(*g);
    if g.ones < 0 {
        let rest = Response::new(Transfer { ones: g.ones + 1, ..*g });
        let k = rest.at(Complex::new(1.0, 0.0));
        found.push(pole(0.0, g.ones == -1, k));
    }
    if g.minus_ones < 0 {
        let rest = Response::new(Transfer { minus_ones: g.minus_ones + 1, ..*g });
        let k = -rest.at(Complex::new(-1.0, 0.0));
        found.push(pole(PI, g.minus_ones == -1, k));
    }
    for z in roots(g).into_iter().filter(|z| (z.norm() - 1.0).abs() < ON_CIRCLE && z.im >= 0.0) {
        let theta = z.arg();
        match found
            .iter_mut()
            .find(|found: &&mut UnitCirclePole| (found.theta - theta).abs() < 1e-5)
        {
            Some(known) => known.k = None,
            None => {
                // Outwards, where no other pole is near: (z / z0 - 1) G(z).
                let step = 1e-7;
                let k = response.at(z * (1.0 + step)) * step;
                found.push(pole(theta, true, k));
            }
        }
    }
    // A zero at the same place leaves no pole.
    found.retain(|pole| pole.k.is_none_or(|k| k.norm() != 0.0));
    found.sort_by(|a, b| a.theta.total_cmp(&b.theta));
    found
}

/// The number of poles outside of the unit circle, farther than those that count as lying on it.
pub fn outside(g: &Transfer) -> usize {
    roots(g).into_iter().filter(|z| z.norm() >= 1.0 + ON_CIRCLE).count()
}

fn pole(theta: f64, is_simple: bool, k: Complex<f64>) -> UnitCirclePole {
    UnitCirclePole { theta, k: is_simple.then_some(k) }
}

/// Roots of the denominator that is not factored: eigenvalues of its companion matrix.
fn roots(g: &Transfer) -> Vec<Complex<f64>> {
    let p = &g.denominator;
    let n = p.degree();
    if n == 0 || p.is_zero() {
        return Vec::new();
    }
    let leading = p.leading().midpoint();
    let companion = DMatrix::from_fn(n, n, |row, column| {
        if column == n - 1 {
            -p.coefficient(row).midpoint() / leading
        } else {
            f64::from(u8::from(row == column + 1))
        }
    });
    eigenvalues(&companion).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_servo::passivity::polynomial::Polynomial;

    fn ratio(numerator: &[f64], denominator: &[f64]) -> Transfer {
        let p = |c: &[f64]| Polynomial::descending(c, false);
        Transfer::new(p(numerator), p(denominator))
    }

    #[test]
    fn integrators_and_resonators() {
        // K T z / (z - 1) with K T = 0.5.
        let spring = Transfer { ones: -1, ..ratio(&[0.5, 0.0], &[1.0]) };
        let [pole] = poles(&spring)[..] else { panic!() };
        assert_eq!((pole.theta, pole.residue()), (0.0, Some(0.5)));
        assert!(pole.is_passive());
        let negative = Transfer { ones: -1, ..ratio(&[-0.5, 0.0], &[1.0]) };
        assert!(!poles(&negative)[0].is_passive());

        // 1 + j 0.1 times z0 / (z - z0), and its conjugate, at an angle of 1 rad.
        let (z0, k) = (Complex::from_polar(1.0, 1.0), Complex::new(1.0, 0.1));
        let numerator = [2.0 * (k * z0).re, -2.0 * k.re];
        let resonator = ratio(&numerator, &[1.0, -2.0 * z0.re, 1.0]);
        let [pole] = poles(&resonator)[..] else { panic!() };
        let found = pole.k.unwrap();
        assert!((pole.theta - 1.0).abs() < 1e-9 && (found - k).norm() < 1e-5, "{found}");
        assert!(!pole.is_passive() && pole.residue().is_none());

        let twice = Transfer { ones: -2, ..ratio(&[1.0], &[1.0]) };
        assert_eq!(poles(&twice)[0].k, None);
        // B (2 / T)(z - 1) / (z + 1) behind T z / (z - 1).
        let tustin = Transfer { minus_ones: -1, ..ratio(&[0.02, 0.0], &[1.0]) };
        let [pole] = poles(&tustin)[..] else { panic!() };
        assert_eq!((pole.theta, pole.residue()), (PI, Some(0.02)));
    }
}
