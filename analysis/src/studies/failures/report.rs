//! Verdicts, truth and observed motions as one report.

use serde::Serialize;

use super::case::Case;
use super::loop_run::{BoardResult, LoopRun};
use super::method_result::{Failure, MethodResult};
use super::motion::{Motion, Outcome};
use crate::emulator::Client;
use crate::studies::error::StudyError;

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
    /// The result on the emulated board, if requested and if it can run the scene.
    pub emulated: Option<BoardResult>,
}

impl Case {
    /// Evaluates all methods, and runs the loops, also on the emulated board if there is one.
    pub fn report(&self, player: &mut Option<Client>) -> Result<CaseReport, StudyError> {
        let result = self.evaluate()?;
        let truth = result.truth.verdict;
        let judged = |result: MethodResult| JudgedMethod { failure: result.failure(truth), result };
        Ok(CaseReport {
            name: self.name,
            question: self.question,
            methods: result.methods.into_iter().map(judged).collect(),
            truth: result.truth,
            certificate: result.certificate,
            runs: run_all(&result.runs, player)?,
        })
    }
}

fn run_all(runs: &[LoopRun], player: &mut Option<Client>) -> Result<Vec<RunResult>, StudyError> {
    let run = |loop_run: &LoopRun| {
        let player = player.as_mut().filter(|_| loop_run.goes_to_a_board());
        let emulated = player.map(|player| loop_run.emulated(player)).transpose()?;
        let (what, expected) = (loop_run.what, loop_run.expected);
        Ok(RunResult { what, expected, simulated: loop_run.simulated()?, emulated })
    };
    runs.iter().map(run).collect()
}

impl RunResult {
    /// Whether the outcome is the expected one.
    pub fn is_as_expected(&self) -> bool {
        let emulated = self.emulated.as_ref().is_none_or(|board| board.agrees_with(self.expected));
        self.simulated.outcome() == self.expected && emulated
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
