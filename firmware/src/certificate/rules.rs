//! The two rules: the paper's (equations 17 to 19) and the exact one (theory, section 4.1).

use super::model::{Numbers, nonlinear_bound, transfer};
use super::parameter::first_invalid;
use super::rejection::Rejection;
use super::remedy::Remedies;
use crate::environment::{Environment, Wall};
use crate::passivity::discrete::{RealPart, index};
use crate::passivity::interval::Interval;
use crate::passivity::poles::{Doubt, Obstacle, cancelled};
use crate::passivity::transfer::{Transfer, Unbuildable};
use crate::scene::Scene;

/// Answer of one rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Proved.
    Pass,
    /// Disproved, or outside what the rule covers.
    Fail,
    /// Neither; never means yes.
    Undecided,
}

/// Which rule the verdict follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Theory, section 4.1: linear scenes.
    Exact,
    /// Equations 17 to 19 with the nonlinear bound: one-sided or limited scenes.
    Nonlinear,
}

/// Everything that is known about a scene after judging it. Indices in N m s/rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessment {
    /// Index `alpha` of the environment alone; `None` where it does not exist.
    pub alpha: Option<Interval>,
    /// Index of `E'`, the environment that behind the standard coupling gives the same controller.
    pub alpha_coupled: Option<Interval>,
    /// Bound on the index that holds for one-sided and limited scenes; `None` for linear ones.
    pub bound: Option<Interval>,
    /// The device's passivity, scaled to the worst period.
    pub delta: Interval,
    /// Around the `cos(theta)` at which the linear index is reached; `[-1, 1]` where that is
    /// everywhere.
    pub cos_theta: Option<Interval>,
    /// Answer of equations 17 to 19.
    pub paper: Answer,
    /// Answer of theory, section 4.1.
    pub exact: Answer,
    /// Which of the two the verdict follows.
    pub rule: Rule,
    /// The verdict: `Ok` is `certified`.
    pub outcome: Result<(), Rejection>,
}

impl Assessment {
    /// The index that the verdict compared with `delta`.
    pub const fn deciding_index(&self) -> Option<Interval> {
        match self.rule {
            Rule::Exact => self.alpha_coupled,
            Rule::Nonlinear => self.bound,
        }
    }

    /// Damping in N m s/rad that is certainly to spare: `delta` less the deciding index. `None`
    /// where there is no index.
    pub const fn margin(&self) -> Option<f64> {
        match self.deciding_index() {
            Some(index) => Some(self.delta.sub(index).lo()),
            None => None,
        }
    }
}

/// Output strict passivity `gamma` of `Q` (equation 19) for a spring coupling:
/// `delta k / (delta - k)` with `k = K_vc T / 2`, for `k < delta`. At `k = delta` `Q` is zero and
/// `gamma` infinite; above, `Q` has none (`None`).
pub const fn gamma(stiffness: Interval, period: Interval, delta: Interval) -> Option<Interval> {
    let k = stiffness.mul(period).half();
    if delta.is_below(k) {
        return None;
    }
    let gamma = delta.mul(k).div(delta.sub(k));
    Some(if gamma.is_finite() { gamma } else { Interval::new(f64::MAX, f64::INFINITY) })
}

/// Judges a scene by both rules, without looking for remedies.
#[inline(never)]
pub const fn assess(scene: &Scene) -> Assessment {
    let rule = if is_nonlinear(scene) { Rule::Nonlinear } else { Rule::Exact };
    let mut out = Assessment {
        alpha: None,
        alpha_coupled: None,
        bound: None,
        delta: Interval::ENTIRE,
        cos_theta: None,
        paper: Answer::Fail,
        exact: Answer::Fail,
        rule,
        outcome: Ok(()),
    };
    if let Some(invalid) = first_invalid(scene) {
        out.outcome = Err(Rejection::Invalid(invalid));
        return out;
    }
    let numbers = Numbers::of(scene);
    out.delta = numbers.delta;
    out.outcome = judge(scene, &numbers, &mut out);
    out
}

/// Whether the scene is judged by the nonlinear bound.
pub(super) const fn is_nonlinear(scene: &Scene) -> bool {
    scene.torque_limit.is_some() || matches!(wall_of(&scene.environment), Some(w) if w.one_sided)
}

/// The wall of an environment, if it has one.
pub(super) const fn wall_of(environment: &Environment) -> Option<&Wall> {
    match environment {
        Environment::DelayedSpring(wall)
        | Environment::DamperWall(wall)
        | Environment::FreeModeWall { wall, .. } => Some(wall),
        Environment::FreeMode { .. } | Environment::Rational(_) => None,
    }
}

const fn judge(scene: &Scene, n: &Numbers, out: &mut Assessment) -> Result<(), Rejection> {
    if !n.delta.is_positive() {
        return Err(Rejection::NoPassivity { delta: n.delta });
    }
    let environment = match transfer(&scene.environment, n) {
        Ok(environment) => environment,
        Err(error) => return Err(unbuildable(error)),
    };
    let loop_gain = Interval::ONE.add(environment.feedthrough().mul(n.compliance()));
    let solvable = match out.rule {
        Rule::Exact => !loop_gain.contains(0.0),
        // A clipped or one-sided law has one solution with the coupling only if both slopes agree.
        Rule::Nonlinear => loop_gain.is_positive(),
    };
    if !solvable {
        out.paper = Answer::Fail;
        return Err(Rejection::IllPosed { loop_gain });
    }
    let alone = index(environment, n.period, true);
    if let Ok(found) = alone {
        out.alpha = Some(found.minimum);
        out.cos_theta = Some(found.cos_theta);
    }
    if matches!(out.rule, Rule::Nonlinear) {
        out.bound = nonlinear_bound(&scene.environment, n);
    }
    out.paper = paper_rule(n, &alone, out);
    let coupled = coupled_index(environment, n, &alone);
    if let Ok(found) = coupled {
        out.alpha_coupled = Some(found.minimum);
        if matches!(out.rule, Rule::Exact) {
            out.cos_theta = Some(found.cos_theta);
        }
    }
    out.exact = exact_rule(n, &coupled);
    match out.rule {
        Rule::Exact => exact_outcome(n, &alone, &coupled, out),
        Rule::Nonlinear => nonlinear_outcome(n, &alone, out),
    }
}

const fn unbuildable(error: Unbuildable) -> Rejection {
    match error {
        Unbuildable::Improper => Rejection::Improper,
        Unbuildable::IllPosed => Rejection::IllPosed { loop_gain: Interval::ZERO },
        Unbuildable::OutOfRange => Rejection::Undecided {
            doubt: Doubt::OutOfRange,
            index: None,
            limit: None,
            remedies: Remedies::NONE,
        },
    }
}

/// `K_vc T / 2` and `delta`, whichever is smaller: what the index has to stay below for the
/// coupling spring to be output strictly passive enough (condition 18). At the standard coupling
/// both are `delta`; a stiffness that equals it to the digits that were written, which may be a few
/// units of the last place above it, counts as standard.
const fn paper_limit(n: &Numbers, damping: Interval) -> Interval {
    n.delta.min(damping)
}

const fn paper_rule(n: &Numbers, alone: &Result<RealPart, Obstacle>, out: &Assessment) -> Answer {
    let Some(damping) = n.coupling_damping() else {
        // Without compliance Q is not passive (equation 19).
        return Answer::Fail;
    };
    if n.delta.is_below(damping) {
        return Answer::Fail;
    }
    let index = match (alone, out.rule, out.bound) {
        (Err(Obstacle::Undecided(_)), ..) => return Answer::Undecided,
        (Err(_), ..) => return Answer::Fail,
        (Ok(found), Rule::Exact, _) => found.minimum,
        (Ok(_), Rule::Nonlinear, Some(bound)) => bound,
        (Ok(_), Rule::Nonlinear, None) => return Answer::Undecided,
    };
    compare(index, paper_limit(n, damping))
}

const fn compare(index: Interval, limit: Interval) -> Answer {
    if index.is_below(limit) {
        Answer::Pass
    } else if index.lo() >= limit.hi() {
        Answer::Fail
    } else {
        Answer::Undecided
    }
}

/// What `alpha_coupled` has to stay below: `delta`; at the standard coupling also the `K_vc T / 2`
/// that equals it to the digits that were written.
const fn exact_limit(n: &Numbers) -> Interval {
    match n.coupling_damping() {
        Some(damping) if n.excess_compliance().contains(0.0) => paper_limit(n, damping),
        _ => n.delta,
    }
}

const fn coupled_index(
    environment: Transfer,
    n: &Numbers,
    alone: &Result<RealPart, Obstacle>,
) -> Result<RealPart, Obstacle> {
    let excess = n.excess_compliance();
    if excess.contains(0.0) {
        return *alone;
    }
    match cancelled(environment).behind(excess) {
        Ok(equivalent) => index(equivalent, n.period, false),
        Err(_) => Err(Obstacle::Undecided(Doubt::OutOfRange)),
    }
}

const fn exact_rule(n: &Numbers, coupled: &Result<RealPart, Obstacle>) -> Answer {
    match coupled {
        Ok(found) => compare(found.minimum, exact_limit(n)),
        Err(Obstacle::Undecided(_)) => Answer::Undecided,
        Err(_) => Answer::Fail,
    }
}

const fn exact_outcome(
    n: &Numbers,
    alone: &Result<RealPart, Obstacle>,
    coupled: &Result<RealPart, Obstacle>,
    out: &Assessment,
) -> Result<(), Rejection> {
    let limit = exact_limit(n);
    // An environment that would pass at the standard coupling: it is the coupling that fails.
    let blames_coupling = match alone {
        Ok(found) => found.minimum.is_below(n.delta),
        Err(_) => false,
    };
    match (coupled, alone) {
        (Ok(found), _) => match out.exact {
            Answer::Pass => Ok(()),
            Answer::Undecided => Err(Rejection::Undecided {
                doubt: Doubt::TooClose,
                index: Some(found.minimum),
                limit: Some(limit),
                remedies: Remedies::NONE,
            }),
            Answer::Fail if blames_coupling => Err(coupling_rejection(n, out)),
            Answer::Fail => Err(Rejection::Shortage {
                alpha: found.minimum,
                delta: limit,
                cos_theta: found.cos_theta,
                remedies: Remedies::NONE,
            }),
        },
        (Err(Obstacle::Undecided(doubt)), _) => Err(from_obstacle(Obstacle::Undecided(*doubt))),
        (Err(_), Ok(_)) if blames_coupling => Err(coupling_rejection(n, out)),
        (Err(_), Err(obstacle)) | (Err(obstacle), Ok(_)) => Err(from_obstacle(*obstacle)),
    }
}

const fn coupling_rejection(n: &Numbers, out: &Assessment) -> Rejection {
    let (alpha, alpha_coupled) = match out.rule {
        Rule::Exact => (out.alpha, out.alpha_coupled),
        Rule::Nonlinear => (out.bound, None),
    };
    Rejection::Coupling {
        alpha,
        alpha_coupled,
        delta: n.delta,
        stiffness: n.coupling,
        standard: n.delta.double().div(n.period),
        remedies: Remedies::NONE,
    }
}

const fn nonlinear_outcome(
    n: &Numbers,
    alone: &Result<RealPart, Obstacle>,
    out: &Assessment,
) -> Result<(), Rejection> {
    let found = match alone {
        Ok(found) => found,
        Err(obstacle) => return Err(from_obstacle(*obstacle)),
    };
    let Some(bound) = out.bound else {
        return Err(Rejection::Undecided {
            doubt: Doubt::NoNonlinearBound,
            index: Some(found.minimum),
            limit: Some(n.delta),
            remedies: Remedies::NONE,
        });
    };
    match out.paper {
        Answer::Pass => Ok(()),
        Answer::Undecided => Err(Rejection::Undecided {
            doubt: Doubt::TooClose,
            index: Some(bound),
            limit: Some(n.delta),
            remedies: Remedies::NONE,
        }),
        Answer::Fail if bound.is_below(n.delta) => Err(coupling_rejection(n, out)),
        Answer::Fail => Err(Rejection::Shortage {
            alpha: bound,
            delta: n.delta,
            cos_theta: found.cos_theta,
            remedies: Remedies::NONE,
        }),
    }
}

const fn from_obstacle(obstacle: Obstacle) -> Rejection {
    match obstacle {
        Obstacle::UnstablePole { reflection } => Rejection::UnstablePole { reflection },
        Obstacle::RepeatedUnitPole { cos_theta } => Rejection::RepeatedUnitPole { cos_theta },
        Obstacle::ResidueAngle { cos_theta } => Rejection::ResidueAngle { cos_theta },
        Obstacle::NegativeResidue { residue } => Rejection::NegativeResidue { residue },
        Obstacle::Undecided(doubt) => {
            Rejection::Undecided { doubt, index: None, limit: None, remedies: Remedies::NONE }
        }
    }
}
