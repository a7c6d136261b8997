//! The reference itself is judged by the published 34-digit values before it judges anything.
//! Then it judges the answers that ways to the certificate are compared by.

use analysis::studies::tradeoff::certificate::environments::{
    EACH, Environment, Kind, PERIOD, environment, reference_index,
};
use analysis::studies::tradeoff::certificate::index_methods::IndexMethod;
use num_traits::Signed;
use std::cmp::Ordering;
use tests::exact::{Q, power_of_ten, q, ratio};
use tests::index::{Defect, Index};
use tests::poly::Poly;
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

fn index(environment: &Environment) -> Result<Index, Defect> {
    let denominator = Poly::of(&environment.denominator).raised(environment.delay);
    Index::of(&Poly::of(&environment.numerator), &denominator, &q(PERIOD))
}

/// The double next to an index, found by halving, from a guess that need not be good.
fn nearest(index: &Index, guess: f64) -> f64 {
    let is_above = |value: f64| index.compare(&q(value)) != Ordering::Greater;
    let mut reach = guess.abs() * f64::EPSILON + f64::MIN_POSITIVE;
    let (mut low, mut high) = loop {
        let (low, high) = (guess - reach, guess + reach);
        if is_above(high) && !is_above(low) {
            break (low, high);
        }
        reach *= 16.0;
    };
    loop {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            break;
        }
        if is_above(middle) { high = middle } else { low = middle }
    }
    let between = (q(low) + q(high)) / Q::from_integer(2.into());
    if index.compare(&between) == Ordering::Greater { high } else { low }
}

/// A guess at the index: the middle of the certificate's enclosure.
fn guess(environment: &Environment) -> f64 {
    let said = IndexMethod::Enclosure(0.0).evaluate(environment, 1.0).and_then(|said| said.alpha);
    said.map_or(0.0, |(lo, hi)| 0.5 * (lo + hi))
}

/// `ANSWERS=overwrite` finds all of them again, and takes its time.
#[test]
fn the_answers_that_ways_to_the_certificate_are_compared_by_are_exact() {
    let all = || Kind::ALL.into_iter().flat_map(|kind| (0..EACH).map(move |n| (kind, n)));
    if std::env::var_os("ANSWERS").is_some_and(|value| value == "overwrite") {
        let evaluated: Vec<_> = all().collect();
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let found = |part: &[(Kind, usize)]| -> Vec<u8> {
            let bytes = |&(kind, number): &(Kind, usize)| {
                let environment = environment(kind, number);
                let alpha = index(&environment).map(|index| nearest(&index, guess(&environment)));
                alpha.unwrap_or(f64::NAN).to_le_bytes()
            };
            part.iter().flat_map(bytes).collect()
        };
        let bytes: Vec<u8> = std::thread::scope(|scope| {
            let parts = evaluated.chunks(evaluated.len().div_ceil(cores));
            let threads: Vec<_> = parts.map(|part| scope.spawn(move || found(part))).collect();
            threads.into_iter().flat_map(|thread| thread.join().expect("found")).collect()
        });
        let file = "/../analysis/src/studies/tradeoff/certificate/indices.f64";
        std::fs::write([env!("CARGO_MANIFEST_DIR"), file].concat(), bytes).expect("written");
        return;
    }
    let mut without = 0;
    for (kind, number) in all().step_by(61) {
        let (index, kept) = (index(&environment(kind, number)), reference_index(kind, number));
        match (&index, kept) {
            (Ok(index), Some(alpha)) => {
                let alpha = q(alpha);
                let place = alpha.abs() * ratio(1, 1 << 52);
                let ends = [&alpha - &place, &alpha + &place].map(|end| index.compare(&end));
                assert_eq!(ends, [Ordering::Greater, Ordering::Less], "{kind:?} {number}");
            }
            (Err(_), None) => without += 1,
            _ => panic!("{kind:?} {number}: {index:?} is kept as {kept:?}"),
        }
    }
    assert!(without > 2, "{without}");
}
