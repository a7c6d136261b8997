//! `haptic advise --model`: the simplest sufficient model of the device.

use clap::Args;

use crate::command::shared_arguments::{JsonOption, folder};
use crate::command::status::{CommandError, CommandStatus};
use crate::file::{Purpose, load_for};
use crate::quantity::significant;
use crate::studies::model::{Advice, advise, percent};
use crate::text_table::table_of;

/// Arguments of `haptic advise --model`; the scene needs a table `simulation`.
#[derive(Debug, Args)]
pub struct ModelArguments {
    /// Find the simplest model of a scene file's device whose verdict and motion agree with the
    /// full model: rigid or with its masses, with or without the hand, with or without the
    /// amplifier's lag
    #[arg(long, conflicts_with = "FormatArguments")]
    pub model: bool,
    /// Largest relative error of delta, critical stiffness, angle and torque
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, value_parser = share,
          allow_hyphen_values = true, requires = "model")]
    pub bound: f64,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if share > 0.0 && share <= 1.0 => Ok(share),
        _ => Err(format!("`{text}` must be a number greater than 0 and at most 1")),
    }
}

/// Compares the models of the scene's device.
pub fn run(
    scene: &str,
    arguments: &ModelArguments,
    answer: &JsonOption,
) -> Result<CommandStatus, CommandError> {
    let file = load_for(Purpose::Simulate, scene)?;
    let advice = advise(&file, folder(scene), arguments.bound)
        .map_err(|error| CommandError::Failed(error.into()))?;
    answer.print(&advice, text)?;
    Ok(CommandStatus::Success)
}

fn text(advice: &Advice) -> String {
    let table = table_of(
        &advice.models,
        &[
            ("model", false, |of| of.model.clone()),
            ("states", true, |of| of.result.states.to_string()),
            ("steps/s", true, |of| significant(of.result.steps_per_second, 2)),
            ("certificate", false, |of| {
                of.result.certificate.map_or_else(|| "none".to_owned(), |it| it.to_string())
            }),
            ("stability", false, |of| of.result.stability.to_string()),
            ("delta", true, |of| number(of.result.delta, of.deviation.delta)),
            ("critical stiffness", true, |of| {
                number(of.result.critical_stiffness, of.deviation.critical_stiffness)
            }),
            ("angle", true, |of| percent(of.deviation.angle)),
            ("torque", true, |of| percent(of.deviation.torque)),
            ("beyond the bound", false, |of| of.beyond.join(", ")),
        ],
    );
    let reason = advice.no_certificate.as_ref();
    let no_certificate = reason
        .map_or_else(String::new, |reason| format!("\nno certificate to compare with: {reason}\n"));
    format!("scene  {}\n\n{table}\n{no_certificate}\n{}\n", advice.scene, advice.message)
}

/// A number with its error in brackets.
fn number(value: Option<f64>, off: Option<f64>) -> String {
    match (value, off) {
        (None, _) => "none".to_owned(),
        (Some(value), None) => significant(value, 6),
        (Some(value), Some(off)) => format!("{} ({})", significant(value, 6), percent(off)),
    }
}
