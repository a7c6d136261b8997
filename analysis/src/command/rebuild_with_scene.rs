//! Scenes that this program was built without: it builds itself again with the scene's file, and executes the
//! new program. The code on this machine is then compiled from the same file as a board's program.

use std::os::unix::process::CommandExt;
use std::process;

use super::building::building;
use super::status::{CommandError, CommandStatus};
use crate::program::Program;
use crate::toolchain::{Sources, build_haptic_with};

/// Whether this program was built without the scene of this name.
pub fn needs_rebuild(name: &str) -> bool {
    // Without its source, this program only has the scenes that it was built with.
    let is_there = || Sources::find().and_then(|sources| sources.scenes()).unwrap_or_default();
    Program::find(name).is_none() && is_there().iter().any(|scene| scene == name)
}

/// Builds a program that has the scene, and replaces this process by it, with the same arguments.
pub fn rebuild_and_exec(scene: &str) -> Result<CommandStatus, CommandError> {
    let program = building(&format!("{scene} for this machine"), || build_haptic_with(scene))?;
    let error = process::Command::new(program).args(std::env::args_os().skip(1)).exec();
    Err(CommandError::Output(error))
}

/// The available scenes as text: those with a file, or otherwise those in this program.
pub fn scenes() -> String {
    let built_in = || crate::program::NAMES.iter().map(|name| (*name).to_owned()).collect();
    let there = Sources::find().and_then(|sources| sources.scenes());
    there.unwrap_or_else(|_| built_in()).join(", ")
}
