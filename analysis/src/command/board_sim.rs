//! `haptic board-sim`: a simulated board, to try `tune` and `scope` without hardware.

use std::io::{self, Write};
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

use super::file_program::FileProgram;
use super::file_scene::scene_file;
use super::status::{CommandError, CommandStatus};
use super::value_parsers::seconds;
use super::virtual_board_build::VirtualBoardBuild;
use crate::board_sim::{self, DrivingBoard, Pacing, SimulatedBoard};
use crate::file::SceneFile;
use crate::hand::HandTrajectory;
use crate::link::Address;
use crate::lockstep::SimulatedDevice;
use crate::program::Program;
use crate::shaft::HandHeldShaft;
use crate::terminal;
use crate::toolchain::{BoardModel, NumberFormat};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a scene's program in firmware/src/bin, for example damper_wall, or a scene file
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Address to listen on: tcp://HOST:PORT, unix:PATH
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Run the program as flashed, on a virtual board (nucleo-g474re, b-g431b-esc1, feather-stm32f405);
    /// default: a thread with the same servo
    #[arg(long, value_name = "BOARD", value_parser = BoardModel::find)]
    pub board: Option<BoardModel>,
    /// End after this number of seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds,
          allow_negative_numbers = true)]
    pub duration: Option<Duration>,
}

/// Duration in s for which the hand's trajectory is repeated: an hour.
const HAND_DURATION: f64 = 3600.0;

/// Longest time between two polls for the end.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Runs a program, or the scene of a file, in a simulated hand until the time is up, Ctrl-C, or a signal to end.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let name = &arguments.scene;
    let enough = terminal::interrupted()?;
    let board = match Program::find(name) {
        Some(program) => of_program(program, arguments)?,
        None => of_file(&scene_file(name)?, arguments)?,
    };
    writeln!(io::stdout(), "{name} listens on {}", board.address())?;
    let end = arguments.duration.map(|duration| Instant::now() + duration);
    let is_over = || enough.load(Ordering::Relaxed) || end.is_some_and(|end| Instant::now() >= end);
    while !board.has_ended() && !is_over() {
        thread::sleep(POLL_INTERVAL);
    }
    board.end().map_err(|end| CommandError::Failed(end))?;
    Ok(CommandStatus::Success)
}

fn of_program(
    program: &'static Program,
    arguments: &Arguments,
) -> Result<SimulatedBoard, CommandError> {
    let Program { scene, transducers, .. } = program;
    let hand = (program.trajectory)().repeated_until(HAND_DURATION);
    if let Some(board) = arguments.board {
        let built = VirtualBoardBuild::build(board, program, NumberFormat::F32)?;
        return on_virtual_board(&built, scene, transducers, hand, &arguments.port);
    }
    let device = Box::new(SimulatedDevice::new(scene, hand, transducers)?);
    listening(program.listen(device, &arguments.port, Pacing::RealTime), &arguments.port)
}

fn of_file(file: &SceneFile, arguments: &Arguments) -> Result<SimulatedBoard, CommandError> {
    let Some(board) = arguments.board else {
        return Ok(SimulatedBoard::of_file(file, &arguments.port, Pacing::RealTime)?);
    };
    let program = FileProgram::of(file, &arguments.scene, None, None)?;
    let built = VirtualBoardBuild::of_file(board, &program, NumberFormat::F32)?;
    let hand = HandTrajectory::for_environment(&file.scene.environment);
    let hand = hand.repeated_until(HAND_DURATION);
    on_virtual_board(&built, &file.scene, &file.transducers(None, None), hand, &arguments.port)
}

/// The flashed program behind its port, in a hand.
fn on_virtual_board(
    built: &VirtualBoardBuild,
    scene: &Scene,
    transducers: &Transducers,
    hand: HandTrajectory,
    address: &Address,
) -> Result<SimulatedBoard, CommandError> {
    let board = if let Some((board, current_loop)) = built.boot_bridge()? {
        let shaft = HandHeldShaft::new(scene, hand, transducers, current_loop)?;
        DrivingBoard::Bridge { board: Box::new(board), shaft: Box::new(shaft) }
    } else {
        let plant = Box::new(SimulatedDevice::new(scene, hand, transducers)?);
        DrivingBoard::Dac { board: built.boot()?, plant, count: None }
    };
    listening(board_sim::listen(board, address, scene.timing.period), address)
}

fn listening(
    board: io::Result<SimulatedBoard>,
    address: &Address,
) -> Result<SimulatedBoard, CommandError> {
    board.map_err(|source| CommandError::Listen { address: address.clone(), source })
}
