//! `haptic board-sim`: a simulated board, to try `tune` and `scope` without hardware.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use signal_hook::consts::{SIGINT, SIGTERM};

use super::answer::{Answer, CommandError};
use super::flashed::Flashed;
use super::own;
use super::values::seconds;
use crate::link::Address;
use crate::program::Program;
use crate::rig::SimulatedDevice;
use crate::toolchain::{Board, NumberFormat};
use crate::twin::{Clock, Twin};

/// Arguments of `haptic board-sim`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a scene's program in firmware/src/bin, for example damper_wall
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Address to listen on: tcp://HOST:PORT, unix:PATH
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Run the program as flashed, on a virtual board (nucleo-g474re, b-g431b-esc1, stm32f405);
    /// default: a thread with the same servo
    #[arg(long, value_name = "BOARD", value_parser = Board::find)]
    pub board: Option<Board>,
    /// End after this number of seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds,
          allow_negative_numbers = true)]
    pub duration: Option<Duration>,
}

/// What a hand does goes on for so many seconds: an hour.
const SCRIPT: f64 = 3600.0;

/// Longest time between two looks at what has ended.
const LOOK: Duration = Duration::from_millis(50);

/// Runs a program in a simulated hand until the time is up, Ctrl-C, or it is told to end.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let name = &arguments.scene;
    let program = Program::find(name).ok_or_else(|| no_program(name))?;
    let enough = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, enough.clone())?;
    }
    let script = (program.script)().over_and_over(SCRIPT);
    let (device, period) = (program.scene.device, program.scene.timing.period);
    let device = SimulatedDevice::new(device, script, period, &program.transducers)?;
    let (device, address) = (Box::new(device), &arguments.port);
    let twin = match arguments.board {
        None => program.listen(device, address, Clock::Real),
        Some(board) => {
            let built = Flashed::build(board, program.name, NumberFormat::F32)?;
            Twin::of_board(built.boot()?, device, address, Clock::Real, period)
        }
    };
    let twin = twin.map_err(|source| CommandError::Listen { address: address.clone(), source })?;
    writeln!(io::stdout(), "{name} listens on {}", twin.address())?;
    let end = arguments.duration.map(|duration| Instant::now() + duration);
    let is_over = || enough.load(Ordering::Relaxed) || end.is_some_and(|end| Instant::now() >= end);
    while !twin.has_ended() && !is_over() {
        thread::sleep(LOOK);
    }
    twin.end()?;
    Ok(Answer::Yes)
}

/// Why there is no twin of that name: a scene file may have been meant.
fn no_program(name: &str) -> CommandError {
    let (name, programs) = (name.to_owned(), own::scenes());
    match Path::new(&name).is_file() {
        true => CommandError::FileOnTwin { file: name, programs },
        false => CommandError::NoProgram { name, programs },
    }
}
