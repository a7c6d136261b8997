//! A scene run over counts: on the host, and on an emulated or a virtual board beside it.

use std::path::Path;

use haptic_model::host::HostRun;
use haptic_servo::host::HostError;
use thiserror::Error;

use crate::controller::{Controller, Tick};
use crate::device::Energy;
use crate::emulator::{Emulator, EmulatorError, EmulatorReport, InstructionStats};
use crate::hand::HandTrajectory;
use crate::lockstep::{PlantIo, Recording, Run, SimulatedDevice, run_beside};
use crate::simulation::tick_status::TickStatus;
use crate::toolchain;
use crate::trace::{TimeUnit, Trace};
use crate::virtual_board::{self, VirtualBoard, VirtualBoardError};

/// The input of a servo.
pub enum Input<'a> {
    /// A simulated device in a hand.
    Hand(Box<SimulatedDevice>),
    /// Recorded counts.
    Recording(&'a [i32]),
}

/// The board on which a scene's program runs in lockstep with the host.
#[derive(Clone, Copy, Debug)]
pub enum Backend<'a> {
    /// On the emulated board, which has a program of its own.
    Emulator(&'a Path),
    /// On a virtual board, with the flashed program for a DAC.
    VirtualBoard {
        /// The program that is a virtual board.
        program: &'a Path,
        /// The model of the board.
        board: toolchain::BoardModel,
        /// The program in its flash.
        elf: &'a Path,
        /// The period of its servo in s.
        period: f64,
        /// Whether it reads a magnetic encoder.
        is_magnetic: bool,
    },
}

/// Instructions that a board measured.
#[derive(Clone, Debug)]
pub enum BoardMeasurement {
    /// Of the emulated board.
    Emulated(Box<EmulatorReport>),
    /// Of a virtual board.
    Virtual(virtual_board::VirtualBoardReport),
}

impl BoardMeasurement {
    /// Instructions from count to code; none where the code is not put out, but kept for a current loop.
    pub fn compute(&self) -> Option<&InstructionStats> {
        match self {
            Self::Emulated(report) => Some(&report.compute_instructions),
            Self::Virtual(report) => report.compute.as_ref(),
        }
    }

    /// Instructions of the servo's whole interrupt.
    pub fn interrupt(&self) -> &InstructionStats {
        match self {
            Self::Emulated(report) => &report.interrupt_instructions,
            Self::Virtual(report) => &report.interrupt,
        }
    }
}

/// The result of a run, with the board's measurement if a board took part.
#[derive(Debug)]
pub struct RunOutcome {
    /// The ticks.
    pub run: Run,
    /// Energy that passed between hand and device; none where the counts were recorded.
    pub energy: Option<Energy>,
    /// Speed of the device at the end, in rad/s; none where the counts were recorded.
    pub final_speed: Option<f64>,
    /// The board's measurement.
    pub board: Option<BoardMeasurement>,
    /// The host, in a run with one.
    pub host: Option<HostRun>,
}

impl RunOutcome {
    /// The measurement of the emulated board, if it took part.
    pub fn emulated(self) -> Option<EmulatorReport> {
        match self.board {
            Some(BoardMeasurement::Emulated(report)) => Some(*report),
            Some(BoardMeasurement::Virtual(_)) | None => None,
        }
    }
}

/// Why a run ended before its time.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum RunError {
    #[error("at tick {tick}: {source}")]
    EmulatedBoard { tick: usize, source: EmulatorError },
    #[error(
        "the board reported {reported} of the host's {sent} commands with the numbers and counts that it got, so \
         that its codes cannot be compared"
    )]
    Unreported { sent: usize, reported: usize },
    #[error(transparent)]
    Host(#[from] HostError),
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    #[error(transparent)]
    VirtualBoard(#[from] VirtualBoardError),
}

/// Runs a servo for at most `ticks` ticks and, with a backend, its program on that board as well.
/// `progress` is called after each tick.
pub fn run_with_backend(
    input: Input<'_>,
    controller: &mut dyn Controller,
    board: Option<Backend<'_>>,
    ticks: usize,
    progress: impl FnMut(),
) -> Result<RunOutcome, RunError> {
    match input {
        Input::Hand(mut device) => {
            let mut outcome = run_lockstep(device.as_mut(), controller, board, ticks, progress)?;
            outcome.energy = Some(device.energy());
            outcome.final_speed = Some(device.motion().velocity.abs());
            Ok(outcome)
        }
        Input::Recording(counts) => {
            run_lockstep(&mut Recording::new(counts), controller, board, ticks, progress)
        }
    }
}

fn run_lockstep(
    plant: &mut dyn PlantIo,
    controller: &mut dyn Controller,
    board: Option<Backend<'_>>,
    ticks: usize,
    progress: impl FnMut(),
) -> Result<RunOutcome, RunError> {
    let (run, board) = match board {
        None => {
            let own = |_, _, tick: &Tick| Ok::<_, RunError>(tick.code);
            let run = run_beside(plant, controller, own, ticks, progress)?;
            (run, None)
        }
        // On either board the hand waits until the servo runs.
        Some(Backend::Emulator(elf)) => {
            let mut board = Emulator::boot(elf)?;
            board.arm_and_wait()?;
            let mut ticks_before = 0..;
            let remote = |count, _, _: &Tick| {
                let tick = ticks_before.next().unwrap_or_default();
                board.exchange(count).map_err(|source| RunError::EmulatedBoard { tick, source })
            };
            let run = run_beside(plant, controller, remote, ticks, progress)?;
            (run, Some(BoardMeasurement::Emulated(Box::new(board.finish()?))))
        }
        Some(Backend::VirtualBoard { program, board, elf, period, is_magnetic }) => {
            let mut board = VirtualBoard::boot(program, board, elf, None, is_magnetic)?;
            board.arm_and_wait(period)?;
            let remote = |count, fails, _: &Tick| {
                board.reading_fails(fails);
                board.exchange(count, &[]).map(|(code, _)| code)
            };
            let run = run_beside(plant, controller, remote, ticks, progress)?;
            (run, Some(BoardMeasurement::Virtual(board.finish()?)))
        }
    };
    Ok(RunOutcome { run, energy: None, final_speed: None, board, host: None })
}

/// The status of a tick.
pub fn status(tick: &Tick) -> TickStatus {
    if tick.is_left_out { TickStatus::Missed } else { TickStatus::Ran(tick.limit) }
}

/// The trace of a run, as a picture shows it: position, torque, and the set-point of the hand.
pub fn trace(title: String, period: f64, run: &Run, trajectory: &HandTrajectory) -> Trace {
    let time = |tick: usize| tick as f64 * period;
    let held = (0..run.ticks.len()).map(time).take_while(|&time| time < trajectory.release);
    Trace {
        title,
        time_unit: TimeUnit::Seconds,
        time: (0..run.ticks.len()).map(time).collect(),
        position: run.ticks.iter().map(|tick| tick.angle).collect(),
        hand: held.map(|time| trajectory.position(time)).collect(),
        torque: run.ticks.iter().map(|tick| tick.torque).collect(),
        limit: run.ticks.iter().map(status).collect(),
        release: Some(trajectory.release).filter(|&release| release < time(run.ticks.len())),
        ..Trace::default()
    }
}
