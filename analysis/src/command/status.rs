//! Status of a command: its verdict, or an error.

use std::io;
use std::path::PathBuf;

use haptic_servo::certificate::Rejection;
use thiserror::Error;

use crate::batch::BatchError;
use crate::board_sim::SimulatedBoardError;
use crate::chart::ChartError;
use crate::compare_run::RunError;
use crate::emulator::EmulatorError;
use crate::file::FileError;
use crate::identify::IdentifyError;
use crate::identify::port::PortError;
use crate::link::{Address, LinkError};
use crate::quantity::significant;
use crate::run_csv::RunCsvError;
use crate::simulation::SimulationError;
use crate::studies::error::StudyError;
use crate::table::TableError;
use crate::toolchain::{BuildError, SetupError, SourcesError};
use crate::virtual_board::VirtualBoardError;

/// Verdict of a command, which becomes the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandStatus {
    /// Exit status 0.
    Success,
    /// Exit status 1: rejected, undecided, unstable, different.
    NegativeVerdict,
}

/// The error of a command; exit status 2.
#[derive(Debug, Error)]
pub enum CommandError {
    /// An invalid scene file.
    #[error(transparent)]
    File(#[from] FileError),
    /// A record that identifies nothing.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// A board's sweep gives no record.
    #[error(transparent)]
    Sweep(#[from] PortError),
    /// No program and no file of that name.
    #[error("there is no scene {name}: the programs are {programs}, and there is no such file")]
    NoScene {
        /// The requested name.
        name: String,
        /// The available programs.
        programs: String,
    },
    /// No program of that name, and the command needs a program.
    #[error("there is no scene {name}: the programs are {programs}")]
    NoProgram {
        /// The requested name.
        name: String,
        /// The available programs.
        programs: String,
    },
    /// A scene file has no program for a simulated board.
    #[error(
        "{file} is a file; a simulated board needs the name of a scene's program: {programs}; \
         `cargo haptic new NAME` begins one"
    )]
    FileOnSimulatedBoard {
        /// The file.
        file: String,
        /// The available programs.
        programs: String,
    },
    /// A scene file has no program for the board.
    #[error(
        "{scene} is a scene file, which runs on the host only; a board needs a program in \
         firmware/src/bin: `cargo haptic new NAME` begins one"
    )]
    FileOnBoard {
        /// The scene.
        scene: String,
    },
    /// A program for the board has its transducers built in.
    #[error(
        "the program {program} is built for {counts_per_turn} counts a turn and {full_scale} N m \
         at full scale; change its TRANSDUCERS, or run it on the host"
    )]
    OtherTransducers {
        /// The program.
        program: &'static str,
        /// Its encoder's counts a turn.
        counts_per_turn: f64,
        /// Its motor's torque at full scale in N m.
        full_scale: f64,
    },
    /// The certificate rejects the scene; exit status 1, because the input was valid.
    #[error("{0}")]
    Refused(Box<Rejection>),
    /// The servo of the certified scene cannot be built.
    #[error(transparent)]
    Servo(#[from] haptic_servo::servo::BuildError),
    /// A number of the scene does not fit the number format.
    #[error(transparent)]
    Number(#[from] crate::number::DoesNotFit),
    /// An invalid recording.
    #[error(transparent)]
    CountsCsv(#[from] TableError),
    /// An invalid record of a run.
    #[error(transparent)]
    RunCsv(#[from] RunCsvError),
    /// The machine cannot build or run programs for the board.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A new scene cannot be created.
    #[error(transparent)]
    Sources(#[from] SourcesError),
    /// A program does not build.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A program could not be flashed.
    #[error(transparent)]
    Probe(#[from] crate::toolchain::probe::ProbeError),
    /// A run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The emulated board failed.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// A study has no figures.
    #[error(transparent)]
    Study(StudyError),
    /// A picture could not be drawn.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// No map can be drawn.
    #[error(transparent)]
    Map(#[from] crate::stability_map::MapError),
    /// The scene is certified at no sample rate, however soft its wall.
    #[error(
        "{scene}: no stiffness is certified at any of these sample rates; the damping of the wall \
         alone, or the cancelled damping, exceeds the damping of the device"
    )]
    NoStiffness {
        /// Name of the scene.
        scene: String,
    },
    /// There is no torque profile to draw.
    #[error(
        "{scene}: the environment is not a torque profile, which has `environment.type` = \"profile\""
    )]
    NoProfile {
        /// Name of the scene.
        scene: String,
    },
    /// A map of torque profiles needs a repeating profile.
    #[error(
        "{scene}: a map shows torque and repetitions in a turn of a torque profile, but no torque of this \
         one certifies, or it does not repeat"
    )]
    NoDetents {
        /// Name of the scene.
        scene: String,
    },
    /// One file cannot have the pictures of all topics.
    #[error("{}: one chart shows one topic; name one of {topics}", picture.display())]
    NoTopic {
        /// The file.
        picture: PathBuf,
        /// The available names.
        topics: String,
    },
    /// A table does not have the panel.
    #[error("there is no {what} `{word}`; there are {there}")]
    NoPanel {
        /// Case or error.
        what: &'static str,
        /// The requested name.
        word: String,
        /// The available names.
        there: String,
    },
    /// A table to be drawn has not been measured.
    #[error(
        "{}: there is no such table; --draw-only reads the tables from the folder of -o, or the kept \
         ones without -o", table.display()
    )]
    NothingKept {
        /// The table's file.
        table: PathBuf,
    },
    /// A chart that does not show all of a run; exit status 1, because it shows the rest.
    #[error(
        "the motion exceeds the range of a chart: sample {sample} and all after it are not drawn"
    )]
    LeftOut {
        /// The first sample, counted from 0, that is not shown.
        sample: usize,
    },
    /// A page's file must have the extension of a page.
    #[error("{path}: the name of a page must end in .html")]
    NoPage {
        /// The file.
        path: PathBuf,
    },
    /// The page could not be opened.
    #[error("the page is written, but no browser could be opened: {why}")]
    NoBrowser {
        /// The cause.
        why: String,
    },
    /// A file or folder could not be written.
    #[error("{path}: {source}")]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A scene that cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A simulated device runs away; exit status 1, because that is the result.
    #[error(
        "the motion diverges: from sample {sample} on, at {} s, the device is more than {} rad \
         from its zero; the loop is probably unstable (`haptic stability`)",
        significant(*.time, 6), significant(*.farthest, 6)
    )]
    RanAway {
        /// The angle in rad that it has exceeded.
        farthest: f64,
        /// The first sample, counted from 0, that is farther.
        sample: usize,
        /// Its time in s.
        time: f64,
    },
    /// A design for a quantity that the environment does not have.
    #[error("the environment of {scene} has no {quantity}")]
    NoSuchQuantity {
        /// Name of the scene.
        scene: String,
        /// The requested name.
        quantity: &'static str,
    },
    /// A parameter was given two values.
    #[error(transparent)]
    DuplicateParameter(#[from] crate::link::change::DuplicateParameter),
    /// The connection to a board failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A board cannot be served.
    #[error(transparent)]
    Serve(#[from] crate::serve::ServeError),
    /// The address cannot be bound.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: Address,
        /// The cause.
        source: io::Error,
    },
    /// A simulated board has ended by itself.
    #[error(transparent)]
    SimulatedBoard(#[from] SimulatedBoardError),
    /// A virtual board that did not start.
    #[error(transparent)]
    VirtualBoard(#[from] VirtualBoardError),
    /// The output could not be written.
    #[error("cannot write the answer: {0}")]
    Output(#[from] io::Error),
}

impl From<StudyError> for CommandError {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Refused(rejection) => Self::Refused(rejection),
            StudyError::Simulation(error) => Self::Simulation(error),
            other => Self::Study(other),
        }
    }
}

impl From<BatchError> for CommandError {
    fn from(error: BatchError) -> Self {
        match error {
            BatchError::File(error) => error.into(),
            BatchError::Output(error) => error.into(),
        }
    }
}

impl CommandError {
    /// Whether the input was valid and this is its result.
    pub(super) fn is_negative_verdict(&self) -> bool {
        matches!(
            self,
            Self::Refused(_)
                | Self::LeftOut { .. }
                | Self::RanAway { .. }
                | Self::Simulation(SimulationError::Overflow { .. })
        )
    }
}
