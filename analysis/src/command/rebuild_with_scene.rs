//! Scenes that this program was not built with: it builds itself once more, with the scene's file, and
//! hands over to that. What runs on this machine is then compiled from the file that a board's program
//! is compiled from.

use std::os::unix::process::CommandExt;
use std::process;

use super::status::{CommandError, CommandStatus};
use crate::program::Program;
use crate::progress;
use crate::toolchain::{Sources, build_haptic_with};

/// Whether a name is that of a scene that this program was built without.
pub fn needs_rebuild(name: &str) -> bool {
    // Without its source this program has the scenes that it was built with.
    let is_there = || Sources::find().and_then(|sources| sources.scenes()).unwrap_or_default();
    Program::find(name).is_none() && is_there().iter().any(|scene| scene == name)
}

/// Builds a program that has the scene, and replaces this process by it, with the same arguments.
pub fn rebuild_and_exec(scene: &str) -> Result<CommandStatus, CommandError> {
    let spinner = progress::spinner(&format!("building {scene} for this machine"));
    let program = build_haptic_with(scene)?;
    spinner.finish_and_clear();
    let error = process::Command::new(program).args(std::env::args_os().skip(1)).exec();
    Err(CommandError::Output(error))
}

/// The scenes that there are, for a sentence: those with a file, or else those in this program.
pub fn scenes() -> String {
    let built_in = || crate::program::NAMES.iter().map(|name| (*name).to_owned()).collect();
    let there = Sources::find().and_then(|sources| sources.scenes());
    there.unwrap_or_else(|_| built_in()).join(", ")
}
