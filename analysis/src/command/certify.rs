//! `haptic certify`: whether a scene is passive in every hand, with what margin, and whether its supply bears the
//! energy that a hand returns.

use std::io;

use clap::Args;

use super::batch;
use super::shared_arguments::{CoefficientFormat, JsonOption, SceneArgument};
use super::status::{CommandError, CommandStatus};
use crate::terminal;
use crate::text_width;
use crate::verdict::VerdictReport;
use crate::verdict_text::{detailed_text, text};

/// Arguments of `haptic certify`.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub scene: SceneArgument,
    #[command(flatten)]
    pub answer: JsonOption,
    /// Print the numbers of the proof, too: the indices alpha, delta, the angle theta, both rules
    #[arg(long, short, conflicts_with = "json")]
    pub verbose: bool,
    #[command(flatten)]
    pub arithmetic: CoefficientFormat,
    /// Read one scene as JSON on each line of FILE, and print one result on each line, in the same
    /// order. The exit status is 0 if every line has a result, whatever the verdicts and errors are
    #[arg(long)]
    pub batch: bool,
}

/// Certifies a file or a batch of scenes. The status of a batch is success if it could be read: each of its
/// lines has its own result.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    if arguments.batch {
        let format = arguments.arithmetic.format;
        batch::certify(&arguments.scene.file, format, &mut io::stdout().lock())?;
        return Ok(CommandStatus::Success);
    }
    let mut report = arguments.arithmetic.judge(&arguments.scene.load()?)?;
    if !arguments.answer.json {
        // Standard error has those about numbers that no device has.
        let VerdictReport { warnings, assumptions, .. } = &mut report;
        warnings.retain(|warning| assumptions.contains(warning));
    }
    let width = terminal::output_width();
    let text = if arguments.verbose { detailed_text } else { text };
    arguments.answer.print(&report, |report| text_width::wrapped(&text(report), width, VALUES))?;
    Ok(CommandStatus::of(report.passes()))
}

/// Column at which values begin.
const VALUES: usize = 19;
