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
    pub(super) evaluate: fn() -> Result<CaseReport, StudyError>,
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
        Ok(CaseReport { name: self.name, question: self.question, ..(self.evaluate)()? })
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
    /// The results of common methods on a scene, and the certificate's. The runs: of the loop in question, then
    /// of a loop that the certificate allows.
    pub(super) fn of(
        scene: &Scene,
        methods: Vec<MethodResult>,
        truth: MethodResult,
        runs: &[LoopRun],
    ) -> Result<Self, StudyError> {
        Self::with(methods, MethodResult::certificate(scene), truth, runs)
    }

    /// The same with another answer of the certificate; the case adds its name and its question.
    pub(super) fn with(
        methods: Vec<MethodResult>,
        certificate: MethodResult,
        truth: MethodResult,
        runs: &[LoopRun],
    ) -> Result<Self, StudyError> {
        let (name, question, verdict) = ("", "", truth.verdict);
        let judged =
            |result: MethodResult| JudgedMethod { failure: result.failure(verdict), result };
        let methods = methods.into_iter().map(judged).collect();
        let runs = runs.iter().map(RunResult::of).collect::<Result<_, _>>()?;
        Ok(Self { name, question, methods, truth, certificate, runs })
    }

    /// Whether some method is wrong, the certificate is right, and all runs are as expected.
    pub fn holds(&self) -> bool {
        self.methods.iter().any(|judged| judged.failure.is_some())
            && self.certificate.failure(self.truth.verdict).is_none()
            && self.runs.iter().all(RunResult::is_as_expected)
    }
}
