//! The two rules: the paper's (equations 17 to 19) and the exact one (theory, section 4.1).

use super::loop_intervals::LoopIntervals;
#[cfg(doc)]
use super::loop_intervals::Missed;
use crate::passivity::interval::Interval;

/// Answer of one rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum RuleAnswer {
    /// Proved.
    Pass,
    /// Disproved, or not covered by the rule.
    Fail,
    /// Neither; never counts as a pass.
    Undecided,
}

/// The rule that decides the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Theory, section 4.1: linear scenes.
    Exact,
    /// Equations 17 to 19 with the nonlinear bound, or without a coupling the index of a static law at the
    /// port: one-sided or limited scenes, and linear scenes beyond the exact rule.
    Nonlinear,
}

/// Output strict passivity `gamma` of `Q` (equation 19) for a spring coupling: `delta k / (delta - k)` with
/// `k = K_vc T / 2`, for `k < delta`. At `k = delta` `Q` is zero and `gamma` infinite; above, `Q` is not
/// passive (`None`).
pub const fn gamma(stiffness: Interval, period: Interval, delta: Interval) -> Option<Interval> {
    let k = stiffness.mul(period).half();
    if delta.is_below(k) {
        return None;
    }
    let gamma = delta.mul(k).div(delta.sub(k));
    Some(if gamma.is_finite() { gamma } else { Interval::new(f64::MAX, f64::INFINITY) })
}

/// Upper bound on the index by the paper's rule: `K_vc T / 2`, for the coupling spring to be output strictly
/// passive enough (condition 18), and `delta`. At the standard coupling both are `delta`; a stiffness equal
/// to it within the precision of its digits, which may be a few units of the last place above it, counts as
/// standard. `None` if the rule does not hold: above the standard coupling, and without compliance, `Q` is
/// not passive (equation 19).
///
/// If updates may be missed and torques are latched, [`Missed::limit`] must also hold.
///
/// Through a nonlinear encoder there is none, except where [`LoopIntervals::delta`] has what it leaves.
///
/// If torques lag, condition 18 applies to the coupling's excess over the matched one ([`crate::matched`]).
pub(super) const fn paper_limit(n: &LoopIntervals) -> Option<Interval> {
    if n.is_at_port {
        return Some(n.delta);
    }
    if !n.linearity.is_zero() {
        return None;
    }
    if let Some(lagging) = &n.latency {
        return lagging.limit;
    }
    match (n.coupling_damping(), &n.missed) {
        (Some(damping), _) if n.delta.is_below(damping) => None,
        (Some(damping), None) => Some(n.delta.min(damping)),
        (Some(damping), Some(missed)) => Some(n.delta.min(damping).min(missed.limit(damping))),
        (None, _) => None,
    }
}

pub(super) const fn compare(index: Interval, limit: Interval) -> RuleAnswer {
    if index.is_below(limit) {
        RuleAnswer::Pass
    } else if index.lo() >= limit.hi() {
        RuleAnswer::Fail
    } else {
        RuleAnswer::Undecided
    }
}

/// The upper bound on `alpha_coupled`: `delta`; at the standard coupling also `K_vc T / 2`, which equals
/// `delta` within the precision of its digits and the rounding of the compliance.
///
/// If torques lag, the index at the port must be below the passivity.
pub(super) const fn exact_limit(n: &LoopIntervals) -> Interval {
    match n.coupling_damping() {
        Some(damping) if n.is_standard && n.latency.is_none() => n.delta.min(damping),
        _ => n.delta,
    }
}
