//! `haptic twin`: a board that is a thread of this program, to try `tune` and `scope` on.

use std::io::{self, Write};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use clap::Args;

use super::{Answer, CommandError, seconds};
use crate::link::Address;
use crate::program::{self, Program};
use crate::rig::SimulatedDevice;
use crate::twin::Clock;

/// Arguments of `haptic twin`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a program: delayed_spring, damper_wall, free_mode
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Where it listens: tcp://HOST:PORT, unix:PATH
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// End after so many seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds,
          allow_negative_numbers = true)]
    pub duration: Option<Duration>,
}

/// What a hand does goes on for so many seconds: an hour.
const SCRIPT: f64 = 3600.0;

/// Runs a program in a simulated hand until the time is up or Ctrl-C.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let name = &arguments.scene;
    let program = Program::find(name).ok_or_else(|| {
        let programs = program::ALL.iter().map(|program| program.name).collect::<Vec<_>>();
        CommandError::NoScene { name: name.clone(), programs: programs.join(", ") }
    })?;
    let (enough, wait) = mpsc::channel();
    ctrlc::set_handler(move || {
        // Asked more than once, it ends as well.
        let _ = enough.send(());
    })
    .map_err(io::Error::other)?;
    let script = (program.script)().over_and_over(SCRIPT);
    let (device, period) = (program.scene.device, program.scene.timing.period);
    let device = SimulatedDevice::new(device, script, period, &program.transducers)?;
    let twin = program
        .listen(Box::new(device), &arguments.port, Clock::Real)
        .map_err(|source| CommandError::Listen { address: arguments.port.clone(), source })?;
    writeln!(io::stdout(), "{name} listens on {}", twin.address())?;
    match arguments.duration {
        Some(duration) => match wait.recv_timeout(duration) {
            Ok(()) | Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {}
        },
        // An error would be that nobody can say that it is enough.
        None => drop(wait.recv()),
    }
    twin.end().map_err(CommandError::Render)?;
    Ok(Answer::Yes)
}
