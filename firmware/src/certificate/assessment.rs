//! What both rules say of a scene, with the numbers behind the answers.

use super::loop_intervals::LoopIntervals;
use super::problem::PassivityProblem;
use super::rejection::Rejection;
use super::remedy::Remedies;
use super::rules::{Rule, RuleAnswer, exact_limit, is_nonlinear, paper_limit};
use super::validity::first_invalid;
use crate::number::Format;
use crate::passivity::bernstein::Precision;
use crate::passivity::discrete::RealPart;
use crate::passivity::interval::Interval;
use crate::passivity::poles::{IndexError, UndecidedReason};
use crate::scene::Scene;

/// Everything that is known about a scene after judging it. Indices in N m s/rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessment {
    /// Index `alpha` of the environment alone; `None` where it does not exist.
    pub alpha: Option<Interval>,
    /// Index of `E'`, the environment that behind the standard coupling gives the same controller.
    pub alpha_coupled: Option<Interval>,
    /// Index at the device's port with delay, lag and sensor (equation 38): the least passivity of a
    /// device that would be enough. `None` where the scene has none of them, where the index does not
    /// exist, and where only the verdict was asked for.
    pub alpha_port: Option<Interval>,
    /// Bound on the index that holds for one-sided and limited scenes; `None` for linear ones.
    pub bound: Option<Interval>,
    /// The device's passivity, scaled to the worst period.
    pub delta: Interval,
    /// Around the `cos(theta)` at which the linear index is reached; `[-1, 1]` where that is
    /// everywhere.
    pub cos_theta: Option<Interval>,
    /// Answer of equations 17 to 19.
    pub paper: RuleAnswer,
    /// Answer of theory, section 4.1.
    pub exact: RuleAnswer,
    /// Which of the two the verdict follows.
    pub rule: Rule,
    /// The number format whose coefficients were judged.
    pub format: Format,
    /// The verdict: `Ok` is `certified`.
    pub outcome: Result<(), Rejection>,
}

impl Assessment {
    /// The index that the verdict compared with `delta`.
    pub const fn deciding_index(&self) -> Option<Interval> {
        match self.rule {
            Rule::Exact => match self.alpha_port {
                Some(index) => Some(index),
                None => self.alpha_coupled,
            },
            Rule::Nonlinear => self.bound,
        }
    }
}

/// Judges a scene as it was written by both rules, without looking for remedies.
pub const fn assess(scene: &Scene) -> Assessment {
    assess_in(scene, Format::F64)
}

/// Judges the coefficients that a servo in this number format multiplies by, without looking for
/// remedies.
pub const fn assess_in(scene: &Scene, format: Format) -> Assessment {
    assessed(scene, format, Extent::BothRules)
}

/// How much is found out about a scene.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    /// The answers of both rules.
    BothRules,
    /// Of a rejected scene, and of one whose torques lag and are limited, only the result of its own rule;
    /// of one whose torques lag, no more of the index than proves it.
    OwnRule,
}

#[inline(never)]
pub(super) const fn assessed(scene: &Scene, format: Format, extent: Extent) -> Assessment {
    let rule = if is_nonlinear(scene) { Rule::Nonlinear } else { Rule::Exact };
    let mut out = Assessment {
        alpha: None,
        alpha_coupled: None,
        alpha_port: None,
        bound: None,
        delta: Interval::ENTIRE,
        cos_theta: None,
        paper: RuleAnswer::Fail,
        exact: RuleAnswer::Fail,
        rule,
        format,
        outcome: Ok(()),
    };
    if let Some(invalid) = first_invalid(scene) {
        out.outcome = Err(Rejection::Invalid(invalid));
        return out;
    }
    let numbers = LoopIntervals::of(scene, format);
    out.delta = numbers.delta;
    // By reference: moved out of the result, the scene would be on a small board's stack twice.
    out.outcome = match &PassivityProblem::with(scene, numbers) {
        Ok(posed) => judge(posed, extent, &mut out),
        Err(rejection) => Err(*rejection),
    };
    out
}

const fn judge(
    posed: &PassivityProblem,
    extent: Extent,
    out: &mut Assessment,
) -> Result<(), Rejection> {
    let n = &posed.numbers;
    let alone = posed.alone(&Precision::TIGHT);
    if let Ok(found) = alone {
        out.alpha = Some(found.minimum);
        out.cos_theta = Some(found.cos_theta);
    }
    out.bound = posed.bound;
    out.paper = posed.paper(&alone);
    let is_refused = matches!(out.rule, Rule::Nonlinear) && !matches!(out.paper, RuleAnswer::Pass);
    if is_refused && matches!(extent, Extent::OwnRule) {
        return nonlinear_outcome(n, &alone, out);
    }
    // What lags and is limited is certified by then, and the other rule takes the stack of a small board.
    if is_lagging_and_limited(out, n) && matches!(extent, Extent::OwnRule) {
        out.exact = RuleAnswer::Undecided;
        return nonlinear_outcome(n, &alone, out);
    }
    let coupled = if n.latency.is_some() && matches!(extent, Extent::BothRules) {
        out.alpha_coupled = posed.coupled_without_latency();
        match posed.over_cells(&Precision::TIGHT, true) {
            Ok((found, needed)) => {
                out.alpha_port = Some(needed);
                Ok(found)
            }
            Err(error) => Err(error),
        }
    } else if n.latency.is_some() {
        posed.coupled_unless_clear()
    } else {
        posed.coupled(Some(alone), &Precision::TIGHT)
    };
    if let Ok(found) = coupled {
        if n.latency.is_none() {
            out.alpha_coupled = Some(found.minimum);
        }
        if matches!(out.rule, Rule::Exact) {
            out.cos_theta = Some(found.cos_theta);
        }
    }
    out.exact = posed.exact(&coupled);
    match out.rule {
        Rule::Exact => exact_outcome(posed, &alone, &coupled, out),
        Rule::Nonlinear => nonlinear_outcome(n, &alone, out),
    }
}

const fn is_lagging_and_limited(out: &Assessment, n: &LoopIntervals) -> bool {
    matches!(out.rule, Rule::Nonlinear) && n.latency.is_some()
}

const fn exact_outcome(
    posed: &PassivityProblem,
    alone: &Result<RealPart, IndexError>,
    coupled: &Result<RealPart, IndexError>,
    out: &Assessment,
) -> Result<(), Rejection> {
    let n = &posed.numbers;
    let limit = exact_limit(n);
    // An environment that would pass at the standard coupling: it is the coupling that fails, unless
    // torques lag.
    let blames_coupling = match alone {
        Ok(found) => n.latency.is_none() && found.minimum.is_below(n.delta),
        Err(_) => false,
    };
    match (coupled, alone) {
        (Ok(found), _) => match out.exact {
            RuleAnswer::Pass => Ok(()),
            RuleAnswer::Undecided => Err(Rejection::Undecided {
                doubt: UndecidedReason::TooClose,
                index: Some(found.minimum),
                limit: Some(limit),
                remedies: Remedies::NONE,
            }),
            RuleAnswer::Fail if blames_coupling && n.missed.is_some() => {
                Err(missed_rejection(found.minimum, limit))
            }
            RuleAnswer::Fail if blames_coupling => Err(coupling_rejection(n, out)),
            RuleAnswer::Fail => Err(Rejection::Shortage {
                // What the device lacks where torques lag, rather than what fails for this one.
                alpha: match out.alpha_port {
                    Some(needed) => needed,
                    None if n.latency.is_some() => match posed.port_needed() {
                        Ok(needed) => needed,
                        Err(_) => found.minimum,
                    },
                    None => found.minimum,
                },
                delta: limit,
                cos_theta: found.cos_theta,
                remedies: Remedies::NONE,
            }),
        },
        (Err(IndexError::Undecided(doubt)), _) => Err(from_obstacle(IndexError::Undecided(*doubt))),
        (Err(_), Ok(_)) if blames_coupling => Err(coupling_rejection(n, out)),
        (Err(obstacle), Ok(_)) => Err(of_coupling(*obstacle)),
        (Err(_), Err(obstacle)) => Err(from_obstacle(*obstacle)),
    }
}

const fn coupling_rejection(n: &LoopIntervals, out: &Assessment) -> Rejection {
    let (alpha, alpha_coupled) = match out.rule {
        Rule::Exact => (out.alpha, out.alpha_coupled),
        Rule::Nonlinear => (out.bound, None),
    };
    Rejection::Coupling {
        alpha,
        alpha_coupled,
        delta: n.delta,
        stiffness: n.coupling,
        standard: n.standard_stiffness(),
        remedies: Remedies::NONE,
    }
}

const fn missed_rejection(alpha: Interval, limit: Interval) -> Rejection {
    Rejection::Missed { alpha, limit, remedies: Remedies::NONE }
}

const fn nonlinear_outcome(
    n: &LoopIntervals,
    alone: &Result<RealPart, IndexError>,
    out: &Assessment,
) -> Result<(), Rejection> {
    let found = match alone {
        Ok(found) => found,
        Err(obstacle) => return Err(from_obstacle(*obstacle)),
    };
    let Some(bound) = out.bound else {
        return Err(Rejection::Undecided {
            doubt: UndecidedReason::NoNonlinearBound,
            index: Some(found.minimum),
            limit: Some(n.delta),
            remedies: Remedies::NONE,
        });
    };
    match out.paper {
        RuleAnswer::Pass => Ok(()),
        RuleAnswer::Undecided => Err(Rejection::Undecided {
            doubt: UndecidedReason::TooClose,
            index: Some(bound),
            limit: Some(n.delta),
            remedies: Remedies::NONE,
        }),
        RuleAnswer::Fail if bound.is_below(n.delta) => match (paper_limit(n), &n.missed) {
            (Some(limit), Some(_)) => Err(missed_rejection(bound, limit)),
            _ => Err(coupling_rejection(n, out)),
        },
        RuleAnswer::Fail => Err(Rejection::Shortage {
            alpha: bound,
            delta: n.delta,
            cos_theta: found.cos_theta,
            remedies: Remedies::NONE,
        }),
    }
}

/// The rejection of an environment that has no such obstacle without its coupling.
const fn of_coupling(obstacle: IndexError) -> Rejection {
    let mut out = from_obstacle(obstacle);
    if let Rejection::UnstablePole { of_coupling, .. } = &mut out {
        *of_coupling = true;
    }
    out
}

const fn from_obstacle(obstacle: IndexError) -> Rejection {
    match obstacle {
        IndexError::UnstablePole { reflection } => Rejection::UnstablePole {
            reflection,
            of_coupling: false,
            remedies: Remedies::NONE,
            behind_standard: None,
        },
        IndexError::RepeatedUnitPole { cos_theta } => Rejection::RepeatedUnitPole { cos_theta },
        IndexError::ResidueAngle { cos_theta } => Rejection::ResidueAngle { cos_theta },
        IndexError::NegativeResidue { residue } => Rejection::NegativeResidue { residue },
        IndexError::Undecided(doubt) => {
            Rejection::Undecided { doubt, index: None, limit: None, remedies: Remedies::NONE }
        }
    }
}
