//! A question about one loop, and the results of the methods that were asked.

use haptic_servo::environment::ShapeError;
use thiserror::Error;

use super::loop_run::{LoopRun, LoopRunError};
use super::method_result::MethodResult;
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
    Run(#[from] LoopRunError),
    /// There is no such device.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// Shapes are no torque profile.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A wall has no largest stiffness.
    #[error("this wall has no largest certified stiffness")]
    NoLimit,
}

/// A question about one loop.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name on the command line.
    pub name: &'static str,
    /// The question, in a few words.
    pub question: &'static str,
    pub(super) evaluate: fn() -> Result<CaseResult, FailureError>,
}

/// The results of all methods, and the loops that show which are right.
#[derive(Clone, Debug)]
pub struct CaseResult {
    /// The methods that others use.
    pub methods: Vec<MethodResult>,
    /// The certificate.
    pub certificate: MethodResult,
    /// What does not err on this loop.
    pub truth: MethodResult,
    /// Loops that show it: the loop in question, then a loop that the certificate allows.
    pub runs: Vec<LoopRun>,
}

impl Case {
    /// Asks all methods.
    ///
    /// # Errors
    /// Where the loop cannot be had.
    pub fn evaluate(&self) -> Result<CaseResult, FailureError> {
        (self.evaluate)()
    }
}
