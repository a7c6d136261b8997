//! A question about one loop, and the results of the methods.

use haptic_servo::scene::Scene;

use super::loop_run::LoopRun;
use super::method_result::MethodResult;
use crate::studies::error::StudyError;

/// A question about one loop.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name on the command line.
    pub name: &'static str,
    /// The question as short text.
    pub question: &'static str,
    pub(super) evaluate: fn() -> Result<CaseResult, StudyError>,
}

/// The results of all methods, and the loops that show which of them are right.
#[derive(Clone, Debug)]
pub struct CaseResult {
    /// The common methods.
    pub methods: Vec<MethodResult>,
    /// The certificate.
    pub certificate: MethodResult,
    /// The true result for this loop.
    pub truth: MethodResult,
    /// The runs: of the loop in question, then of a loop that the certificate allows.
    pub runs: Vec<LoopRun>,
}

impl CaseResult {
    /// The results of common methods on a scene, and the certificate's.
    pub(super) fn of(
        scene: &Scene,
        methods: Vec<MethodResult>,
        truth: MethodResult,
        runs: impl Into<Vec<LoopRun>>,
    ) -> Self {
        Self { methods, certificate: MethodResult::certificate(scene), truth, runs: runs.into() }
    }
}

impl Case {
    /// Evaluates all methods.
    pub fn evaluate(&self) -> Result<CaseResult, StudyError> {
        (self.evaluate)()
    }
}
