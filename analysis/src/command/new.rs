//! `haptic new`: copies a scene's program.

use std::io::{self, Write};

use clap::Args;

use super::status::{CommandError, CommandStatus};
use crate::toolchain::Sources;

/// Arguments of `haptic new`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of the new scene: lower-case letters, digits and underscores
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Scene to copy
    #[arg(long, value_name = "SCENE", default_value = "damper_wall")]
    pub from: String,
}

/// Writes the scene's file, and prints its path and the next steps.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let Arguments { name, from } = arguments;
    let path = Sources::find()?.begin(name, from)?;
    writeln!(
        io::stdout(),
        "{path}\n  \
         is a copy of {from}: change its environment, and then\n  \
         cargo haptic run {name}                               on this machine\n  \
         cargo haptic run {name} --target board:nucleo-g474re  as flashed, on a virtual board\n  \
         cargo haptic flash {name} --board nucleo-g474re       on a board",
        path = path.display(),
    )?;
    Ok(CommandStatus::Success)
}
