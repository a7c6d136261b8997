//! Sets up tools and builds programs for a command, with its messages.

use std::path::PathBuf;

use super::status::CommandError;
use crate::progress;
use crate::toolchain::{self, BuildError, NumberFormat, Toolchain, Tools};

/// Sets up tools, and prints each step.
pub fn set_up(tools: Tools) -> Result<Toolchain, CommandError> {
    Ok(toolchain::prepare(tools)?)
}

/// Builds something behind a spinner with its name.
pub fn building<T>(
    what: &str,
    build: impl FnOnce() -> Result<T, BuildError>,
) -> Result<T, CommandError> {
    let spinner = progress::spinner(&format!("building {what}"));
    let built = build()?;
    spinner.finish_and_clear();
    Ok(built)
}

/// Builds a program for the emulated board, after installing missing tools.
pub fn emulated(name: &str, format: NumberFormat) -> Result<PathBuf, CommandError> {
    let toolchain = set_up(Tools::CompilerAndEmulator)?;
    building(name, || toolchain.build_scene(name, format))
}
