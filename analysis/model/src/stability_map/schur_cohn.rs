//! Whether a polynomial has all its roots inside the unit circle, without looking for them.

/// Schur-Cohn's test: a polynomial minus the multiple of its reverse that removes the constant coefficient
/// has, divided by `z`, one root less, and keeps the others inside, as long as the constant coefficient is
/// smaller in size than the leading one. `coefficients` has the highest power first, and is overwritten.
/// Roots on the circle or outside, and NaN, are not inside.
pub fn all_inside(coefficients: &mut [f64]) -> bool {
    let mut rest = coefficients;
    while let [leading, .., constant] = *rest {
        let reflection = constant / leading;
        // NaN does not pass either.
        let goes_on = reflection.abs() < 1.0;
        if !goes_on {
            return false;
        }
        let last = rest.len() - 1;
        for low in 0..rest.len() / 2 {
            let (a, b) = (rest[low], rest[last - low]);
            rest[low] = a - reflection * b;
            rest[last - low] = b - reflection * a;
        }
        if rest.len() % 2 == 1 {
            rest[last / 2] *= 1.0 - reflection;
        }
        rest = &mut rest[..last];
    }
    !rest.is_empty() && rest[0] != 0.0 && rest[0].is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of_roots(roots: &[f64], pairs: &[(f64, f64)]) -> Vec<f64> {
        let times = |p: Vec<f64>, q: &[f64]| {
            let mut product = vec![0.0; p.len() + q.len() - 1];
            for (i, a) in p.iter().enumerate() {
                q.iter().enumerate().for_each(|(j, b)| product[i + j] += a * b);
            }
            product
        };
        let p = roots.iter().fold(vec![2.5], |p, root| times(p, &[1.0, -root]));
        pairs.iter().fold(p, |p, (r, angle)| times(p, &[1.0, -2.0 * r * angle.cos(), r * r]))
    }

    proptest! {
        #[test]
        fn roots_tell(
            roots in prop::collection::vec(-1.2f64..1.2, 0..4),
            pairs in prop::collection::vec((0.0f64..1.2, 0.0f64..3.1), 0..3),
        ) {
            let radii = || roots.iter().copied().map(f64::abs).chain(pairs.iter().map(|p| p.0));
            // On the circle itself rounding decides.
            prop_assume!(radii().all(|radius| (radius - 1.0).abs() > 1e-3));
            let inside = radii().all(|radius| radius < 1.0);
            prop_assert_eq!(all_inside(&mut of_roots(&roots, &pairs)), inside);
        }
    }

    #[test]
    fn what_has_no_answer_is_not_inside() {
        assert!(all_inside(&mut [3.0]));
        assert!(!all_inside(&mut [1.0, -1.0]));
        assert!(!all_inside(&mut [0.0, 1.0]));
        assert!(!all_inside(&mut [f64::NAN, 1.0]));
        assert!(!all_inside(&mut [0.0]));
        assert!(!all_inside(&mut []));
    }
}
