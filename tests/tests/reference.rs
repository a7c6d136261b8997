//! The reference itself is judged by the published 34-digit values before it judges anything.

use num_traits::Signed;
use std::cmp::Ordering;
use tests::exact::{Q, power_of_ten};
use tests::index::Index;
use tests::vectors;

/// `alpha` to 34 digits: half a unit of the last digit on both sides.
fn agrees(index: &Index, alpha: &Q) -> bool {
    let step = power_of_ten(-33)
        * if alpha.abs() > Q::from_integer(1.into()) { power_of_ten(2) } else { power_of_ten(0) };
    index.compare(&(alpha + &step)) == Ordering::Less
        && index.compare(&(alpha - &step)) == Ordering::Greater
}

#[test]
fn the_reference_has_the_published_indices() {
    for case in vectors::all() {
        match (&case.alpha, case.loop_.alpha()) {
            (Some(alpha), Ok(index)) => assert!(agrees(&index, alpha), "{}: alpha", case.name),
            (None, Err(_)) => {}
            (a, b) => panic!("{}: alpha {a:?} against {b:?}", case.name),
        }
        match (&case.alpha_coupled, case.loop_.alpha_coupled()) {
            (Some(alpha), Ok(index)) => assert!(agrees(&index, alpha), "{}: coupled", case.name),
            (None, Err(_)) => {}
            (a, b) => panic!("{}: coupled alpha {a:?} against {b:?}", case.name),
        }
    }
}

#[test]
fn the_reference_has_the_published_verdicts() {
    for case in vectors::all() {
        assert_eq!(case.loop_.passes_paper(), case.paper, "{}: paper", case.name);
        assert_eq!(case.loop_.passes_exact(), case.exact, "{}: exact", case.name);
    }
}
