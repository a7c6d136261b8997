//! `haptic advise`: how little is enough for a scene?

mod format;

use clap::Args;

use super::common::ForWhom;
use super::{Answer, CommandError};

/// Arguments of `haptic advise`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a program (delayed_spring, damper_wall, free_mode) or a scene file
    #[arg(value_name = "SCENE")]
    pub scene: String,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub format: format::Wanted,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub answer: ForWhom,
}

/// Advises.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    format::run(&arguments.scene, &arguments.format, &arguments.answer)
}
