//! `haptic failures`: loops that other methods judge wrongly, with the verdict of the certificate.

use std::fmt::Write as _;

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde::Serialize;

use super::shared_arguments::JsonOption;
use super::status::{CommandError, CommandStatus};
use crate::progress;
use crate::studies::failures::method_result::{Failure, MethodResult};
use crate::studies::failures::report::{CaseReport, RunResult};
use crate::studies::failures::{ALL, Case};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of one case; default: all
    #[arg(long, value_name = "NAME", value_parser = names())]
    pub case: Option<String>,
    #[command(flatten)]
    pub answer: JsonOption,
}

fn names() -> PossibleValuesParser {
    ALL.iter().map(|case| case.name).collect::<Vec<_>>().into()
}

#[derive(Debug, Serialize)]
struct Found {
    cases: Vec<CaseReport>,
}

/// Judges and runs the loops: the status is negative if a result is not as expected.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let wanted = |name: &str| arguments.case.as_deref().is_none_or(|case| case == name);
    let cases: Vec<&Case> = ALL.iter().filter(|case| wanted(case.name)).collect();
    let bar = progress::bar(cases.len() as u64, "cases");
    let report = |case: &&Case| {
        bar.inc(1);
        case.report()
    };
    let cases = cases.iter().map(report).collect::<Result<Vec<_>, _>>()?;
    bar.finish_and_clear();
    let found = Found { cases };
    arguments.answer.print(&found, text)?;
    Ok(CommandStatus::of(found.cases.iter().all(CaseReport::holds)))
}

fn text(found: &Found) -> String {
    found.cases.iter().map(case).collect::<Vec<_>>().join("\n")
}

/// A case as lines: the verdict of each method, and the runs.
fn case(case: &CaseReport) -> String {
    let mut text = format!("{}: {}\n", case.name, case.question);
    for judged in &case.methods {
        line(&mut text, &judged.result.method, &judged.result, judged.failure);
    }
    line(&mut text, "certificate", &case.certificate, None);
    line(&mut text, &format!("truth: {}", case.truth.method), &case.truth, None);
    runs(&mut text, &case.runs);
    text
}

fn line(text: &mut String, method: &str, result: &MethodResult, failure: Option<Failure>) {
    let mark = match failure {
        Some(Failure::Dangerous) => "WRONG",
        Some(Failure::Needless) => "wrong",
        None => "",
    };
    // `haptic certify` prints the remedies.
    let reason = result.reason.split("; it would pass").next().unwrap_or_default();
    let _ = writeln!(text, "  {method:<38} {:<9} {mark:<5}  {reason}", result.verdict.as_str());
}

fn runs(text: &mut String, results: &[RunResult]) {
    for RunResult { what, simulated, servo, .. } in results {
        let servo = servo.map_or_else(String::new, |motion| format!("; with a servo, {motion}"));
        let _ = writeln!(text, "  run: {what:<42}   simulated, {simulated}{servo}");
    }
}
