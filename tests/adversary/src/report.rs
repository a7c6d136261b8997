//! A counterexample, with all that it takes to find it again.

use std::fmt;

use haptic_servo::torque::LimitReason;

use crate::mode::Actual;
use crate::normalized_scene::NormalizedScene;
use crate::plan::Plan;
use crate::run::Outcome;
use crate::scenes::RandomScene;

/// A run in which a certified scene gave energy away.
#[derive(Clone, Debug)]
pub struct Counterexample {
    /// The search's seed.
    pub seed: u64,
    /// The scene's number in it.
    pub number: u64,
    /// What was drawn.
    pub drawn: RandomScene,
    /// The same as numbers.
    pub normalized: NormalizedScene,
    /// The run.
    pub plan: Plan,
    /// What became of it.
    pub outcome: Outcome,
}

impl fmt::Display for Counterexample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seed, number, drawn, normalized, plan, outcome } = self;
        let gain = outcome.gained - outcome.allowed;
        writeln!(f, "counterexample: ADVERSARY_SEED={seed}, scene {number}, {}", drawn.kind)?;
        if outcome.went_on {
            writeln!(f, "  the servo went on with more missed updates than are tolerated")?;
        }
        writeln!(
            f,
            "  {gain:.3e} above the {:.3e} at the start and the {:.3e} allowed, score {:.3e}, \
             rate {:.3e}, in period {} of {}; the simulation's own error is {:.1e}",
            outcome.start,
            outcome.allowed,
            outcome.score,
            outcome.rate,
            outcome.period,
            outcome.periods,
            outcome.residual,
        )?;
        write!(f, "  openings {}, stops {}, ticks by limit", outcome.openings, outcome.faults)?;
        for (reason, ticks) in LimitReason::ALL.into_iter().zip(outcome.limits) {
            write!(f, " {reason} {ticks}")?;
        }
        writeln!(f)?;
        writeln!(f, "  {:?} {:?} {:?}", drawn.format, drawn.mode, drawn.scene)?;
        if drawn.actual != Actual::default() {
            writeln!(f, "  actual: {:?}", drawn.actual)?;
        }
        if let Some(other) = &drawn.other {
            writeln!(f, "  other set: {other:?}")?;
        }
        writeln!(f, "  {:?} {:?}", drawn.transducers, drawn.rendering)?;
        writeln!(f, "  {plan:?}")?;
        write!(f, "  {normalized:?}")
    }
}
