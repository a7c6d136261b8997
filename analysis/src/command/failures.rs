//! `haptic failures`: loops that other methods judge wrongly, with the verdict of the certificate.

use std::fmt::Write as _;
use std::io;

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde::Serialize;

use super::shared_arguments::JsonOption;
use super::status::{CommandError, CommandStatus};
use crate::emulator::Client;
use crate::progress;
use crate::studies::failures::loop_run::BoardResult;
use crate::studies::failures::method_result::{Failure, MethodResult};
use crate::studies::failures::report::{CaseReport, RunResult};
use crate::studies::failures::{ALL, Case};
use crate::toolchain::{Tools, prepare};

/// Arguments of `haptic failures`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of one case; default: all
    #[arg(long, value_name = "NAME", value_parser = names())]
    pub case: Option<String>,
    /// Also run the loops with the servo on the emulated board
    #[arg(long)]
    pub emulate: bool,
    /// Print one row for each claim
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    #[command(flatten)]
    pub answer: JsonOption,
}

fn names() -> PossibleValuesParser {
    ALL.iter().map(|case| case.name).collect::<Vec<_>>().into()
}

/// All requested results.
#[derive(Debug, Serialize)]
struct Found {
    cases: Vec<CaseReport>,
}

/// Judges and runs the loops: the status is negative if a result is not as expected.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let wanted = |name: &str| arguments.case.as_deref().is_none_or(|case| case == name);
    let mut player = match arguments.emulate {
        true => {
            let toolchain = prepare(Tools::CompilerAndEmulator)?;
            Some(Client::boot(&toolchain.build_harness("servo_server")?)?)
        }
        false => None,
    };
    let cases: Vec<&Case> = ALL.iter().filter(|case| wanted(case.name)).collect();
    let bar = progress::bar(cases.len() as u64, "cases");
    let mut report = |case: &&Case| {
        bar.inc(1);
        case.report(&mut player)
    };
    let cases = cases.iter().map(&mut report).collect::<Result<Vec<_>, _>>()?;
    bar.finish_and_clear();
    if let Some(player) = player {
        player.finish()?;
    }
    let found = Found { cases };
    match arguments.csv {
        true => csv(&found.cases)?,
        false => arguments.answer.print(&found, text)?,
    }
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
    for RunResult { what, simulated, emulated, .. } in results {
        let emulated = match emulated {
            None => String::new(),
            Some(BoardResult::Refused) => "; the board refuses it".to_owned(),
            Some(BoardResult::Ran(motion)) => format!("; emulated, {motion}"),
        };
        let _ = writeln!(text, "  run: {what:<42}   simulated, {simulated}{emulated}");
    }
}

/// One row per verdict, including the certificate's and the truth.
fn csv(cases: &[CaseReport]) -> Result<(), CommandError> {
    let mut table = csv::Writer::from_writer(io::stdout().lock());
    table.write_record(["case", "by", "says", "failure", "figure", "because"])?;
    for case in cases {
        let judged = case.methods.iter().map(|judged| (&judged.result, judged.failure));
        for (result, failure) in judged.chain([(&case.certificate, None), (&case.truth, None)]) {
            let failure = match failure {
                Some(Failure::Dangerous) => "dangerous",
                Some(Failure::Needless) => "needless",
                None => "",
            };
            let figure = result.figure.map(|figure| figure.to_string()).unwrap_or_default();
            let row = [
                case.name,
                &result.method,
                result.verdict.as_str(),
                failure,
                &figure,
                &result.reason,
            ];
            table.write_record(row)?;
        }
    }
    Ok(table.flush()?)
}
