//! A question about one loop, and what was said of it.

use thiserror::Error;

use super::claim::Claim;
use super::trial::{Trial, TrialError};
use crate::chain::ChainError;
use crate::simulation::SimulationError;

/// Why a case has no answers.
#[derive(Debug, Error)]
pub enum FailureError {
    /// A loop cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A loop cannot be run.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// There is no such device.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// A wall has no largest stiffness.
    #[error("this wall has no largest certified stiffness")]
    NoLimit,
}

/// A question about one loop.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name on the command line.
    pub name: &'static str,
    /// What is asked, in a few words.
    pub question: &'static str,
    pub(super) study: fn() -> Result<Study, FailureError>,
}

/// What was said, and what is so.
#[derive(Clone, Debug)]
pub struct Study {
    /// The methods that others use.
    pub claims: Vec<Claim>,
    /// The certificate.
    pub certificate: Claim,
    /// What does not err on this loop.
    pub truth: Claim,
    /// Loops that show it: the one in question, then one that the certificate allows.
    pub trials: Vec<Trial>,
}

impl Case {
    /// Asks everybody.
    ///
    /// # Errors
    /// Where the loop cannot be had.
    pub fn study(&self) -> Result<Study, FailureError> {
        (self.study)()
    }
}
