//! Methods for the certificate: their time, the error of their index, and the rates of false positives and
//! false negatives among ten thousand environments with known verdicts. A false positive is dangerous, a false
//! negative a loss, and an undecided verdict a loss that is known: these are never added.

pub mod environments;
pub mod index_methods;

pub(crate) mod polynomials;

use std::hint::black_box;

use rayon::prelude::*;

use super::{Axis, Comparison, Method, Tradeoff, fastest};
use crate::progress;
use crate::studies::failures::method_result::MethodVerdict;
use environments::{EACH, Environment, Kind, environment, reference_index};
use index_methods::{Grid, IndexMethod, IndexResult};

pub(crate) static COMPARISON: Comparison = Comparison {
    name: "certificate",
    title: "Certificate: ways to the index alpha and the verdict, on 2500 environments of each kind",
    cost: Axis::new("microseconds", "time of a verdict (microseconds)"),
    errors: &[
        // The indices are doubles with an error of at most one place.
        Axis::new("alpha_error", "error of alpha, 99 of 100 below it (part)")
            .floored(1e-15, "a double's last places"),
        Axis::new("wrong_yes", "not passive, and passed, of 2500").floored(0.5, "none"),
        Axis::new("wrong_no", "passive, and refused, of 2500").floored(0.5, "none"),
        Axis::new("open", "left undecided, of 2500").floored(0.5, "none"),
    ],
    others: &["median_error", "largest_error"],
    kept: include_bytes!("../../../../pictures/tradeoff/certificate.csv"),
};

/// Environments of each kind for the timing of a method.
const TIMED: usize = 25;
/// Rounds of the timing; the result is the fastest.
const ROUNDS: usize = 9;
/// Widths of enclosures, relative to the index.
const TOLERANCES: [f64; 5] = [1e-1, 1e-3, 1e-6, 1e-9, 1e-13];

#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub family: &'static str,
    pub name: String,
    pub method: IndexMethod,
}

/// All compared methods.
fn candidates() -> Vec<Candidate> {
    let one = |family, method| vec![Candidate { family, name: family.to_owned(), method }];
    let enclosure = |&tolerance: &f64| Candidate {
        family: "enclosure",
        name: format!("enclosure, {tolerance:e}"),
        method: IndexMethod::Enclosure(tolerance),
    };
    let grid = |is_logarithmic: bool| {
        move |power: u32| Candidate {
            family: if is_logarithmic { "logarithmic grid" } else { "even grid" },
            name: format!("{}grid, 1e{power}", if is_logarithmic { "log " } else { "" }),
            method: IndexMethod::Grid(Grid::new(10_usize.pow(power), is_logarithmic)),
        }
    };
    let mut all = one("closed form", IndexMethod::ClosedForm);
    all.extend(TOLERANCES.iter().map(enclosure));
    all.extend(one("decision", IndexMethod::Decision));
    all.extend((2..=5).map(grid(false)));
    all.extend((2..=4).map(grid(true)));
    all.extend(one("roots", IndexMethod::Roots));
    all
}

pub(crate) fn measure() -> Tradeoff {
    let all = candidates();
    let known = |kind| all.iter().filter(move |one| evaluated(&one.method, kind, 0).is_some());
    let steps = Kind::ALL.into_iter().map(|kind| known(kind).count()).sum::<usize>();
    let bar = progress::bar(steps as u64, "certificate");
    let mut methods = Vec::new();
    for kind in Kind::ALL {
        let posed: Vec<_> = (0..TIMED).map(|number| posed(kind, number)).collect();
        let work = |candidate: &'_ Candidate| {
            let (method, posed) = (candidate.method.clone(), &posed);
            move || {
                for (environment, delta) in posed {
                    black_box(method.evaluate(black_box(environment), *delta));
                }
            }
        };
        let times = fastest(ROUNDS, &mut known(kind).map(work).collect::<Vec<_>>());
        for (candidate, time) in known(kind).zip(times) {
            let errors = MethodErrors::of(&candidate.method, kind, 0..EACH);
            methods.push(errors.row(kind, candidate, 1e6 * time / TIMED as f64));
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Tradeoff { comparison: &COMPARISON, methods }
}

/// An environment with the passivity of its device.
fn posed(kind: Kind, number: usize) -> (Environment, f64) {
    let environment = environment(kind, number);
    let delta = environment.delta(reference_index(kind, number));
    (environment, delta)
}

fn evaluated(method: &IndexMethod, kind: Kind, number: usize) -> Option<IndexResult> {
    let (environment, delta) = posed(kind, number);
    method.evaluate(&environment, delta)
}

/// Errors of a method on many environments: numbers of false positives, of false negatives and of undecided
/// verdicts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MethodErrors {
    pub wrong_yes: usize,
    pub wrong_no: usize,
    pub open: usize,
    /// Relative errors of the index in order; infinite if an index exists and none was found. Empty for a
    /// method that does not compute an index.
    pub errors: Vec<f64>,
}

impl MethodErrors {
    pub fn of(method: &IndexMethod, kind: Kind, numbers: std::ops::Range<usize>) -> Self {
        let one = |number: usize| Some((number, evaluated(method, kind, number)?));
        let answers: Vec<_> = numbers.into_par_iter().filter_map(one).collect();
        let mut errors = Self::default();
        for (number, said) in answers {
            let (environment, truth) = (environment(kind, number), reference_index(kind, number));
            match (said.verdict, environment.is_passive(truth)) {
                (MethodVerdict::Safe, false) => errors.wrong_yes += 1,
                (MethodVerdict::Unsafe, true) => errors.wrong_no += 1,
                (MethodVerdict::Undecided, _) => errors.open += 1,
                _ => {}
            }
            let looks = !matches!(method, IndexMethod::Decision);
            errors.errors.extend(truth.filter(|_| looks).map(|truth| error(said.alpha, truth)));
        }
        errors.errors.sort_by(f64::total_cmp);
        errors
    }

    /// The error at a fraction of the environments.
    fn quantile(&self, part: f64) -> Option<f64> {
        let last = self.errors.len().checked_sub(1)?;
        self.errors.get((part * last as f64).ceil() as usize).copied()
    }

    fn row(&self, kind: Kind, candidate: &Candidate, microseconds: f64) -> Method {
        let count = |value: usize| Some(value as f64);
        let values = [
            Some(microseconds),
            self.quantile(0.99),
            count(self.wrong_yes),
            count(self.wrong_no),
            count(self.open),
            self.quantile(0.5),
            self.quantile(1.0),
        ];
        Method::new(kind.as_str(), candidate.family, &candidate.name, values)
    }
}

/// Distance of the farther bound from the index, over the index.
fn error(said: Option<(f64, f64)>, truth: f64) -> f64 {
    said.map_or(f64::INFINITY, |(lo, hi)| (lo - truth).abs().max((hi - truth).abs()) / truth.abs())
}

#[cfg(test)]
mod tests;
