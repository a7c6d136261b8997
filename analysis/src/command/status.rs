//! Status of a command: its verdict, or an error.

use std::io;
use std::path::PathBuf;

use haptic_servo::certificate::Rejection;
use haptic_servo::number::Format;
use thiserror::Error;

use crate::file::{FileError, SceneFile};
use crate::link::Address;
use crate::quantity::significant;
use crate::simulation::SimulationError;
use crate::studies::error::StudyError;
use crate::toolchain::TorqueOutput;
use crate::verdict::judge_file;

/// Verdict of a command, which becomes the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandStatus {
    /// Exit status 0.
    Success,
    /// Exit status 1: rejected, undecided, unstable, different.
    NegativeVerdict,
}

impl CommandStatus {
    pub fn of(is_positive: bool) -> Self {
        if is_positive { Self::Success } else { Self::NegativeVerdict }
    }
}

/// The error of a command; exit status 2.
#[derive(Debug, Error)]
pub enum CommandError {
    /// Printed with the lines of the file.
    #[error(transparent)]
    File(#[from] FileError),
    #[error("there is no scene {name}: the programs are {programs}, and there is no such file")]
    NoScene { name: String, programs: String },
    #[error(
        "{path} describes a device, and `identify` needs a record of its motion, in CSV: it measures one with the \
         board at --port PORT, or simulates this device with --target host (docs/measure.md)",
        path = path.display()
    )]
    NoRecord { path: PathBuf },
    #[error(
        "{scene} takes no torque of a host: --host is for a scene file with the table [host], and for \
         hosted_wall (docs/host-torque.md)"
    )]
    NoHost { scene: String },
    /// Exit status 1, because the input was valid.
    #[error("{why}")]
    FileRefused { why: String },
    #[error("{file}: {why}")]
    NoBoardProgram { file: String, why: String },
    #[error(
        "{file} is for {}: a file with the table [motor] is for a board's own bridge, and without it for a DAC and \
         an amplifier (docs/power-stage.md)",
        match output { TorqueOutput::Bridge => "a bridge", TorqueOutput::Dac => "a DAC" }
    )]
    FileForOther { file: String, output: TorqueOutput },
    #[error(
        "{scene} is for a device of the examples, by its inertia and damping, not for yours: on another device \
         it may oscillate. {way}; measure it (docs/measure.md). Or state --example-device"
    )]
    ExampleDevice { scene: String, way: &'static str },
    /// The program of a scene file. Exit status 1 if the file's scene is not certified.
    #[error("{file}: {why}")]
    FileNotBuilt { file: String, why: Box<CommandError>, is_certified: bool },
    #[error(
        "the program {program} is built for {counts_per_turn} counts a turn and {full_scale} N m \
         at full scale; change its TRANSDUCERS, or run it on the host"
    )]
    OtherTransducers { program: &'static str, counts_per_turn: f64, full_scale: f64 },
    /// Exit status 1, because the input was valid.
    #[error("{0}")]
    Refused(Box<Rejection>),
    #[error(
        "{scene}: no stiffness is certified at any of these sample rates; the damping of the wall \
         alone, or the cancelled damping, exceeds the damping of the device"
    )]
    NoStiffness { scene: String },
    #[error(
        "{scene}: the environment is not a torque profile, which has `environment.type` = \"profile\""
    )]
    NoProfile { scene: String },
    #[error(
        "{scene}: a map shows torque and repetitions in a turn of a torque profile, but this one does not \
         repeat, or not in this range"
    )]
    NoDetents { scene: String },
    #[error(
        "{}: there is no such table; --draw-only reads the tables from the folder of -o, or the kept \
         ones without -o", table.display()
    )]
    NothingKept { table: PathBuf },
    /// `sample` is counted from 0. Exit status 1, because the chart shows the rest of the run.
    #[error(
        "the motion exceeds the range of a chart: sample {sample} and all after it are not drawn"
    )]
    LeftOut { sample: usize },
    #[error("{path}: the name of a page must end in .html")]
    NoPage { path: PathBuf },
    #[error("the page is written, but no browser could be opened: {why}")]
    NoBrowser { why: String },
    /// Two arguments, by their names.
    #[error(
        "{output} would overwrite {other}: both are {path}; name another file, for example a copy"
    )]
    Overwrites { output: &'static str, other: &'static str, path: PathBuf },
    /// A file or folder, mostly one to write.
    #[error("{path}: {source}")]
    Unwritable { path: PathBuf, source: io::Error },
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// Angle in rad, and the first sample beyond it, counted from 0, with its time in s. Exit status 1, because
    /// that is the result.
    #[error(
        "the motion diverges: from sample {sample} on, at {} s, the device is more than {} rad \
         from its zero; the loop is probably unstable (`haptic stability`)",
        significant(*.time, 6), significant(*.farthest, 6)
    )]
    RanAway { farthest: f64, sample: usize, time: f64 },
    #[error("the environment of {scene} has no {quantity}")]
    NoSuchQuantity { scene: String, quantity: &'static str },
    #[error("cannot listen on {address}: {source}")]
    Listen { address: Address, source: io::Error },
    /// The error of a layer below.
    #[error(transparent)]
    Failed(Box<dyn std::error::Error>),
    #[error("cannot write the answer: {0}")]
    Output(#[from] io::Error),
}

/// Errors of layers below, whose sentences need no addition.
macro_rules! passed_on {
    ($($error:ty,)*) => {$(
        impl From<$error> for CommandError {
            fn from(error: $error) -> Self {
                Self::Failed(error.into())
            }
        }
    )*};
}

passed_on! {
    crate::chart::ChartError,
    crate::compare_run::RunError,
    crate::emulator::EmulatorError,
    crate::identify::IdentifyError,
    crate::identify::port::PortError,
    crate::board_sim::SimulatedBoardError,
    crate::link::LinkError,
    crate::link::change::CollectError,
    crate::number::DoesNotFit,
    crate::run_csv::RunCsvError,
    crate::serve::ServeError,
    crate::stability_map::MapError,
    crate::table::TableError,
    crate::toolchain::BuildError,
    crate::toolchain::SetupError,
    crate::toolchain::SourcesError,
    crate::toolchain::probe::ProbeError,
    crate::virtual_board::VirtualBoardError,
    haptic_servo::host::HostError,
    haptic_servo::servo::BuildError,
}

impl From<csv::Error> for CommandError {
    fn from(error: csv::Error) -> Self {
        // Numbers and words always fit a row: only writing can fail.
        Self::Output(match error.into_kind() {
            csv::ErrorKind::Io(error) => error,
            other => io::Error::other(format!("{other:?}")),
        })
    }
}

impl From<StudyError> for CommandError {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Refused(rejection) => Self::Refused(rejection),
            StudyError::Simulation(error) => Self::Simulation(error),
            other => Self::Failed(other.into()),
        }
    }
}

impl CommandError {
    /// Of a file whose scene is not certified: the sentence of its verdict.
    pub(super) fn of_rejected(file: &SceneFile) -> Self {
        Self::FileRefused { why: judge_file(file, Format::F64).message }
    }

    /// Whether the input was valid and this is its result.
    pub(super) fn is_negative_verdict(&self) -> bool {
        matches!(
            self,
            Self::Refused(_)
                | Self::FileRefused { .. }
                | Self::FileNotBuilt { is_certified: false, .. }
                | Self::LeftOut { .. }
                | Self::RanAway { .. }
                | Self::Simulation(
                    SimulationError::Overflow { .. } | SimulationError::Readings { .. }
                )
        )
    }
}
