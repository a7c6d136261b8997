//! Exceptions between instructions (ARM DDI 0403E, B1.5).

use unicorn_engine::RegisterARM;

use super::Machine;
use crate::chip::{FLASH, TICK_INTERRUPT, TRANSFER_INTERRUPT};
use crate::core::exceptions::{FIRST_INTERRUPT, Number};
use crate::core::system::FaultStatus;
use crate::error::BoardError;
use crate::frame::{self, Frame, THUMB};

/// The servo's interrupt.
const SERVO: Number = FIRST_INTERRUPT + TICK_INTERRUPT;
/// The same with a magnetic encoder.
const TRANSFER: Number = FIRST_INTERRUPT + TRANSFER_INTERRUPT;

impl Machine {
    /// Begins to serve pending exceptions; returns whether the core waits.
    pub(super) fn waits(&mut self) -> bool {
        let exceptions = &self.core.board().system.exceptions;
        // The usual case, without reading the masks.
        if !exceptions.any_pending() {
            return self.waiting;
        }
        let masks = self.core.masks();
        self.waiting &= !exceptions.wakes(masks);
        if let Some(number) = exceptions.next(masks) {
            self.enter(number);
        }
        self.waiting
    }

    /// A fault at the present instruction.
    pub(super) fn fault(&mut self, status: FaultStatus, address: u32) -> Result<(), BoardError> {
        let masks = self.core.masks();
        let board = self.core.board_mut();
        if !board.system.exceptions.can_fault(masks) {
            // Only the watchdog can end this.
            if board.watchdog.due().is_some() {
                self.locked_up = true;
                board.lock_up();
                return Ok(());
            }
            return Err(BoardError::LockedUp { now: board.now, address: self.core.last_address() });
        }
        board.system.fault(status, address);
        Ok(())
    }

    /// A word of the vector table, which is at the beginning of flash after reset.
    pub(super) fn vector(&self, number: u32) -> u32 {
        let table = match self.core.board().system.vectors() {
            0 => FLASH,
            table => table,
        };
        self.core.word(table + 4 * number).unwrap_or(0)
    }

    /// Begins to serve an exception (ARM DDI 0403E, B1.5.6): its frame on the stack, its vector.
    fn enter(&mut self, number: Number) {
        let nested = self.board().system.exceptions.current().is_some();
        frame::push(&mut self.core, nested);
        let board = self.core.board_mut();
        board.system.exceptions.enter(number);
        if let SERVO | TRANSFER = number {
            board.meter.begin(board.now);
        }
        let vector = match self.diverted {
            Some((diverted, address)) if diverted == number => address | 1,
            _ => self.vector(number.into()),
        };
        self.core.set_register(RegisterARM::XPSR, THUMB | u32::from(number));
        self.core.set_register(RegisterARM::PC, vector);
    }

    /// Ends the active exception (B1.5.8): returns to the state of its frame.
    pub(super) fn leave(&mut self, word: u32) -> Result<(), BoardError> {
        let Some(frame) = Frame::of(&self.core, word) else {
            let stack = self.core.register(RegisterARM::MSP);
            return self.fault(FaultStatus::State, stack);
        };
        let board = self.core.board_mut();
        if let Some(SERVO | TRANSFER) = board.system.exceptions.current() {
            board.meter.end(board.now);
        }
        board.system.exceptions.leave();
        frame.pop(&mut self.core);
        self.waiting = self.board().system.sleeps_on_exit() && frame.is_of_program();
        Ok(())
    }
}
