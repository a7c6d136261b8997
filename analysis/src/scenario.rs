//! A scene run over counts: on the host, and on an emulated or a virtual board beside it.

use std::path::Path;

use thiserror::Error;

use crate::controller::Controller;
use crate::device::Energy;
use crate::emulator::{Emulator, EmulatorError, Report, Stats};
use crate::hand::Script;
use crate::rig::{Alone, Plant, Recording, Run, SimulatedDevice, Twin, run};
use crate::simulation::served::Served;
use crate::toolchain;
use crate::trace::{Clock, Trace};
use crate::virtual_board::{self, VirtualBoard, VirtualBoardError};

/// What comes into a servo.
pub enum Input<'a> {
    /// A simulated device in a hand.
    Hand(Box<SimulatedDevice>),
    /// Recorded counts.
    Recording(&'a [i32]),
}

/// Where a scene's program runs beside the host.
#[derive(Clone, Copy, Debug)]
pub enum Beside<'a> {
    /// On the emulated board, which has a program of its own.
    Emulator(&'a Path),
    /// On a virtual board, which has what is flashed.
    VirtualBoard {
        /// The program that is a virtual board.
        program: &'a Path,
        /// Which board it is.
        board: toolchain::Board,
        /// What is in its flash.
        elf: &'a Path,
        /// The period of its servo in s.
        period: f64,
    },
}

/// What a board measured.
#[derive(Clone, Debug)]
pub enum Measured {
    /// The emulated one.
    Emulated(Box<Report>),
    /// A virtual one.
    Virtual(virtual_board::Report),
}

impl Measured {
    /// Instructions from count to code.
    pub fn compute(&self) -> &Stats {
        match self {
            Self::Emulated(report) => &report.compute_instructions,
            Self::Virtual(report) => &report.compute,
        }
    }

    /// Instructions of the servo's whole interrupt.
    pub fn interrupt(&self) -> &Stats {
        match self {
            Self::Emulated(report) => &report.interrupt_instructions,
            Self::Virtual(report) => &report.interrupt,
        }
    }
}

/// What a run gave, with what the board measured if one took part.
#[derive(Debug)]
pub struct Outcome {
    /// The ticks.
    pub run: Run,
    /// Energy that passed between hand and device; none where the counts were recorded.
    pub energy: Option<Energy>,
    /// Speed of the device at the end, in rad/s; none where the counts were recorded.
    pub final_speed: Option<f64>,
    /// What the board measured.
    pub board: Option<Measured>,
}

impl Outcome {
    /// What the emulated board measured, if that took part.
    pub fn emulated(self) -> Option<Report> {
        match self.board {
            Some(Measured::Emulated(report)) => Some(*report),
            Some(Measured::Virtual(_)) | None => None,
        }
    }
}

/// Why a run ended before its time.
#[derive(Debug, Error)]
pub enum ScenarioError {
    /// The emulated board failed.
    #[error("at tick {tick}: {source}")]
    Board {
        /// The tick, counted from 0.
        tick: usize,
        /// How.
        source: EmulatorError,
    },
    /// The emulated board could not be started or did not end.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The virtual board failed.
    #[error(transparent)]
    VirtualBoard(#[from] VirtualBoardError),
}

/// Runs a servo, for so many ticks at most, and its program on a board beside it, if there is one.
/// `progress` is told of each tick.
///
/// # Errors
/// Where the board cannot be started, fails, or does not end.
pub fn play(
    input: Input<'_>,
    controller: &mut dyn Controller,
    board: Option<Beside<'_>>,
    ticks: usize,
    progress: impl FnMut(),
) -> Result<Outcome, ScenarioError> {
    match input {
        Input::Hand(mut device) => {
            let mut outcome = beside(device.as_mut(), controller, board, ticks, progress)?;
            outcome.energy = Some(device.energy());
            outcome.final_speed = Some(device.motion().velocity.abs());
            Ok(outcome)
        }
        Input::Recording(counts) => {
            beside(&mut Recording::new(counts), controller, board, ticks, progress)
        }
    }
}

fn beside(
    plant: &mut dyn Plant,
    controller: &mut dyn Controller,
    board: Option<Beside<'_>>,
    ticks: usize,
    progress: impl FnMut(),
) -> Result<Outcome, ScenarioError> {
    let (run, board) = match board {
        None => {
            let Ok(run) = run::<Alone>(plant, controller, None, ticks, progress);
            (run, None)
        }
        // On either board the hand waits until the servo runs.
        Some(Beside::Emulator(elf)) => {
            let mut board = Board::boot(elf)?;
            board.emulator.engage()?;
            let run = run(plant, controller, Some(&mut board), ticks, progress)?;
            (run, Some(Measured::Emulated(Box::new(board.emulator.finish()?))))
        }
        Some(Beside::VirtualBoard { program, board, elf, period }) => {
            let mut board = VirtualBoard::boot(program, board, elf)?;
            board.engage(period)?;
            let run = run(plant, controller, Some(&mut board), ticks, progress)?;
            (run, Some(Measured::Virtual(board.finish()?)))
        }
    };
    Ok(Outcome { run, energy: None, final_speed: None, board })
}

/// The emulated board, which knows the tick that it is in.
pub struct Board {
    emulator: Emulator,
    tick: usize,
}

impl Board {
    /// Starts a program.
    ///
    /// # Errors
    /// Where the emulator cannot be started.
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self { emulator: Emulator::boot(elf)?, tick: 0 })
    }

    /// Ends a program that has no scene to report of, and gives its log.
    ///
    /// # Errors
    /// Where the board does not end, or ends with a failure.
    pub fn end(self) -> Result<Vec<String>, EmulatorError> {
        self.emulator.end()
    }
}

impl Twin for Board {
    type Error = ScenarioError;

    fn exchange(&mut self, raw: i32) -> Result<u16, ScenarioError> {
        let tick = self.tick;
        self.tick += 1;
        self.emulator.exchange(raw).map_err(|source| ScenarioError::Board { tick, source })
    }
}

/// What a picture shows of a run: its position, its torque, and where the hand wanted to be.
pub fn trace(title: String, period: f64, run: &Run, script: &Script) -> Trace {
    let time = |tick: usize| tick as f64 * period;
    let held = (0..run.ticks.len()).map(time).take_while(|&time| time < script.release);
    Trace {
        title,
        clock: Clock::Seconds,
        time: (0..run.ticks.len()).map(time).collect(),
        position: run.ticks.iter().map(|tick| tick.angle).collect(),
        hand: held.map(|time| script.position(time)).collect(),
        torque: run.ticks.iter().map(|tick| tick.torque).collect(),
        limit: run.ticks.iter().map(|tick| Served::Ran(tick.limit)).collect(),
        release: Some(script.release).filter(|&release| release < time(run.ticks.len())),
        ..Trace::default()
    }
}
