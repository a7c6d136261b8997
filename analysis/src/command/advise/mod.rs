//! `haptic advise`: the cheapest number format, or the simplest device model, that is sufficient for a scene;
//! and what a device makes possible.

mod device;
mod format;
mod model;
mod report;

use clap::{Args, Subcommand};

use super::shared_arguments::JsonOption;
use super::status::{CommandError, CommandStatus};

/// Arguments of `haptic advise`: about a number format, or about a model of the device.
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    override_usage = "haptic advise <SCENE> --max-limit-cycle <TORQUE> --rate <HZ> [OPTIONS]\n       \
                            haptic advise <SCENE> --model [OPTIONS]\n       \
                            haptic advise device <FILE> [OPTIONS]"
)]
pub struct Arguments {
    #[command(subcommand)]
    pub question: Option<Question>,
    /// Name of a program in firmware/src/bin, for example damper_wall, or a scene file; with
    /// `--model` a scene file
    #[arg(value_name = "SCENE", required = true)]
    pub scene: Option<String>,
    #[command(flatten)]
    pub model: model::ModelArguments,
    #[command(flatten)]
    pub format: Option<format::FormatArguments>,
    #[command(flatten)]
    pub answer: JsonOption,
}

/// A question without a scene.
#[derive(Debug, Subcommand)]
pub enum Question {
    /// The stiffest wall, the torque error at rest and the detents that a device makes possible, and what to
    /// change first
    Device(device::Arguments),
}

pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    if let Some(Question::Device(device)) = &arguments.question {
        return device::run(device, &arguments.answer);
    }
    // Without a question there is a scene.
    let scene = arguments.scene.as_deref().unwrap_or_default();
    match &arguments.format {
        Some(format) => format::run(scene, format, &arguments.answer),
        None => model::run(scene, &arguments.model, &arguments.answer),
    }
}
