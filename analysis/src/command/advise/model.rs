//! `haptic advise --model`: the simplest sufficient model of the device.

use clap::Args;

use crate::command::shared_arguments::{JsonOption, folder};
use crate::command::status::{CommandError, CommandStatus};
use crate::file::{Purpose, load_for};
use crate::quantity::significant;
use crate::studies::model::{Advice, Deviation, JudgedModel, advise, percent};
use crate::text_table::markdown_table;

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
          allow_negative_numbers = true, requires = "model")]
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
    let advice = advise(&file, folder(scene), arguments.bound)?;
    answer.print(&advice, text)?;
    Ok(CommandStatus::Success)
}

fn text(advice: &Advice) -> String {
    let mut table = markdown_table(
        [
            "model",
            "states",
            "steps/s",
            "certificate",
            "stability",
            "delta",
            "critical stiffness",
            "angle",
            "torque",
            "beyond the bound",
        ],
        [1, 2, 5, 6, 7, 8],
    );
    for judged in &advice.models {
        table.add_row(row(judged));
    }
    let reason = advice.no_certificate.as_ref();
    let no_certificate = reason
        .map_or_else(String::new, |reason| format!("\nno certificate to compare with: {reason}\n"));
    format!("scene  {}\n\n{table}\n{no_certificate}\n{}\n", advice.scene, advice.message)
}

/// A row of numbers with their errors in brackets.
fn row(judged: &JudgedModel) -> [String; 10] {
    let JudgedModel { model, result, deviation, beyond, .. } = judged;
    let Deviation { delta, critical_stiffness, angle, torque } = *deviation;
    let number = |value: Option<f64>, off: Option<f64>| match (value, off) {
        (None, _) => "none".to_owned(),
        (Some(value), None) => significant(value, 6),
        (Some(value), Some(off)) => format!("{} ({})", significant(value, 6), percent(off)),
    };
    [
        model.clone(),
        result.states.to_string(),
        significant(result.steps_per_second, 2),
        result.certificate.map_or_else(|| "none".to_owned(), |verdict| verdict.to_string()),
        result.stability.to_string(),
        number(result.delta, delta),
        number(result.critical_stiffness, critical_stiffness),
        percent(angle),
        percent(torque),
        beyond.join(", "),
    ]
}
