//! `haptic advise`: the cheapest number format, or the simplest device model, that is sufficient for a scene.

mod format;
mod model;
mod report;

use clap::Args;

use super::shared_arguments::JsonOption;
use super::status::{CommandError, CommandStatus};

/// Arguments of `haptic advise`: about a number format, or about a model of the device.
#[derive(Debug, Args)]
#[command(
    override_usage = "haptic advise <SCENE> --max-limit-cycle <TORQUE> --rate <HZ> [OPTIONS]\n       \
                            haptic advise <SCENE> --model [OPTIONS]"
)]
pub struct Arguments {
    /// Name of a program in firmware/src/bin, for example damper_wall, or a scene file; with
    /// `--model` a scene file
    #[arg(value_name = "SCENE")]
    pub scene: String,
    #[command(flatten)]
    pub model: model::ModelArguments,
    #[command(flatten)]
    pub format: Option<format::FormatArguments>,
    #[command(flatten)]
    pub answer: JsonOption,
}

pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    match &arguments.format {
        Some(format) => format::run(&arguments.scene, format, &arguments.answer),
        None => model::run(&arguments.scene, &arguments.model, &arguments.answer),
    }
}
