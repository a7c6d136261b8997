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
use super::identify;
use super::status::{CommandError, CommandStatus};
use super::value_parsers::seconds;
use super::virtual_board_build::VirtualBoardBuild;
use crate::board_sim::{self, DrivingBoard, Pacing, SimulatedBoard};
use crate::disturbance::Disturbance;
use crate::file::{self, SceneFile};
use crate::hand::HandTrajectory;
use crate::identify::rig::DrivenDevice;
use crate::link::Address;
use crate::lockstep::SimulatedDevice;
use crate::missed::Missed;
use crate::program::Program;
use crate::program::identify::{PERIOD, TRANSDUCERS};
use crate::shaft::HandHeldShaft;
use crate::terminal;
use crate::toolchain::{BoardModel, NumberFormat};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a program in firmware/src/bin, for example damper_wall, or a scene file, whose table `human` is the
    /// hand. The programs identify and turns, which measure a device, need --board
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Address to listen on: tcp://HOST:PORT, unix:PATH
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Run the program as flashed, on a virtual board (nucleo-g474re, b-g431b-esc1, feather-stm32f405);
    /// default: a thread with the same servo
    #[arg(long, value_name = "BOARD", value_parser = BoardModel::find)]
    pub board: Option<BoardModel>,
    /// With identify or turns: the device, encoder and motor of this file in place of the paddle
    #[arg(long, value_name = "FILE.toml")]
    pub device: Option<String>,
    /// End after this number of seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds,
          allow_hyphen_values = true)]
    pub duration: Option<Duration>,
}

/// Duration in s for which the hand's trajectory is repeated: an hour.
const HAND_DURATION: f64 = 3600.0;

/// Longest time between two polls for the end.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Runs a program or a scene file in a simulated hand until the time is up, Ctrl-C, or a signal to end.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let Arguments { scene: name, port, board, .. } = arguments;
    let enough = terminal::interrupted()?;
    let board = match Program::find(name) {
        _ if MEASURING.contains(&name.as_str()) => measuring(arguments)?,
        _ if arguments.device.is_some() => {
            let error = format!(
                "--device is for the programs that measure it, {}",
                MEASURING.join(" and ")
            );
            return Err(CommandError::Failed(error.into()));
        }
        Some(program) => of_program(program, *board, port)?,
        None => of_file(&scene_file(name)?, name, *board, port)?,
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

/// The programs that measure a device, by a board's DAC.
const MEASURING: [&str; 2] = ["identify", "turns"];

/// Such a program on a virtual board with the device that it measures.
fn measuring(arguments: &Arguments) -> Result<SimulatedBoard, CommandError> {
    let Arguments { scene: name, port, board, device: source, .. } = arguments;
    let Some(board) = *board else {
        let error = format!(
            "{name} measures a device, which only the flashed program does: add --board NAME"
        );
        return Err(CommandError::Failed(error.into()));
    };
    let file =
        source.as_deref().map(|source| Ok::<_, CommandError>((source, file::load_device(source)?)));
    let file = file.transpose()?;
    let (built, transducers) = match &file {
        Some((source, file)) => {
            let program = FileProgram::on_device(name, source, file)?;
            let built = VirtualBoardBuild::of_file(board, &program, NumberFormat::F32)?;
            (built, file.transducers.or_defaults())
        }
        None => (VirtualBoardBuild::named(board, name, None, NumberFormat::F32)?, TRANSDUCERS),
    };
    let file = file.as_ref().map(|(_, file)| file);
    let device = identify::target::device(file, &identify::target::sensing(file, &transducers))?;
    let plant = DrivenDevice { device, full_scale: transducers.full_scale_torque };
    let board = DrivingBoard::Dac { board: built.boot()?, plant: Box::new(plant), count: None };
    board_sim::listen(board, port, PERIOD).map_err(not_listening(port))
}

/// A program behind its port.
fn of_program(
    program: &'static Program,
    board: Option<BoardModel>,
    port: &Address,
) -> Result<SimulatedBoard, CommandError> {
    let &Program { scene, transducers, .. } = program;
    let hand = (program.trajectory)().repeated_until(HAND_DURATION);
    let (disturbance, dropped) = (Disturbance::default(), Missed::None);
    let surroundings = Surroundings { scene, transducers, hand, disturbance, dropped };
    let Some(board) = board else {
        let listening = program.listen(surroundings.device()?, port, Pacing::RealTime);
        return listening.map_err(not_listening(port));
    };
    surroundings.around(&VirtualBoardBuild::build(board, program, NumberFormat::F32)?, port)
}

/// A scene file behind its port.
fn of_file(
    file: &SceneFile,
    source: &str,
    board: Option<BoardModel>,
    port: &Address,
) -> Result<SimulatedBoard, CommandError> {
    file.scene.certify().map_err(|_| CommandError::of_rejected(file))?;
    let Some(board) = board else {
        return Ok(SimulatedBoard::of_file(file, port, Pacing::RealTime)?);
    };
    let program = FileProgram::of(file, source, None, None)?;
    let dropped = file.dropped();
    program.check_dropped(dropped != Missed::None)?;
    let built = VirtualBoardBuild::of_file(board, &program, NumberFormat::F32)?;
    let (scene, transducers) = (file.scene, file.transducers(None, None));
    let hand = file.demonstration().repeated_until(HAND_DURATION);
    let disturbance = file.disturbance();
    Surroundings { scene, transducers, hand, disturbance, dropped }.around(&built, port)
}

/// The device and the hand around a board.
struct Surroundings {
    scene: Scene,
    transducers: Transducers,
    hand: HandTrajectory,
    disturbance: Disturbance,
    /// Readings of the encoder that fail.
    dropped: Missed,
}

impl Surroundings {
    /// Behind a DAC.
    fn device(self) -> Result<Box<SimulatedDevice>, CommandError> {
        let device = SimulatedDevice::new(&self.scene, self.hand, &self.transducers)?;
        Ok(Box::new(device.with_disturbance(self.disturbance).failing(self.dropped)))
    }

    /// A virtual board with them behind its port.
    fn around(
        self,
        built: &VirtualBoardBuild,
        port: &Address,
    ) -> Result<SimulatedBoard, CommandError> {
        let period = self.scene.timing.period;
        let board = if let Some((board, current_loop)) = built.boot_bridge()? {
            let Self { scene, transducers, hand, disturbance, dropped } = self;
            let shaft = HandHeldShaft::new(&scene, hand, &transducers, current_loop)?;
            let shaft = Box::new(shaft.with_disturbance(disturbance).failing(dropped));
            DrivingBoard::Bridge { board: Box::new(board), shaft }
        } else {
            DrivingBoard::Dac { board: built.boot()?, plant: self.device()?, count: None }
        };
        board_sim::listen(board, port, period).map_err(not_listening(port))
    }
}

fn not_listening(port: &Address) -> impl FnOnce(io::Error) -> CommandError {
    |source| CommandError::Listen { address: port.clone(), source }
}
