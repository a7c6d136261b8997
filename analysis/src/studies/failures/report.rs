//! A question about one loop: the verdicts of the methods, the truth, and the observed motions.

use haptic_servo::scene::Scene;
use serde::Serialize;

use super::loop_run::LoopRun;
use super::method_result::{Failure, MethodResult};
use super::motion::{Motion, Outcome};
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
pub struct CaseResult {
    pub(super) methods: Vec<MethodResult>,
    pub(super) certificate: MethodResult,
    /// The true result for this loop.
    pub(super) truth: MethodResult,
    /// The runs: of the loop in question, then of a loop that the certificate allows.
    pub(super) runs: Vec<LoopRun>,
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

/// A case with all its results.
#[derive(Clone, Debug, Serialize)]
pub struct CaseReport {
    /// Its name.
    pub name: &'static str,
    /// The question.
    pub question: &'static str,
    /// The common methods.
    #[serde(rename = "claims")]
    pub methods: Vec<JudgedMethod>,
    /// The true result for this loop.
    pub truth: MethodResult,
    /// The certificate.
    pub certificate: MethodResult,
    /// The runs.
    #[serde(rename = "trials")]
    pub runs: Vec<RunResult>,
}

/// The result of a method, and its failure.
#[derive(Clone, Debug, Serialize)]
pub struct JudgedMethod {
    /// The result.
    #[serde(flatten)]
    pub result: MethodResult,
    /// The failure, if it is wrong.
    pub failure: Option<Failure>,
}

/// Expected and observed outcome of a run.
#[derive(Clone, Debug, Serialize)]
pub struct RunResult {
    /// The run as short text.
    pub what: &'static str,
    /// The expected outcome.
    pub expected: Outcome,
    /// Its motion in simulation.
    pub simulated: Motion,
    /// Its motion with a board's servo, if a board can run the scene.
    pub servo: Option<Motion>,
}

impl Case {
    /// Evaluates all methods, and runs the loops.
    pub fn report(&self) -> Result<CaseReport, StudyError> {
        let result = (self.evaluate)()?;
        let truth = result.truth.verdict;
        let judged = |result: MethodResult| JudgedMethod { failure: result.failure(truth), result };
        Ok(CaseReport {
            name: self.name,
            question: self.question,
            methods: result.methods.into_iter().map(judged).collect(),
            truth: result.truth,
            certificate: result.certificate,
            runs: result.runs.iter().map(RunResult::of).collect::<Result<_, _>>()?,
        })
    }
}

impl RunResult {
    fn of(loop_run: &LoopRun) -> Result<Self, StudyError> {
        let (what, expected) = (loop_run.what, loop_run.expected);
        let (simulated, servo) = (loop_run.simulated()?, loop_run.with_servo()?);
        Ok(Self { what, expected, simulated, servo })
    }

    /// Whether the outcome is the expected one.
    pub fn is_as_expected(&self) -> bool {
        let is_it = |motion: &Motion| motion.outcome() == self.expected;
        is_it(&self.simulated) && self.servo.as_ref().is_none_or(is_it)
    }
}

impl CaseReport {
    /// Whether some method is wrong, the certificate is right, and all runs are as expected.
    pub fn holds(&self) -> bool {
        self.methods.iter().any(|judged| judged.failure.is_some())
            && self.certificate.failure(self.truth.verdict).is_none()
            && self.runs.iter().all(RunResult::is_as_expected)
    }
}
