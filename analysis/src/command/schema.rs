//! `haptic schema`: the format of scene files as a JSON schema, a reference, and an example.

use std::io::{self, Write};

use clap::Args;

use super::status::{CommandError, CommandStatus};
use crate::file::{example, reference, schema};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Print a commented scene file that certifies
    #[arg(long, value_name = "TYPE", conflicts_with = "reference",
          value_parser = clap::builder::PossibleValuesParser::new(example::names()))]
    pub example: Option<String>,
    /// Print the reference of all keys, as in SCENE.md
    #[arg(long)]
    pub reference: bool,
}

/// Prints the JSON schema, or the requested alternative.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let text = match &arguments.example {
        // The command line accepts no other name.
        Some(name) => example::toml(name).unwrap_or_default(),
        None if arguments.reference => reference::markdown(),
        None => format!("{:#}\n", schema::json()),
    };
    io::stdout().lock().write_all(text.as_bytes())?;
    Ok(CommandStatus::Success)
}
