//! `haptic certify`: is a scene safe in every hand, and by how much?

use std::io;

use clap::Args;

use super::shared_arguments::{CoefficientFormat, JsonOption, SceneArgument};
use super::status::{CommandError, CommandStatus};
use crate::batch;
use crate::quantity::significant;
use crate::terminal;
use crate::verdict::{Enclosure, Verdict, VerdictReport};

/// Arguments of `haptic certify`.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub scene: SceneArgument,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub answer: JsonOption,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub arithmetic: CoefficientFormat,
    /// Read one scene as JSON on each line of FILE, and print one result on each line, in the same
    /// order. The exit status is 0 if every line has a result, whatever the verdicts and errors are
    #[arg(long)]
    pub batch: bool,
}

/// Answers for a file or for a batch of scenes. A batch is answered with yes if it could be read:
/// each of its lines has an answer of its own.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    if arguments.batch {
        let format = arguments.arithmetic.format;
        batch::certify(&arguments.scene.file, format, &mut io::stdout().lock())?;
        return Ok(CommandStatus::Success);
    }
    let report = arguments.arithmetic.judge(&arguments.scene.load()?)?;
    let width = terminal::output_width();
    arguments.answer.print(&report, |report| terminal::wrapped(&text(report), width, VALUES))?;
    Ok(if report.verdict == Verdict::Certified {
        CommandStatus::Success
    } else {
        CommandStatus::NegativeVerdict
    })
}

/// Column at which values begin.
const VALUES: usize = 19;

/// The report for a person.
pub fn text(report: &VerdictReport) -> String {
    let mut rows = vec![
        ("scene", report.name.clone()),
        ("verdict", format!("{:?}", report.verdict).to_uppercase()),
        ("", report.message.clone()),
        ("alpha", enclosure(report.alpha)),
        ("alpha, coupled", enclosure(report.alpha_coupled)),
    ];
    if let Some(port) = report.alpha_port {
        rows.push(("alpha, at the port", enclosure(port)));
    }
    if let Some(bound) = report.bound {
        rows.push(("alpha, bound", enclosure(bound)));
    }
    rows.push(("delta", format!("{} N m s/rad", significant(report.delta, 12))));
    let margin = report.margin_in_words();
    let on_board = report.margin_on_board_in_words().filter(|_| report.board.is_none());
    let on_board = on_board.filter(|on_board| margin.as_ref() != Some(on_board));
    rows.extend(margin.map(|margin| ("margin", margin)));
    rows.extend(on_board.map(|margin| ("margin on a board", margin)));
    if let Some(theta) = report.theta {
        let degrees = theta.to_degrees();
        rows.push(("reached at", format!("theta = {theta:.6} rad ({degrees:.2} degrees)")));
    }
    rows.push(("rule of the paper", format!("{:?}", report.rules.paper).to_lowercase()));
    rows.push(("exact rule", format!("{:?}", report.rules.exact).to_lowercase()));
    rows.extend(report.format.clone().map(|format| ("rounded to", format)));
    rows.extend(report.board.clone().map(|why| ("not on a board", why)));
    list(&mut rows, "remedies", &report.remedies);
    list(&mut rows, "WARNING", &report.warnings);
    let holding = report.assumptions.iter().filter(|one| !report.warnings.contains(one));
    list(&mut rows, "assumes", &holding.cloned().collect::<Vec<_>>());
    rows.iter().map(|(label, value)| format!("{label:<18} {value}\n")).collect()
}

fn list(rows: &mut Vec<(&'static str, String)>, label: &'static str, items: &[String]) {
    for (index, item) in items.iter().enumerate() {
        rows.push((if index == 0 { label } else { "" }, item.clone()));
    }
}

/// The middle of an enclosure to the digits that are certain, and how far it reaches.
fn enclosure(enclosure: Enclosure) -> String {
    match enclosure {
        Enclosure { lo: Some(lo), hi: Some(hi) } => {
            let reach = significant(0.5 * (hi - lo), 2);
            format!("{} N m s/rad, to within {reach}", significant(0.5 * (lo + hi), 12))
        }
        _ => "does not exist".to_owned(),
    }
}
