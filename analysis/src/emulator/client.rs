//! Clients of the harness's programs, which answer requests in bytes.

use std::marker::PhantomData;
use std::path::Path;

use firmware_harness::scene_codec::{FRAME, decode, encode};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{EmulatorError, Guest};

/// The client of a program of the harness.
pub struct Client<Server> {
    pub(super) board: Guest,
    /// Ticks of a servo that have been requested and not run.
    pub(super) ticks_left: u32,
    server: PhantomData<Server>,
}

impl<Server> Client<Server> {
    /// Starts the program, built by [`build_harness`](crate::toolchain::Toolchain::build_harness).
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self { board: Guest::boot(elf)?, ticks_left: 0, server: PhantomData })
    }

    /// Sends a request to the board, and returns its reply.
    pub(super) fn ask<Q: Serialize, R: DeserializeOwned>(
        &mut self,
        request: &Q,
    ) -> Result<R, EmulatorError> {
        let mut reply = [0; FRAME];
        self.board.exchange(&encode(request), &mut reply)?;
        decode(&reply).ok_or(EmulatorError::NoReply)
    }

    /// The code of a servo for a count.
    pub(super) fn tick(&mut self, raw: i32) -> Result<u16, EmulatorError> {
        let mut code = [0; 2];
        self.board.exchange(&raw.to_le_bytes(), &mut code)?;
        self.ticks_left = self.ticks_left.saturating_sub(1);
        Ok(u16::from_le_bytes(code))
    }

    /// Runs the remaining ticks of a servo, with the device at zero.
    pub(super) fn run_ticks_left(&mut self) -> Result<(), EmulatorError> {
        while self.ticks_left > 0 {
            self.tick(0)?;
        }
        Ok(())
    }

    /// Ends the board.
    pub fn finish(mut self) -> Result<(), EmulatorError> {
        self.run_ticks_left()?;
        self.board.finish().map(drop)
    }
}
