//! The board with its power on: instructions, exceptions between them, and time.

mod exception_entry;

use std::path::Path;

use unicorn_engine::RegisterARM;

use crate::board::VirtualBoard;
use crate::chip::Chip;
use crate::core::exceptions::{NON_MASKABLE, Number};
use crate::core::system::FaultStatus;
use crate::device::Device;
use crate::error::{BoardError, BootError};
use crate::frame::THUMB;
use crate::hooks::Halt;
use crate::image::Image;
use crate::log;
use crate::peripheral::clock::Cause;
use crate::peripheral::dma::Move;
use crate::processor::Processor;
use crate::rtt;

/// The magnetic encoder of a program that reads one, which begins with the chip's name.
pub const ENCODER: &str = "ENCODER_SETUP";

/// A board with its power on.
pub struct Machine {
    core: Processor,
    image: Image,
    waiting: bool,
    /// A fault could not be served: nothing is executed until a reset.
    locked_up: bool,
    /// An exception that is served at an address other than its vector.
    diverted: Option<(Number, u32)>,
    resets: Vec<(u64, Cause)>,
    /// The log, in defmt's encoding.
    log: Vec<u8>,
    /// Whether a debugger is connected, which gets the program's breakpoints.
    pub debugged: bool,
}

impl Machine {
    /// Boots a board with this program in its flash and this device at its pins. A program that reads a magnetic
    /// encoder has the board's wires for one.
    pub fn boot(
        elf: &Path,
        chip: &'static Chip,
        device: Box<dyn Device + Send>,
    ) -> Result<Self, BootError> {
        let path = || elf.display().to_string();
        let file = std::fs::read(elf).map_err(|source| BootError::File { path: path(), source })?;
        let image =
            Image::of_elf(file).map_err(|source| BootError::Image { path: path(), source })?;
        let is_magnetic = image.symbol(ENCODER).is_some();
        let chip = if is_magnetic { chip.with_magnetic_encoder() } else { chip };
        Self::power_on(image, chip, device)
    }

    /// The same with a program in memory.
    pub fn power_on(
        image: Image,
        chip: &'static Chip,
        device: Box<dyn Device + Send>,
    ) -> Result<Self, BootError> {
        let mut core = Processor::new(VirtualBoard::new(chip, device));
        for (address, bytes) in &image.pieces {
            if !core.set_memory(*address, bytes) {
                return Err(BootError::NoFlash { address: *address, size: bytes.len() });
            }
        }
        let mut machine = Self {
            core,
            image,
            waiting: false,
            locked_up: false,
            diverted: None,
            resets: Vec::new(),
            log: Vec::new(),
            debugged: false,
        };
        machine.start();
        Ok(machine)
    }

    /// The board.
    pub fn board(&self) -> &VirtualBoard {
        self.core.board()
    }

    /// The board, mutable.
    pub fn board_mut(&mut self) -> &mut VirtualBoard {
        self.core.board_mut()
    }

    /// The core, for its memory.
    pub fn core(&self) -> &Processor {
        &self.core
    }

    /// The core, mutable.
    pub fn core_mut(&mut self) -> &mut Processor {
        &mut self.core
    }

    /// The program.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Resets so far, with their times.
    pub fn resets(&self) -> &[(u64, Cause)] {
        &self.resets
    }

    /// Serves an exception at another address from now on, or again at its vector; returns its vector.
    pub fn divert(&mut self, number: Number, to: Option<u32>) -> u32 {
        self.diverted = to.map(|address| (number, address));
        self.vector(number.into())
    }

    /// Runs for a number of instructions.
    pub fn run_for(&mut self, instructions: u64) -> Result<(), BoardError> {
        let end = self.board().now + instructions;
        while self.board().now < end {
            self.step(end)?;
        }
        Ok(())
    }

    /// Runs until a condition is true, which is tested after every event.
    ///
    /// # Errors
    /// If the board cannot continue, or the condition is not true within the number of instructions.
    pub fn run_until(
        &mut self,
        what: &'static str,
        instructions: u64,
        mut is_so: impl FnMut(&VirtualBoard) -> bool,
    ) -> Result<(), BoardError> {
        let end = self.board().now + instructions;
        while !is_so(self.board()) {
            if self.board().now >= end {
                return Err(BoardError::Late { what, instructions });
            }
            self.step(end)?;
        }
        Ok(())
    }

    /// Runs a number of samples of the servo.
    ///
    /// # Errors
    /// If the board cannot continue, or the pacing timer does not run.
    pub fn run_samples(&mut self, samples: u64) -> Result<(), BoardError> {
        for _ in 0..samples {
            let next = self.board().samples + 1;
            self.run_until("an update of the pacing timer", LONGEST, |board| {
                board.samples >= next
            })?;
        }
        Ok(())
    }

    /// The lines of the program's log so far.
    pub fn log(&mut self) -> Vec<String> {
        self.drain_log();
        log::lines(&self.image.file, &self.log)
    }

    /// From one event to the next, at most up to a time.
    fn step(&mut self, end: u64) -> Result<(), BoardError> {
        let board = self.core.board_mut();
        if board.clock.notice_failure() {
            board.system.exceptions.pend(NON_MASKABLE);
            board.break_power_stage();
        }
        if board.clock.has_stopped() {
            return self.stand_still();
        }
        self.catch_up()?;
        if self.locked_up || self.waits() {
            self.wait(end);
            return Ok(());
        }
        let board = self.core.board();
        let (until, masked) = (end.min(board.due()), board.system.exceptions.any_pending());
        let halt = self.core.run(until, masked);
        self.halted(halt)
    }

    /// The events between two instructions, or from the last instruction.
    fn catch_up(&mut self) -> Result<(), BoardError> {
        if self.core.board_mut().advance() {
            self.reset(Cause::Watchdog);
        }
        self.move_words();
        if self.core.board().system.reset_requested {
            self.reset(Cause::Software);
        }
        let at = self.core.last_address();
        if let Some(what) = self.core.board().stopped.clone() {
            return Err(BoardError::NotModelled { what, now: self.board().now, address: at });
        }
        if let Some((now, leg)) = self.core.board().power_stage.shoot_through() {
            return Err(BoardError::ShootThrough { now, leg });
        }
        if let Some(address) = self.core.board_mut().bus_error.take() {
            // The access has failed; continue at its instruction.
            self.core.set_register(RegisterARM::PC, at | 1);
            self.fault(FaultStatus::Data, address)?;
        }
        Ok(())
    }

    /// The moves of the DMA that are requested.
    fn move_words(&mut self) {
        while let Some(next) = self.core.board_mut().next_move() {
            let Move { peripheral, memory, size, from_memory, .. } = next;
            if from_memory {
                let mut word = self.core.memory(memory, size).unwrap_or_default();
                word.resize(4, 0);
                let word = word.try_into().map_or(0, u32::from_le_bytes);
                self.core.board_mut().write(peripheral, size, word);
            } else {
                let word = self.core.board_mut().read(peripheral, size);
                self.core.set_memory(memory, &word.to_le_bytes()[..size]);
            }
            self.core.board_mut().advance();
        }
    }

    /// Handles a stop of the core.
    fn halted(&mut self, halt: Halt) -> Result<(), BoardError> {
        match halt {
            Halt::Attention => Ok(()),
            Halt::Waiting => {
                self.waiting = true;
                Ok(())
            }
            Halt::Returning(word) => self.leave(word),
            Halt::NoMemory { fetch: true, address } => self.fault(FaultStatus::Fetch, address),
            Halt::NoMemory { fetch: false, address } => self.fault(FaultStatus::Data, address),
            Halt::Breakpoint if self.debugged => {
                let (now, address) = (self.board().now, self.core.last_address());
                Err(BoardError::Breakpoint { now, address })
            }
            Halt::Undefined => self.fault(FaultStatus::Undefined, 0),
            Halt::Breakpoint | Halt::Invalid => self.fault(FaultStatus::State, 0),
        }
    }

    /// Time passes up to the next event, and no instruction is executed.
    fn wait(&mut self, end: u64) {
        let board = self.core.board_mut();
        board.now = board.now.max(end.min(board.due()));
    }

    /// The clock of the core and of everything that it paces has stopped. The watchdog has its own clock.
    fn stand_still(&mut self) -> Result<(), BoardError> {
        let board = self.core.board_mut();
        let Some(due) = board.watchdog.due() else {
            return Err(BoardError::NoClock { now: board.now });
        };
        board.now = due;
        self.reset(Cause::Watchdog);
        Ok(())
    }

    /// Starts after reset: the stack and the first instruction are the vector table's first words.
    fn start(&mut self) {
        for register in [RegisterARM::PRIMASK, RegisterARM::FAULTMASK, RegisterARM::BASEPRI] {
            self.core.set_register(register, 0);
        }
        self.core.set_uses_floating_point(false);
        self.core.set_register(RegisterARM::XPSR, THUMB);
        let (stack, entry) = (self.vector(0), self.vector(1));
        self.core.set_register(RegisterARM::MSP, stack);
        self.core.set_register(RegisterARM::LR, u32::MAX);
        self.core.set_register(RegisterARM::PC, entry);
        (self.waiting, self.locked_up) = (false, false);
    }

    /// Resets the board for a cause; its memory stays.
    pub fn reset(&mut self, cause: Cause) {
        self.drain_log();
        self.resets.push((self.board().now, cause));
        self.core.board_mut().reset(cause);
        self.start();
    }

    /// Switches the power off, for long enough for RAM to forget, and on again.
    pub fn power_cycle(&mut self) {
        self.drain_log();
        self.core.forget();
        self.reset(Cause::Power);
    }

    /// Stores the program's log since the last call.
    fn drain_log(&mut self) {
        self.log.extend(rtt::drain(&mut self.core, &self.image));
    }
}

/// Number of instructions within which the pacing timer must update.
const LONGEST: u64 = 200_000_000;
