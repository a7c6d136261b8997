//! A debugger that answers a program's calls: "Semihosting for AArch32 and AArch64", ARM, 2025Q1.
//!
//! A program that was written for an emulator has pipes to its host as files, and ends by a call.
//! Here the pipes are memory: the program reads what it was asked and stops where there is nothing
//! to read.

use std::collections::VecDeque;
use std::path::Path;

use unicorn_engine::RegisterARM;

use crate::chip::Chip;
use crate::device::FixedDevice;
use crate::error::{BoardError, BootError};
use crate::machine::Machine;

/// The instruction of a call, `BKPT 0xAB` (section 4.1).
const CALL: u16 = 0xBEAB;
/// The operations (section 6) that the programs use.
const OPEN: u32 = 0x01;
const CLOSE: u32 = 0x02;
const WRITE: u32 = 0x05;
const READ: u32 = 0x06;
const COMMAND_LINE: u32 = 0x15;
const EXIT_EXTENDED: u32 = 0x20;
/// What an operation returns that has failed.
const FAILED: u32 = u32::MAX;
/// The reason of an exit that the program itself has chosen; its status stands beside it.
const APPLICATION_EXIT: u32 = 0x20026;
/// The name of the console.
const CONSOLE: &[u8] = b":tt";
/// Instructions within which a program has to come to its next call.
const LONGEST: u64 = 100_000_000;

/// The files that a program may open; a handle is the place in this list, from 1 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Handle {
    Console = 1,
    Requests,
    Replies,
}

/// Why a program gave no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CallError {
    /// The board cannot go on.
    #[error(transparent)]
    BoardError(#[from] BoardError),
    /// The call is not supported.
    #[error("the program calls operation {operation:#x} at {address:#010x}, which is not modelled")]
    NoOperation {
        /// Which.
        operation: u32,
        /// Where.
        address: u32,
    },
    /// What a call refers to is not in memory, or is not an open file.
    #[error("the program's call {operation:#x} is not understood: {block:x?}")]
    Malformed {
        /// Which.
        operation: u32,
        /// What stands in memory for it.
        block: [u32; 3],
    },
    /// It has ended.
    #[error("the program has ended with status {0}")]
    Ended(u32),
    /// It has ended for an error, not by its own choice.
    #[error("the program has aborted for the reason {0:#x}")]
    Aborted(u32),
    /// It waits for another question instead.
    #[error("the program waits for more than it was asked")]
    Waiting,
}

/// A program with its debugger.
pub struct Guest {
    machine: Machine,
    /// Names of its input file and of its output file.
    names: [&'static str; 2],
    requests: VecDeque<u8>,
    /// Whether there will be no more of them.
    closed: bool,
    replies: VecDeque<u8>,
    console: Vec<u8>,
    /// What the program is called with.
    command: &'static str,
}

impl Guest {
    /// Switches a board on with a program that reads its questions from the first file and writes
    /// its answers to the second.
    pub fn boot(
        elf: &Path,
        chip: &'static Chip,
        names: [&'static str; 2],
    ) -> Result<Self, BootError> {
        let mut machine = Machine::boot(elf, chip, Box::new(FixedDevice))?;
        machine.debugged = true;
        let (requests, replies) = (VecDeque::new(), VecDeque::new());
        let (console, command) = (Vec::new(), "");
        Ok(Self { machine, names, requests, closed: false, replies, console, command })
    }

    /// The same with a program that is called with a command line, and asks nothing.
    pub fn boot_command(
        elf: &Path,
        chip: &'static Chip,
        command: &'static str,
    ) -> Result<Self, BootError> {
        let guest = Self::boot(elf, chip, ["", ""])?;
        Ok(Self { closed: true, command, ..guest })
    }

    /// The board, to do something to it from outside.
    pub fn machine_mut(&mut self) -> &mut Machine {
        &mut self.machine
    }

    /// The board.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// Asks, and waits until the program has filled `answer`.
    pub fn exchange(&mut self, request: &[u8], answer: &mut [u8]) -> Result<(), CallError> {
        self.requests.extend(request);
        while self.replies.len() < answer.len() {
            self.run_to_call()?;
        }
        let answered: Vec<_> = self.replies.drain(..answer.len()).collect();
        answer.copy_from_slice(&answered);
        Ok(())
    }

    /// Tells the program that there is no more, and gives the bytes of its console once it has
    /// ended.
    ///
    /// # Errors
    /// Where it does not end, or not with status 0.
    pub fn finish(mut self) -> Result<Vec<u8>, CallError> {
        self.closed = true;
        loop {
            match self.run_to_call() {
                Ok(()) => {}
                Err(CallError::Ended(0)) => return Ok(self.console),
                Err(error) => return Err(error),
            }
        }
    }

    /// Runs up to the next call, and answers it.
    ///
    /// # Errors
    /// As [`Self::exchange`], and where the program ends.
    pub fn run_to_call(&mut self) -> Result<(), CallError> {
        let Err(error) = self.machine.run_for(LONGEST) else {
            return Err(BoardError::Late { what: "a call", instructions: LONGEST }.into());
        };
        let BoardError::Breakpoint { address, .. } = error else { return Err(error.into()) };
        let core = self.machine.core_mut();
        if core.memory(address, 2).as_deref() != Some(&CALL.to_le_bytes()) {
            return Err(error.into());
        }
        let operation = core.register(RegisterARM::R0);
        let place = core.register(RegisterARM::R1);
        let block = [0, 4, 8].map(|offset| core.word(place + offset).unwrap_or(0));
        let result = match operation {
            COMMAND_LINE => self.write_command(place, block)?,
            _ => self.answer(operation, block, address)?,
        };
        let core = self.machine.core_mut();
        core.set_register(RegisterARM::R0, result);
        core.set_register(RegisterARM::PC, (address + 2) | 1);
        Ok(())
    }

    /// What an operation returns; `block` is what the program has in memory for it.
    fn answer(&mut self, operation: u32, block: [u32; 3], address: u32) -> Result<u32, CallError> {
        let malformed = CallError::Malformed { operation, block };
        let [first, second, third] = block;
        let result = match operation {
            OPEN => {
                let name = self.machine.core_mut().memory(first, third as usize);
                Some(self.open(&name.ok_or(malformed.clone())?))
            }
            CLOSE => handle(first).map(|_| 0),
            WRITE => self.write(handle(first), second, third),
            READ if handle(first) == Some(Handle::Requests) => self.read(second, third)?,
            EXIT_EXTENDED if first == APPLICATION_EXIT => return Err(CallError::Ended(second)),
            EXIT_EXTENDED => return Err(CallError::Aborted(first)),
            _ => return Err(CallError::NoOperation { operation, address }),
        };
        result.ok_or(malformed)
    }

    /// The command line with a zero behind it, and its length without in the second word of the block.
    fn write_command(&mut self, place: u32, block: [u32; 3]) -> Result<u32, CallError> {
        let [buffer, size, _] = block;
        let bytes: Vec<u8> = self.command.bytes().chain([0]).collect();
        let length = bytes.len() as u32 - 1;
        let core = self.machine.core_mut();
        let is_written = bytes.len() <= size as usize
            && core.set_memory(buffer, &bytes)
            && core.set_memory(place + 4, &length.to_le_bytes());
        is_written.then_some(0).ok_or(CallError::Malformed { operation: COMMAND_LINE, block })
    }

    fn open(&self, name: &[u8]) -> u32 {
        let [requests, replies] = self.names.map(str::as_bytes);
        let handles =
            [(CONSOLE, Handle::Console), (requests, Handle::Requests), (replies, Handle::Replies)];
        let found = handles.into_iter().find(|(known, _)| *known == name);
        found.map_or(FAILED, |(_, handle)| handle as u32)
    }

    /// Bytes that were not written: none.
    fn write(&mut self, handle: Option<Handle>, from: u32, size: u32) -> Option<u32> {
        let bytes = self.machine.core_mut().memory(from, size as usize)?;
        match handle? {
            Handle::Console => self.console.extend(bytes),
            Handle::Replies => self.replies.extend(bytes),
            Handle::Requests => return None,
        }
        Some(0)
    }

    /// Bytes that were not read: all of them at the end.
    fn read(&mut self, to: u32, size: u32) -> Result<Option<u32>, CallError> {
        if self.requests.is_empty() && !self.closed {
            return Err(CallError::Waiting);
        }
        let count = self.requests.len().min(size as usize);
        let bytes: Vec<_> = self.requests.drain(..count).collect();
        let is_there = self.machine.core_mut().set_memory(to, &bytes);
        Ok(is_there.then_some(size - count as u32))
    }
}

fn handle(number: u32) -> Option<Handle> {
    let handles = [Handle::Console, Handle::Requests, Handle::Replies];
    handles.into_iter().find(|handle| *handle as u32 == number)
}
