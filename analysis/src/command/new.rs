//! `haptic new`: copies a scene's program, or writes that of a scene file.

use std::io::{self, Write};

use clap::Args;

use super::file_program::{FileProgram, other_device};
use super::file_scene::{is_file, scene_file};
use super::status::{CommandError, CommandStatus};
use crate::file;
use crate::toolchain::{BoardModel, Sources};

/// Arguments of `haptic new`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of the new scene: lower-case letters, digits and underscores
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Scene to copy: a program in firmware/src/bin, or a scene file, whose device, encoder, motor and
    /// environment become constants
    #[arg(long, value_name = "SCENE", default_value = "damper_wall")]
    pub from: String,
    /// With a program: the device of this file in place of the paddle of the examples
    #[arg(long, value_name = "FILE.toml")]
    pub device: Option<String>,
}

/// Writes the scene's file, and prints its path and the next steps.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let Arguments { name, from, device } = arguments;
    let sources = Sources::find()?;
    let mut board = BoardModel::NucleoG474re;
    let (text, begun) = if is_file(from) {
        if device.is_some() {
            let error = format!("{from} is a file with its own device: --device is for a program");
            return Err(CommandError::Failed(error.into()));
        }
        let file = scene_file(from)?;
        let program = FileProgram::of(&file, from, None, None)?;
        file.scene.certify().map_err(|_| CommandError::FileNotBuilt {
            file: from.clone(),
            why: Box::new(CommandError::of_rejected(&file)),
            is_certified: false,
        })?;
        if program.bridge.is_some() {
            board = BoardModel::BG431bEsc1;
        }
        (program.text, format!("is the program of {from}, with its numbers as constants:"))
    } else {
        let device = device.as_ref().map(|file| other_device(file, &file::load_device(file)?));
        (
            sources.copied(name, from, device.transpose()?.as_ref())?,
            format!("is a copy of {from}: change its environment, and then"),
        )
    };
    let path = sources.begin(name, &text)?;
    writeln!(
        io::stdout(),
        "{path}\n  \
         {begun}\n  \
         cargo haptic run {name}                               on this machine\n  \
         cargo haptic run {name} --target board:{board:<14} as flashed, on a virtual board\n  \
         cargo haptic flash {name} --board {board:<19} on a board",
        path = path.display(),
    )?;
    Ok(CommandStatus::Success)
}
