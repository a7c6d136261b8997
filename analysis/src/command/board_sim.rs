//! `haptic board-sim`: a simulated board, to try `tune` and `scope` without hardware.

use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;

use super::rebuild_with_scene;
use super::status::{CommandError, CommandStatus};
use super::value_parsers::seconds;
use super::virtual_board_build::VirtualBoardBuild;
use crate::board_sim::{self, DrivingBoard, Pacing, SimulatedBoard};
use crate::hand::HandTrajectory;
use crate::link::Address;
use crate::lockstep::SimulatedDevice;
use crate::program::Program;
use crate::shaft::HandHeldShaft;
use crate::terminal;
use crate::toolchain::{BoardModel, NumberFormat};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a scene's program in firmware/src/bin, for example damper_wall
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

/// Runs a program in a simulated hand until the time is up, Ctrl-C, or a signal to end.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let name = &arguments.scene;
    let program = Program::find(name).ok_or_else(|| no_program(name))?;
    let enough = terminal::interrupted()?;
    let trajectory = (program.trajectory)().repeated_until(HAND_DURATION);
    let built = |board| VirtualBoardBuild::build(board, program, NumberFormat::F32);
    let built = arguments.board.map(built).transpose()?;
    let address = &arguments.port;
    let board = listening(program, built.as_ref(), trajectory, address)?
        .map_err(|source| CommandError::Listen { address: address.clone(), source })?;
    writeln!(io::stdout(), "{name} listens on {}", board.address())?;
    let end = arguments.duration.map(|duration| Instant::now() + duration);
    let is_over = || enough.load(Ordering::Relaxed) || end.is_some_and(|end| Instant::now() >= end);
    while !board.has_ended() && !is_over() {
        thread::sleep(POLL_INTERVAL);
    }
    board.end().map_err(|end| CommandError::Failed(end))?;
    Ok(CommandStatus::Success)
}

/// The program behind its port, in a hand.
fn listening(
    program: &Program,
    built: Option<&VirtualBoardBuild>,
    hand: HandTrajectory,
    address: &Address,
) -> Result<io::Result<SimulatedBoard>, CommandError> {
    let Program { scene, transducers, .. } = program;
    let Some(built) = built else {
        let device = Box::new(SimulatedDevice::new(scene, hand, transducers)?);
        return Ok(program.listen(device, address, Pacing::RealTime));
    };
    let board = if let Some((board, current_loop)) = built.boot_bridge()? {
        let shaft = HandHeldShaft::new(scene, hand, transducers, current_loop)?;
        DrivingBoard::Bridge { board, shaft: Box::new(shaft) }
    } else {
        let plant = Box::new(SimulatedDevice::new(scene, hand, transducers)?);
        DrivingBoard::Dac { board: built.boot()?, plant, count: None }
    };
    let period = scene.timing.period;
    Ok(board_sim::listen(board, address, period))
}

/// The error if there is no simulated board of this name, which may be a scene file.
fn no_program(name: &str) -> CommandError {
    let (name, programs) = (name.to_owned(), rebuild_with_scene::scenes());
    match Path::new(&name).is_file() {
        true => CommandError::FileOnSimulatedBoard { file: name, programs },
        false => CommandError::NoProgram { name, programs },
    }
}
