//! What was said, what is so, and what was seen, as one answer.

use serde::Serialize;

use super::case::{Case, FailureError};
use super::claim::{Claim, Failure};
use super::fate::{End, Fate};
use super::trial::{Played, Trial};
use super::walls::{DELAYS, wall};
use crate::emulator::ServoClient;
use crate::worst_hand::HandCase;

/// A case with everything about it.
#[derive(Clone, Debug, Serialize)]
pub struct CaseReport {
    /// Its name.
    pub name: &'static str,
    /// What is asked.
    pub question: &'static str,
    /// What methods say.
    pub claims: Vec<Judged>,
    /// What is so.
    pub truth: Claim,
    /// What the certificate says beforehand.
    pub certificate: Claim,
    /// What was seen.
    pub trials: Vec<Seen>,
}

/// A claim and how it is wrong.
#[derive(Clone, Debug, Serialize)]
pub struct Judged {
    /// What is said.
    #[serde(flatten)]
    pub claim: Claim,
    /// How it is wrong, if it is.
    pub failure: Option<Failure>,
}

/// A trial and what was seen.
#[derive(Clone, Debug, Serialize)]
pub struct Seen {
    /// What was tried.
    pub what: &'static str,
    /// What was to come of it.
    pub expected: End,
    /// What became of it in simulation.
    pub simulated: Fate,
    /// What the emulated board did, if it was asked.
    pub emulated: Option<Played>,
}

/// A wall on both sides of its limit.
#[derive(Clone, Debug, Serialize)]
pub struct WallReport {
    /// Delay in samples.
    pub delay: usize,
    /// Largest certified stiffness in N m/rad.
    pub limit: f64,
    /// The hand in which it oscillates at 1.01 of that.
    pub hand: HandCase,
    /// What was seen.
    pub trials: Vec<Seen>,
}

impl Case {
    /// Asks everybody, and runs the loops: on the emulated board, too, if there is one.
    ///
    /// # Errors
    /// Where a loop cannot be had or run.
    pub fn report(&self, player: &mut Option<ServoClient>) -> Result<CaseReport, FailureError> {
        let study = self.study()?;
        let truth = study.truth.says;
        let judged = |claim: Claim| Judged { failure: claim.failure(truth), claim };
        Ok(CaseReport {
            name: self.name,
            question: self.question,
            claims: study.claims.into_iter().map(judged).collect(),
            truth: study.truth,
            certificate: study.certificate,
            trials: seen(&study.trials, player)?,
        })
    }
}

/// The walls of every delay.
///
/// # Errors
/// Where one has no limit, or cannot be run.
pub fn walls(player: &mut Option<ServoClient>) -> Result<Vec<WallReport>, FailureError> {
    let report = |delay| {
        let wall = wall(delay)?;
        let trials = [&wall.below[..], &[wall.above]].concat();
        let trials = seen(&trials, player)?;
        Ok(WallReport { delay, limit: wall.limit, hand: wall.hand, trials })
    };
    DELAYS.map(report).collect()
}

fn seen(trials: &[Trial], player: &mut Option<ServoClient>) -> Result<Vec<Seen>, FailureError> {
    let see = |trial: &Trial| {
        let emulated = player.as_mut().map(|player| trial.emulated(player)).transpose()?;
        let (what, expected) = (trial.what, trial.expected);
        Ok(Seen { what, expected, simulated: trial.simulated()?, emulated })
    };
    trials.iter().map(see).collect()
}

impl Seen {
    /// Whether that is what was to come of it.
    pub fn is_as_expected(&self) -> bool {
        let emulated = self.emulated.as_ref().is_none_or(|played| played.shows(self.expected));
        self.simulated.end() == self.expected && emulated
    }
}

impl CaseReport {
    /// Whether some method is wrong, the certificate is not, and all was seen as expected.
    pub fn holds(&self) -> bool {
        self.claims.iter().any(|judged| judged.failure.is_some())
            && self.certificate.failure(self.truth.says).is_none()
            && self.trials.iter().all(Seen::is_as_expected)
    }
}

impl WallReport {
    /// Whether all was seen as expected.
    pub fn holds(&self) -> bool {
        self.hand.grows() && self.trials.iter().all(Seen::is_as_expected)
    }
}
