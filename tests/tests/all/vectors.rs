//! The published cases: verdicts under both rules, indices to 34 digits, reason codes.

use haptic_servo::certificate::{Assessment, RuleAnswer, assess};
use haptic_servo::passivity::interval::Interval;
use tests::agreement::relative_width;
use tests::exact::{Q, q};
use tests::vectors::{self, Case};

fn encloses(interval: Interval, value: &Q) -> bool {
    q(interval.lo()) <= *value && *value <= q(interval.hi())
}

/// The index is in its enclosure, which is narrow, and it is missing exactly where it should be.
fn check_index(case: &Case, what: &str, found: Option<Interval>, wanted: &Option<Q>) {
    match (found, wanted) {
        (Some(interval), Some(value)) => {
            assert!(encloses(interval, value), "{}: {what} {value} not in {interval:?}", case.name);
            let width = relative_width(interval);
            let limit = if *value == Q::from_integer(0.into()) { f64::INFINITY } else { 1e-9 };
            assert!(width <= limit, "{}: {what} is {width} wide", case.name);
            let size = interval.lo().abs().max(interval.hi().abs());
            assert!(limit < 1.0 || size <= 1e-9, "{}: {what} {interval:?} is not zero", case.name);
        }
        (None, None) => {}
        other => panic!("{}: {what} {other:?}", case.name),
    }
}

fn check_answer(case: &Case, rule: &str, found: RuleAnswer, passes: bool) {
    if case.is_on_the_line() {
        assert_ne!(found, RuleAnswer::Pass, "{}: {rule}, alpha equals delta", case.name);
    } else {
        let wanted = if passes { RuleAnswer::Pass } else { RuleAnswer::Fail };
        assert_eq!(found, wanted, "{}: {rule}", case.name);
    }
}

/// The contract's reason codes that may be given for a case.
fn codes(case: &Case) -> &'static [&'static str] {
    let reason = case.reason.as_str();
    if case.is_on_the_line() {
        return &["shortage", "undecided"];
    }
    if case.exact {
        return &["ok"];
    }
    match reason {
        _ if reason.starts_with("alpha_min >=") => &["shortage"],
        _ if reason.contains("angle") => &["residue_angle"],
        // Real and negative, but not a spring: both words describe it.
        _ if reason.contains("at z=-1") => &["residue_angle", "negative_residue"],
        _ if reason.starts_with("residue") => &["negative_residue"],
        _ if reason.starts_with("repeated") => &["repeated_unit_pole"],
        _ if reason.starts_with("pole outside") => &["unstable_pole"],
        _ if reason.starts_with("improper") => &["improper"],
        other => panic!("{}: what code is {other:?}?", case.name),
    }
}

fn code(assessment: &Assessment) -> &'static str {
    match &assessment.outcome {
        Ok(()) => "ok",
        Err(rejection) => rejection.reason(),
    }
}

#[test]
fn every_index_answer_and_reason_is_right() {
    for case in vectors::all() {
        let assessment = assess(&case.scene());
        check_index(&case, "alpha", assessment.alpha, &case.alpha);
        check_index(&case, "alpha_coupled", assessment.alpha_coupled, &case.alpha_coupled);
        check_answer(&case, "paper", assessment.paper, case.paper);
        check_answer(&case, "exact", assessment.exact, case.exact);
        let passes = assessment.exact == RuleAnswer::Pass;
        assert_eq!(assessment.outcome.is_ok(), passes, "{}", case.name);
        let code = code(&assessment);
        assert!(codes(&case).contains(&code), "{}: reason {code}, {}", case.name, case.reason);
    }
}
