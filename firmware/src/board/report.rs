//! The certificate as the output of a program on the host.

use core::fmt;

use crate::certificate::{
    Assessment, AssumptionStatus, Assumptions, Certified, Resolution, Rule, RuleAnswer,
};
use crate::passivity::interval::Interval;
use crate::scene::Scene;

/// A certificate as text.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    assessment: Assessment,
    margin: Option<f64>,
    injection: Option<f64>,
    assumptions: Assumptions,
}

impl Report {
    /// The report of a certified scene, its options, and the injected damping in N m s/rad.
    pub fn new<E>(
        certified: &Certified<Scene<E>>,
        steps: &Resolution,
        injection: Option<f64>,
    ) -> Self {
        let (data, assessment) = (certified.as_data(), *certified.assessment());
        let margin = assessment.margin_injecting(data, injection.unwrap_or(0.0));
        let assumptions = Assumptions::of(data, &assessment, steps);
        Self { assessment, margin, injection, assumptions }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Assessment { alpha, alpha_coupled, bound, delta, paper, exact, rule, format, .. } =
            self.assessment;
        // Only a certified scene has a report.
        writeln!(f, "verdict        certified")?;
        writeln!(f, "rules          paper {}, exact {}", word(paper), word(exact))?;
        writeln!(f, "judged by      {}", sentence(rule))?;
        writeln!(f, "computed in    {format}, with its coefficients as rounded")?;
        let indices =
            [("alpha", alpha), ("alpha, coupled", alpha_coupled), ("alpha, bound", bound)];
        for (name, index) in indices {
            if let Some(index) = index {
                writeln!(f, "{name:<14} {}", Enclosure(index))?;
            }
        }
        writeln!(f, "{:<14} {}", "delta", Enclosure(delta))?;
        if let Some(injection) = self.injection {
            writeln!(f, "injects        up to {injection} N m s/rad where there is a deficit")?;
        }
        match self.margin {
            // The coupling was designed for this passivity.
            None => writeln!(f, "margin         none is known where torques lag")?,
            Some(margin) => writeln!(f, "margin         {margin:.9} N m s/rad")?,
        }
        if let Some(rest) = self.assumptions.rest() {
            writeln!(f, "at rest        {rest}")?;
        }
        writeln!(f, "provided that")?;
        for assumption in self.assumptions.iter() {
            let failed = assumption.standing() == AssumptionStatus::Fails;
            writeln!(f, "  - {}{assumption}", if failed { "WARNING: " } else { "" })?;
        }
        Ok(())
    }
}

/// An enclosure with all its digits.
struct Enclosure(Interval);

impl fmt::Display for Enclosure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}] N m s/rad", self.0.lo(), self.0.hi())
    }
}

fn word(answer: RuleAnswer) -> &'static str {
    match answer {
        RuleAnswer::Pass => "pass",
        RuleAnswer::Fail => "fail",
        RuleAnswer::Undecided => "undecided",
    }
}

fn sentence(rule: Rule) -> &'static str {
    match rule {
        Rule::Exact => "the exact rule, alpha with the coupling folded in < delta",
        Rule::Nonlinear => "equations 17 to 19 with the bound for one-sided and limited scenes",
    }
}
