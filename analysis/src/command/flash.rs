//! `haptic flash`: builds a scene's program for a board and flashes it.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;

use super::building::{building, set_up};
use super::status::{CommandError, CommandStatus};
use crate::toolchain::{BoardModel, Memory, NumberFormat, Tools, TorqueOutput, probe};

/// Arguments of `haptic flash`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a program in firmware/src/bin, for example damper_wall or identify
    #[arg(value_name = "PROGRAM")]
    pub program: String,
    /// Board to build for: nucleo-g474re, b-g431b-esc1 or feather-stm32f405
    #[arg(long, value_parser = BoardModel::find)]
    pub board: BoardModel,
    /// What makes the torque: the board's DAC, for an amplifier outside, or its own bridge; by default what
    /// the program's scene is certified with
    #[arg(long, value_enum)]
    pub output: Option<TorqueOutput>,
    /// Number format of the servo
    #[arg(long, value_enum, default_value_t = NumberFormat::F32)]
    pub format: NumberFormat,
    /// Build only: print sizes and path of the program, and flash nothing
    #[arg(long)]
    pub build_only: bool,
    /// Debug probe, if there are several: VID:PID or VID:PID:SERIAL
    #[arg(long, value_name = "PROBE")]
    pub probe: Option<String>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let toolchain = set_up(Tools::Compiler)?;
    let (board, name) = (arguments.board, arguments.program.as_str());
    let output = arguments.output.map_or_else(|| toolchain.output_of(name), Ok)?;
    let build = || toolchain.build_for(board, output, &[name], arguments.format);
    let program = building(&format!("{name} for {board}"), build)?.swap_remove(0);
    let chip = probe::chip(&read(&program.path)?)?;
    let (sizes, memory) = (program.sizes, toolchain.memory()?);
    let mut out = io::stdout();
    writeln!(out, "program: {}", program.path.display())?;
    writeln!(out, "chip: {chip}")?;
    if output == TorqueOutput::Bridge {
        writeln!(out, "torque: the board's bridge")?;
    }
    writeln!(out, "flash: {} of {} bytes{}", sizes.flash(), board.flash(), spared(board, memory))?;
    writeln!(out, "variables: {} of {} bytes of RAM", sizes.ram(), memory.ram)?;
    writeln!(out, "stack: {} bytes of RAM", memory.stack)?;
    writeln!(out, "fast memory: {} of {} bytes", sizes.fast, memory.fast)?;
    if !arguments.build_only {
        probe::run(&program.path, &chip, arguments.probe.as_deref())?;
    }
    Ok(CommandStatus::Success)
}

/// The part of a board's flash that the linker's map does not use, because one map fits every board.
fn spared(board: BoardModel, memory: Memory) -> String {
    match memory.flash < board.flash() {
        true => format!("; the linker's map, which fits every board, allows {}", memory.flash),
        false => String::new(),
    }
}

fn read(path: &PathBuf) -> Result<Vec<u8>, CommandError> {
    std::fs::read(path).map_err(|source| CommandError::Unwritable { path: path.clone(), source })
}
