//! Passivity of functions of `s` (theory, section 1): functions that are positive real by construction,
//! functions that are not, and random functions against the exact reference.
//!
//! A wrong image of the axis, a pole at infinity taken for a zero, a residue that is not carried
//! over: each turns a mass into a non-passive element or a negative spring into a passive one.

use haptic_servo::passivity::interval::Interval;
use haptic_servo::passivity::poles::IndexError;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::cmp::Ordering;
use tests::exact::of_f64;
use tests::index::Index;
use tests::poly::Poly;
use tests::scenes::{log_uniform, short};
use transfer::{ContinuousTransfer, input_passivity_of, output_passivity_of};

mod transfer;

/// Descending coefficients.
type Fraction = (Vec<f64>, Vec<f64>);

fn least((over, under): &Fraction) -> Result<Interval, IndexError> {
    input_passivity_of(ContinuousTransfer::new(over, under)).map(|found| found.minimum)
}

fn exact(coefficients: &[f64]) -> Poly {
    let all: Vec<_> = coefficients.iter().map(|&c| of_f64(c).expect("finite")).collect();
    Poly::descending(&all)
}

fn times(p: &[f64], factor: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; p.len() + factor.len() - 1];
    for (i, a) in p.iter().enumerate() {
        for (k, b) in factor.iter().enumerate() {
            product[i + k] += a * b;
        }
    }
    product
}

fn plus(a: &[f64], b: &[f64]) -> Vec<f64> {
    let n = a.len().max(b.len());
    let at = |p: &[f64], i: usize| if i + p.len() >= n { p[i + p.len() - n] } else { 0.0 };
    (0..n).map(|i| at(a, i) + at(b, i)).collect()
}

/// A ladder of springs, masses and dampers, from velocity to force: alternately something in
/// series and something in parallel, `Z -> 1 / (1/Z + element)`.
fn ladder(rng: &mut ChaCha8Rng, rungs: usize, smallest: f64) -> Fraction {
    let mut element = |lo: f64| short(log_uniform(rng, lo.max(0.25), 8.0), 3);
    // Small whole multiples of 1/8, so that every product below is exact.
    let (mut over, mut under) = (vec![element(0.25), element(smallest)], vec![1.0]);
    for _ in 0..rungs {
        std::mem::swap(&mut over, &mut under);
        over = plus(&over, &times(&under, &[element(0.25), element(smallest)]));
    }
    (over, under)
}

#[test]
fn ladders_are_positive_real() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for _ in 0..300 {
        let rungs = rng.random_range(0..4);
        let fraction = ladder(&mut rng, rungs, 0.25);
        let least = least(&fraction).unwrap_or_else(|why| panic!("{fraction:?}: {why:?}"));
        assert!(least.hi() > 0.0, "{fraction:?}: {least:?}");
        // Every element is damped, so the whole is strictly passive both ways.
        let inverse = ContinuousTransfer::new(&fraction.0, &fraction.1).inverse();
        let back =
            output_passivity_of(inverse).unwrap_or_else(|why| panic!("{fraction:?}: {why:?}"));
        assert!(back.minimum.hi() > 0.0, "{fraction:?}: {back:?}");
    }
}

#[test]
fn a_negative_element_is_seen() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    for _ in 0..300 {
        let rungs = rng.random_range(0..3);
        let (over, under) = ladder(&mut rng, rungs, 0.25);
        // A damper in series that takes more than the least resistance anywhere.
        let least_real = least(&(over.clone(), under.clone())).expect("a ladder is passive");
        let excess = short(-(least_real.hi() + 0.5), 3);
        let spoilt = (plus(&over, &times(&under, &[excess])), under);
        let least = least(&spoilt).unwrap_or_else(|why| panic!("{spoilt:?}: {why:?}"));
        assert!(least.is_negative(), "{spoilt:?}: {least:?}");
    }
}

#[test]
fn random_functions_agree_with_the_reference() {
    let mut rng = ChaCha8Rng::seed_from_u64(23);
    let (mut stable, mut unstable, mut open) = (0, 0, 0);
    for _ in 0..600 {
        let degree = rng.random_range(1..=6);
        let mut draw =
            |n| -> Vec<f64> { (0..=n).map(|_| short(rng.random_range(-4.0..4.0), 6)).collect() };
        let (over, mut under) = (draw(degree), draw(degree));
        if rng.random_bool(0.7) {
            // A product of stable factors instead.
            under = vec![1.0];
            while under.len() < over.len() {
                let (a, b) =
                    (short(rng.random_range(0.02..3.0), 6), short(rng.random_range(0.02..9.0), 6));
                let pair = under.len() + 2 <= over.len() && rng.random_bool(0.7);
                under = times(&under, if pair { vec![1.0, a, b] } else { vec![1.0, b] }.as_slice());
            }
            under.iter_mut().for_each(|c| *c = short(*c, 20));
        }
        if over[0] == 0.0 || under[0] == 0.0 {
            continue;
        }
        let fraction = (over, under);
        let found = least(&fraction);
        match (Index::continuous(&exact(&fraction.0), &exact(&fraction.1)), found) {
            (Some(index), Ok(least)) => {
                let at = |x: f64| index.compare(&of_f64(-x).expect("finite"));
                assert_ne!(at(least.lo()), Ordering::Greater, "{fraction:?}: {least:?}");
                assert_ne!(at(least.hi()), Ordering::Less, "{fraction:?}: {least:?}");
                stable += 1;
            }
            (None, Ok(least)) => panic!("{fraction:?} is unstable, but {least:?}"),
            (Some(_), Err(IndexError::Undecided(_))) => open += 1,
            (Some(_), Err(why)) => panic!("{fraction:?} is stable, but {why:?}"),
            (None, Err(_)) => unstable += 1,
        }
    }
    println!("stable={stable} unstable={unstable} undecided={open}");
    assert!(stable > 200 && unstable > 50 && open * 50 < stable, "{stable} {unstable} {open}");
}

fn contains(fraction: Fraction, value: f64) {
    let least = least(&fraction).unwrap_or_else(|why| panic!("{fraction:?}: {why:?}"));
    let width = least.hi() - least.lo();
    assert!(least.contains(value) && width <= 1e-9, "{fraction:?}: {least:?} for {value}");
}

#[test]
fn elements_are_what_they_are() {
    for x in [0.022, 1.0, 44.0, 1e-5, 2e6] {
        contains((vec![x], vec![1.0]), x);
        contains((vec![-x], vec![1.0]), -x);
        contains((vec![x], vec![1.0, 0.0]), 0.0);
        contains((vec![x, 0.0], vec![1.0]), 0.0);
        contains((vec![x, 0.25, x], vec![1.0, 0.0]), 0.25);
        let negative_spring = least(&(vec![-x], vec![1.0, 0.0]));
        assert!(matches!(negative_spring, Err(IndexError::NegativeResidue { .. })));
        // A negative mass has a pole at infinity with a negative residue.
        let negative_mass = least(&(vec![-x, 0.0], vec![1.0]));
        assert!(negative_mass.is_err(), "{negative_mass:?}");
        let twice = least(&(vec![x], vec![1.0, 0.0, 0.0]));
        assert!(matches!(twice, Err(IndexError::RepeatedUnitPole { .. })), "{twice:?}");
        let angle = least(&(vec![x], vec![1.0, 0.0, 1.0]));
        assert!(matches!(angle, Err(IndexError::ResidueAngle { .. })), "{angle:?}");
    }
    // A lossless resonator is recognised where its numbers are short enough to stay exact.
    for x in [0.5, 1.0, 44.0] {
        contains((vec![x, 0.0], vec![1.0, 0.0, 1.0]), 0.0);
    }
}

/// Equation 22: what the continuous free mode needs is what it cancels.
#[test]
fn the_free_mode_needs_what_it_cancels() {
    let mut rng = ChaCha8Rng::seed_from_u64(24);
    for _ in 0..200 {
        let (b, period) = (log_uniform(&mut rng, 1e-3, 1e1), log_uniform(&mut rng, 1e-4, 1e-2));
        let cancelled = b * rng.random_range(0.01..0.99);
        let e = ContinuousTransfer::free_mode(
            Interval::exact(b),
            Interval::exact(cancelled),
            Interval::exact(period),
        );
        let found = input_passivity_of(e.of_velocity()).expect("its pole is stable").minimum;
        assert!(found.contains(-cancelled), "{found:?} for {cancelled}");
    }
}
