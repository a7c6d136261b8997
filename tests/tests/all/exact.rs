//! The parts of the exact reference, on cases with known results. They are not tested beside their code,
//! where all of it would be compiled and linked once more.

use std::cmp::Ordering;

use num_traits::One;
use tests::exact::{Q, of_decimal, of_f64, ratio};
use tests::index::{Defect, Index};
use tests::poly::Poly;
use tests::remainders::{is_hurwitz, is_schur, roots_inside};

#[test]
fn decimals_are_exact() {
    assert_eq!(of_decimal("-0.0220").unwrap(), ratio(-11, 500));
    assert_eq!(of_decimal("25e-1").unwrap(), ratio(5, 2));
    assert_eq!(of_decimal("-0.5").unwrap(), ratio(-1, 2));
    assert!(of_decimal("1.2.3").is_none() && of_decimal("").is_none());
    assert_ne!(of_f64(0.1).unwrap(), ratio(1, 10));
}

fn from_roots(roots: &[Q]) -> Poly {
    roots
        .iter()
        .fold(Poly::integers(&[1]), |p, r| p.times(&Poly::ascending(vec![-r.clone(), Q::one()])))
}

#[test]
fn sturm_counts_different_roots() {
    let roots = [ratio(1, 3), ratio(1, 3), ratio(-1, 2), ratio(2, 1), ratio(1, 1), ratio(-1, 1)];
    assert_eq!(roots_inside(&from_roots(&roots)), 2);
    assert_eq!(roots_inside(&Poly::integers(&[1, 0, 1])), 0);
    assert_eq!(roots_inside(&Poly::integers(&[0, 0, -3, 0, 4])), 3);
}

#[test]
fn schur_is_strict() {
    assert!(is_schur(&from_roots(&[ratio(99, 100), ratio(-99, 100), ratio(0, 1)])));
    assert!(!is_schur(&from_roots(&[ratio(1, 1), ratio(1, 2)])));
    assert!(!is_schur(&from_roots(&[ratio(-101, 100), ratio(1, 2)])));
    assert!(is_schur(&Poly::integers(&[99, -100, 100])));
    assert!(!is_schur(&Poly::integers(&[101, -100, 100])));
    assert!(!is_schur(&Poly::integers(&[1, 0, 1])));
}

#[test]
fn hurwitz_is_strict() {
    assert!(is_hurwitz(&Poly::integers(&[6, 11, 6, 1])));
    assert!(is_hurwitz(&Poly::integers(&[-6, -11, -6, -1])));
    assert!(!is_hurwitz(&Poly::integers(&[6, 1, 6, 1])));
    assert!(!is_hurwitz(&Poly::integers(&[4, 0, 1])));
}

fn index(numerator: &[i64], denominator: &[i64]) -> Result<Index, Defect> {
    Index::of(&Poly::integers(numerator), &Poly::integers(denominator), &ratio(1, 1))
}

#[test]
fn delayed_springs_are_exactly_n_minus_a_half() {
    for n in 1..=8_i64 {
        let mut denominator = vec![0; usize::try_from(n).unwrap()];
        denominator.push(1);
        let index = index(&[3], &denominator).unwrap();
        let alpha = ratio(3 * (2 * n - 1), 2);
        assert_eq!(index.compare(&alpha), Ordering::Equal);
        assert_eq!(index.compare(&(&alpha + ratio(1, 1_000_000_000))), Ordering::Less);
        assert_eq!(index.compare(&(&alpha - ratio(1, 1_000_000_000))), Ordering::Greater);
    }
}

#[test]
fn an_interior_minimum_is_found() {
    // Wall, two samples, K T = 1/5, B = 3/10: alpha = 1/10 + 3/10 + (1/25)/(12/5).
    let index = index(&[-3, 5], &[0, 0, 0, 10]).unwrap();
    assert_eq!(index.compare(&(ratio(2, 5) + ratio(1, 60))), Ordering::Equal);
}

#[test]
fn defects_are_told_apart() {
    assert_eq!(index(&[0, 0, 1], &[1, 1]).unwrap_err(), Defect::Improper);
    assert_eq!(index(&[1], &[-2, 1]).unwrap_err(), Defect::UnstablePole);
    assert_eq!(index(&[1], &[2, -5, 2]).unwrap_err(), Defect::UnstablePole);
    assert_eq!(index(&[1], &[-1, 1]).unwrap_err(), Defect::RepeatedUnitPole);
    assert_eq!(index(&[-1], &[1]).unwrap_err(), Defect::NegativeResidue);
    assert_eq!(index(&[-1, 1], &[5, -6, 5]).unwrap_err(), Defect::ResidueAngle);
    assert_eq!(index(&[0, -1, 1], &[1]).unwrap_err(), Defect::Improper);
    let lossless = index(&[1, -1, -1, 1], &[0, 5, -6, 5]).unwrap();
    assert_eq!(lossless.compare(&ratio(0, 1)), Ordering::Equal);
}
