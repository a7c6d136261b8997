//! `haptic failures`: where do methods fail, and what did the certificate say before?

use std::fmt::Write as _;
use std::io;

use clap::Args;
use clap::builder::PossibleValuesParser;
use serde::Serialize;

use super::shared_arguments::JsonOption;
use super::status::{CommandError, CommandStatus};
use crate::emulator::ServoClient;
use crate::progress;
use crate::quantity::significant;
use crate::studies::failures::claim::{Claim, Failure};
use crate::studies::failures::report::{CaseReport, Seen, WallReport, walls};
use crate::studies::failures::trial::Played;
use crate::studies::failures::{ALL, Case};
use crate::toolchain::{Tools, prepare};

/// Arguments of `haptic failures`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of one case; `walls` are walls on both sides of their limit. Default: all
    #[arg(long, value_name = "NAME", value_parser = names())]
    pub case: Option<String>,
    /// Also run the loops with the servo on the emulated board
    #[arg(long)]
    pub emulate: bool,
    /// Print one row for each claim
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub answer: JsonOption,
}

/// Name of the walls among the cases.
const WALLS: &str = "walls";

fn names() -> PossibleValuesParser {
    ALL.iter().map(|case| case.name).chain([WALLS]).collect::<Vec<_>>().into()
}

/// Everything that was asked for.
#[derive(Debug, Serialize)]
struct Found {
    cases: Vec<CaseReport>,
    walls: Vec<WallReport>,
}

/// Asks and runs: the answer is no where something was not as it should be.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let wanted = |name: &str| arguments.case.as_deref().is_none_or(|case| case == name);
    let mut player = match arguments.emulate {
        true => {
            let toolchain = prepare(Tools::CompilerAndEmulator, |step| eprintln!("{step}"))?;
            Some(ServoClient::boot(&toolchain.build_servo_server()?)?)
        }
        false => None,
    };
    let cases: Vec<&Case> = ALL.iter().filter(|case| wanted(case.name)).collect();
    let bar = progress::bar(cases.len() as u64 + 1, "cases");
    let mut report = |case: &&Case| {
        bar.inc(1);
        case.report(&mut player)
    };
    let cases = cases.iter().map(&mut report).collect::<Result<Vec<_>, _>>()?;
    let walls = if wanted(WALLS) { walls(&mut player)? } else { Vec::new() };
    bar.finish_and_clear();
    if let Some(player) = player {
        player.finish()?;
    }
    let found = Found { cases, walls };
    match arguments.csv {
        true => csv(&found.cases)?,
        false => arguments.answer.print(&found, text)?,
    }
    let holds = found.cases.iter().all(CaseReport::holds);
    let stand = found.walls.iter().all(WallReport::holds);
    Ok(if holds && stand { CommandStatus::Success } else { CommandStatus::NegativeVerdict })
}

fn text(found: &Found) -> String {
    let cases = found.cases.iter().map(case);
    cases.chain(found.walls.iter().map(wall)).collect::<Vec<_>>().join("\n")
}

/// A case as lines: who says what, and what was seen.
fn case(case: &CaseReport) -> String {
    let mut text = format!("{}: {}\n", case.name, case.question);
    for judged in &case.claims {
        line(&mut text, &judged.claim.by, &judged.claim, judged.failure);
    }
    line(&mut text, "certificate", &case.certificate, None);
    line(&mut text, &format!("truth: {}", case.truth.by), &case.truth, None);
    seen(&mut text, &case.trials);
    text
}

fn line(text: &mut String, by: &str, claim: &Claim, failure: Option<Failure>) {
    let mark = match failure {
        Some(Failure::Dangerous) => "WRONG",
        Some(Failure::Needless) => "wrong",
        None => "",
    };
    // What would make it pass is for `haptic certify` to say.
    let because = claim.because.split("; it would pass").next().unwrap_or_default();
    let _ = writeln!(text, "  {by:<38} {:<9} {mark:<5}  {because}", claim.says.as_str());
}

fn seen(text: &mut String, trials: &[Seen]) {
    for Seen { what, simulated, emulated, .. } in trials {
        let emulated = match emulated {
            None => String::new(),
            Some(Played::Refused) => "; the board refuses it".to_owned(),
            Some(Played::Ran(fate)) => format!("; emulated, {fate}"),
        };
        let _ = writeln!(text, "  run: {what:<42}   simulated, {simulated}{emulated}");
    }
}

fn wall(wall: &WallReport) -> String {
    let WallReport { delay, limit, hand, trials } = wall;
    let number = |value: f64| significant(value, 5);
    let mut text = format!(
        "a wall {delay} samples late: certified up to {} N m/rad; worst in a hand of {} kg m^2, \
         {} N m s/rad and {} N m/rad\n",
        number(*limit),
        number(hand.hand.inertia),
        number(hand.hand.damping),
        number(hand.hand.stiffness),
    );
    seen(&mut text, trials);
    text
}

/// One row a claim, the certificate's and the truth among them.
fn csv(cases: &[CaseReport]) -> Result<(), CommandError> {
    let mut table = csv::Writer::from_writer(io::stdout().lock());
    let failed = |error: csv::Error| CommandError::Output(error.into());
    table.write_record(["case", "by", "says", "failure", "figure", "because"]).map_err(failed)?;
    for case in cases {
        let judged = case.claims.iter().map(|judged| (&judged.claim, judged.failure));
        for (claim, failure) in judged.chain([(&case.certificate, None), (&case.truth, None)]) {
            let failure = match failure {
                Some(Failure::Dangerous) => "dangerous",
                Some(Failure::Needless) => "needless",
                None => "",
            };
            let figure = claim.figure.map(|figure| figure.to_string()).unwrap_or_default();
            let row = [case.name, &claim.by, claim.says.as_str(), failure, &figure, &claim.because];
            table.write_record(row).map_err(failed)?;
        }
    }
    Ok(table.flush()?)
}
