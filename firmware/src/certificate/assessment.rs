//! The answers of both rules for a scene, with their numbers.

use super::linearity::is_nonlinear;
use super::loop_intervals::LoopIntervals;
use super::problem::PassivityProblem;
use super::rejection::Rejection;
use super::remedy::Remedies;
use super::rules::{Rule, RuleAnswer, exact_limit, paper_limit};
use super::validity::check;
use crate::number::Format;
use crate::passivity::bernstein::Precision;
use crate::passivity::discrete::RealPart;
use crate::passivity::interval::Interval;
use crate::passivity::poles::{IndexError, UndecidedReason};
use crate::scene::Scene;

/// The result of judging a scene. Indices in N m s/rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessment {
    /// Index `alpha` of the environment alone; `None` if it does not exist.
    pub alpha: Option<Interval>,
    /// Index of `E'`, the environment that gives the same controller behind the standard coupling.
    pub alpha_coupled: Option<Interval>,
    /// Index at the device's port with delay, lag and sensor (equation 38): the least sufficient passivity of
    /// a device. `None` if the scene has none of these times, if the index does not exist, or if only the
    /// verdict was requested.
    pub alpha_port: Option<Interval>,
    /// Bound on the index that holds for one-sided and limited scenes; `None` for linear ones.
    pub bound: Option<Interval>,
    /// The device's passivity, scaled to the worst period.
    pub delta: Interval,
    /// An enclosure of the `cos(theta)` at which the linear index is reached; `[-1, 1]` if it is reached
    /// everywhere.
    pub cos_theta: Option<Interval>,
    /// Answer of equations 17 to 19.
    pub paper: RuleAnswer,
    /// Answer of theory, section 4.1.
    pub exact: RuleAnswer,
    /// The rule that decides the verdict.
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

/// Judges a scene with unrounded coefficients by both rules, without a search for remedies.
pub const fn assess(scene: &Scene) -> Assessment {
    assess_in(scene, Format::F64)
}

/// Judges a scene with the coefficients rounded to this number format, without a search for remedies.
pub const fn assess_in(scene: &Scene, format: Format) -> Assessment {
    assessed(scene, format, Extent::BothRules)
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Extent {
    BothRules,
    /// For a rejected scene, and for one with lagging and limited torques, only the result of its own rule;
    /// for one with lagging torques, the index only as precisely as the proof needs.
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
    if let Err(invalid) = check(scene) {
        out.outcome = Err(Rejection::Invalid(invalid));
        return out;
    }
    let mut posed = PassivityProblem::unposed(scene, format);
    out.delta = posed.numbers.delta;
    out.outcome = match posed.pose(scene) {
        Ok(()) => judge(&posed, extent, &mut out),
        Err(rejection) => Err(rejection),
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
    let is_limited = matches!(out.rule, Rule::Nonlinear);
    let is_refused = is_limited && !matches!(out.paper, RuleAnswer::Pass);
    if is_refused
        && n.is_at_port
        && matches!(out.paper, RuleAnswer::Undecided)
        && let Some(in_contact) = posed.fails_in_contact()
    {
        out.paper = RuleAnswer::Fail;
        let RealPart { minimum, cos_theta } = in_contact;
        return Err(Rejection::shortage(minimum, n.delta, cos_theta));
    }
    if is_refused && matches!(extent, Extent::OwnRule) {
        return nonlinear_outcome(n, &alone, out);
    }
    // A scene that lags and is limited is decided at this point, and the other rule would need more stack
    // than a small board has.
    if is_limited && n.latency.is_some() && matches!(extent, Extent::OwnRule) {
        out.exact = RuleAnswer::Undecided;
        return nonlinear_outcome(n, &alone, out);
    }
    let coupled = if !n.linearity.is_zero() && matches!(extent, Extent::BothRules) {
        match posed.through_inl(&Precision::TIGHT, true) {
            Ok((found, needed)) => {
                out.alpha_port = Some(needed);
                Ok(found)
            }
            Err(error) => Err(error),
        }
    } else if n.latency.is_some() && matches!(extent, Extent::BothRules) {
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
    if is_limited && n.is_at_port && posed.misreads {
        // The index without what the encoder does to it is of no use.
        out.alpha_port = posed.bound;
        out.exact = RuleAnswer::Undecided;
    }
    match out.rule {
        Rule::Exact => exact_outcome(posed, &alone, &coupled, out),
        Rule::Nonlinear => nonlinear_outcome(n, &alone, out),
    }
}

const fn exact_outcome(
    posed: &PassivityProblem,
    alone: &Result<RealPart, IndexError>,
    coupled: &Result<RealPart, IndexError>,
    out: &Assessment,
) -> Result<(), Rejection> {
    let n = &posed.numbers;
    let limit = exact_limit(n);
    // If the environment would pass at the standard coupling, the coupling fails, unless torques lag.
    let blames_coupling = match alone {
        Ok(found) => {
            n.latency.is_none() && n.linearity.is_zero() && found.minimum.is_below(n.delta)
        }
        Err(_) => false,
    };
    match (coupled, alone) {
        (Ok(found), _) => match out.exact {
            RuleAnswer::Pass => Ok(()),
            RuleAnswer::Undecided => {
                let index = Some(found.minimum);
                Err(Rejection::undecided(UndecidedReason::TooClose, index, Some(limit)))
            }
            RuleAnswer::Fail if blames_coupling && n.missed.is_some() => {
                Err(missed_rejection(found.minimum, limit))
            }
            RuleAnswer::Fail if blames_coupling => Err(coupling_rejection(n, out)),
            RuleAnswer::Fail => {
                // With lagging torques, the passivity that the device lacks, not the obstacle of this device.
                let alpha = match out.alpha_port {
                    Some(needed) => needed,
                    None if n.latency.is_some() && n.linearity.is_zero() => {
                        match posed.port_needed() {
                            Ok(needed) => needed,
                            Err(_) => found.minimum,
                        }
                    }
                    None => found.minimum,
                };
                Err(Rejection::shortage(alpha, limit, found.cos_theta))
            }
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
        stiffness: if n.is_matched { None } else { n.coupling },
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
        let doubt = match n.is_at_port {
            _ if !n.linearity.is_zero() && !n.is_at_port => UndecidedReason::NoProofWithInl,
            true => UndecidedReason::NoBoundAtPort,
            false => UndecidedReason::NoNonlinearBound,
        };
        return Err(Rejection::undecided(doubt, Some(found.minimum), Some(n.delta)));
    };
    match out.paper {
        RuleAnswer::Pass => Ok(()),
        RuleAnswer::Undecided => {
            let doubt = match bound.lo() >= n.delta.hi() {
                true => UndecidedReason::NotBelowBound,
                false => UndecidedReason::TooClose,
            };
            Err(Rejection::undecided(doubt, Some(bound), Some(n.delta)))
        }
        RuleAnswer::Fail if bound.is_below(n.delta) => match (paper_limit(n), &n.missed) {
            (Some(limit), Some(_)) => Err(missed_rejection(bound, limit)),
            _ => Err(coupling_rejection(n, out)),
        },
        RuleAnswer::Fail => Err(Rejection::shortage(bound, n.delta, found.cos_theta)),
    }
}

/// The rejection of an environment that does not have this obstacle without its coupling.
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
        IndexError::Undecided(doubt) => Rejection::undecided(doubt, None, None),
    }
}
