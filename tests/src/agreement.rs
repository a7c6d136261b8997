//! Whether the firmware's assessment of a scene agrees with the exact reference.

use crate::exact::of_f64;
use crate::index::Index;
use crate::rules::{Exact, NoIndex};
use haptic_servo::certificate::{Assessment, RuleAnswer};
use haptic_servo::passivity::interval::Interval;
use std::cmp::Ordering;

/// What the firmware left open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Open {
    /// The paper's rule was undecided.
    pub paper: bool,
    /// The exact rule was undecided.
    pub exact: bool,
}

/// Compares everything that an assessment claims.
///
/// # Errors
/// The first claim that is false, in words.
pub fn check(assessment: &Assessment, exact: &Exact) -> Result<Open, String> {
    answers("paper", assessment.paper, exact.passes_paper())?;
    check_exact(assessment, exact)
}

/// Compares everything but the answer of the paper's rule.
///
/// # Errors
/// The first claim that is false, in words.
pub fn check_exact(assessment: &Assessment, exact: &Exact) -> Result<Open, String> {
    let alpha = exact.alpha().map_err(NoIndex::Defect);
    encloses("alpha", assessment.alpha, &alpha)?;
    encloses("alpha_coupled", assessment.alpha_coupled, &exact.alpha_coupled())?;
    let delta = assessment.delta;
    if delta.lo() > delta.hi() || !contains(delta, |x| of_f64(x).map(|x| exact.delta.cmp(&x))) {
        return Err(format!("delta {delta:?} does not contain {}", exact.delta));
    }
    answers("exact", assessment.exact, exact.passes_exact())?;
    if assessment.outcome.is_ok() && assessment.exact != RuleAnswer::Pass {
        return Err("certified without a pass of the exact rule".to_owned());
    }
    Ok(Open {
        paper: assessment.paper == RuleAnswer::Undecided,
        exact: assessment.exact == RuleAnswer::Undecided,
    })
}

fn answers(rule: &str, answer: RuleAnswer, truth: bool) -> Result<(), String> {
    match (answer, truth) {
        (RuleAnswer::Pass, false) => Err(format!("false pass of the {rule} rule")),
        (RuleAnswer::Fail, true) => Err(format!("false fail of the {rule} rule")),
        _ => Ok(()),
    }
}

fn encloses(
    what: &str,
    claim: Option<Interval>,
    truth: &Result<Index, NoIndex>,
) -> Result<(), String> {
    match (claim, truth) {
        (None, _) => Ok(()),
        (Some(interval), Err(why)) => Err(format!("{what} {interval:?} claimed, but {why:?}")),
        (Some(interval), Ok(index)) if interval.lo() > interval.hi() => {
            Err(format!("{what}: the ends of {interval:?} are reversed ({index:?})"))
        }
        (Some(interval), Ok(index)) => {
            if contains(interval, |x| of_f64(x).map(|x| index.compare(&x))) {
                Ok(())
            } else {
                Err(format!("{what} is outside {interval:?}"))
            }
        }
    }
}

/// Whether a value lies in an interval, given how it compares with a finite end (`None` if the end
/// is infinite, which excludes nothing; NaN excludes everything).
fn contains(interval: Interval, compare: impl Fn(f64) -> Option<Ordering>) -> bool {
    let (lo, hi) = (interval.lo(), interval.hi());
    !lo.is_nan()
        && !hi.is_nan()
        && compare(lo).map_or(lo == f64::NEG_INFINITY, |o| o != Ordering::Less)
        && compare(hi).map_or(hi == f64::INFINITY, |o| o != Ordering::Greater)
}

/// Relative width of an enclosure.
pub fn relative_width(interval: Interval) -> f64 {
    let size = interval.lo().abs().max(interval.hi().abs());
    if size == 0.0 { 0.0 } else { (interval.hi() - interval.lo()) / size }
}
