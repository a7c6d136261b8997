//! `haptic flash`: builds the program of a scene, or of a scene file, for a board and flashes it.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use haptic_servo::scene::Device;

use super::building::{building, set_up};
use super::file_program::FileProgram;
use super::file_scene::{is_file, scene_file};
use super::status::{CommandError, CommandStatus};
use crate::file;
use crate::program::{self, Program, damper_wall};
use crate::toolchain::{BoardModel, Memory, NumberFormat, Sources, Tools, TorqueOutput, probe};

/// Arguments of `haptic flash`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file, or name of a program in firmware/src/bin, for example damper_wall or identify
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Board to build for: nucleo-g474re, b-g431b-esc1 or feather-stm32f405
    #[arg(long, value_parser = BoardModel::find)]
    pub board: BoardModel,
    /// What makes the torque: the board's DAC, for an amplifier outside, or its own bridge; by default what
    /// the program or the file is for
    #[arg(long, value_enum)]
    pub output: Option<TorqueOutput>,
    /// Number format of the servo
    #[arg(long, value_enum, default_value_t = NumberFormat::F32)]
    pub format: NumberFormat,
    /// With a program of the examples: the device, encoder and motor of this file in place of the paddle
    #[arg(long, value_name = "FILE.toml", conflicts_with = "example_device")]
    pub device: Option<String>,
    /// Flash a program or a scene for a device of the examples, not for yours
    #[arg(long)]
    pub example_device: bool,
    /// Build only: print sizes and path of the program, and flash nothing
    #[arg(long)]
    pub build_only: bool,
    /// Debug probe, if there are several: VID:PID or VID:PID:SERIAL
    #[arg(long, value_name = "PROBE")]
    pub probe: Option<String>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let (board, name) = (arguments.board, arguments.scene.as_str());
    let file = written(arguments)?;
    let toolchain = set_up(Tools::Compiler)?;
    let output = match (arguments.output, &file) {
        (Some(output), _) => output,
        (None, Some(file)) => file.output(),
        (None, None) => toolchain.output_of(name)?,
    };
    let program = match &file {
        Some(file) => file.build(&toolchain, Some(board), arguments.format)?,
        None => {
            let build = || toolchain.build_for(board, output, &[name], arguments.format);
            building(&format!("{name} for {board}"), build)?.swap_remove(0)
        }
    };
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

/// The program that is written for a file, or none for a program as it is in `firmware/src/bin`.
fn written(arguments: &Arguments) -> Result<Option<FileProgram>, CommandError> {
    let name = &arguments.scene;
    let program = match &arguments.device {
        Some(file) if is_file(name) => {
            let error =
                format!("{name} is a file with its own device: --device {file} is for a program");
            Err(CommandError::Failed(error.into()))
        }
        Some(file) => {
            let device = file::load_device(file)?;
            check_device(arguments, Some(device.device))?;
            FileProgram::on_device(name, file, &device).map(Some)
        }
        None if is_file(name) => {
            let file = scene_file(name)?;
            check_device(arguments, Some(file.scene.device))?;
            FileProgram::of(&file, name, None, None).map(Some)
        }
        None => {
            // The programs that measure a device have no scene, but the paddle's encoder and motor.
            let paddle = ["identify", "turns"].contains(&name.as_str());
            let paddle = paddle.then_some(damper_wall::SCENE.device);
            let device = Program::find(name).map(|program| program.scene.device);
            check_device(arguments, device.or(paddle))?;
            Ok(None)
        }
    }?;
    match (&program, arguments.output) {
        (Some(program), Some(output)) if output != program.output() => {
            Err(CommandError::FileForOther { file: name.clone(), output: program.output() })
        }
        _ => Ok(program),
    }
}

/// Refuses the device of an example, or only says so if nothing is flashed.
fn check_device(arguments: &Arguments, device: Option<Device>) -> Result<(), CommandError> {
    if arguments.example_device || !device.is_some_and(|device| program::is_example(&device)) {
        return Ok(());
    }
    let scene = arguments.scene.clone();
    let way = if is_file(&scene) {
        "Write yours into it"
    } else if Sources::find()?.takes_device(&scene) {
        "Name the file of yours with --device FILE.toml"
    } else {
        "Write yours, with its motor, into the module that the program takes it from, in firmware/src/bin"
    };
    let example = CommandError::ExampleDevice { scene, way };
    if !arguments.build_only {
        return Err(example);
    }
    Ok(writeln!(io::stderr(), "note: {example}")?)
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
