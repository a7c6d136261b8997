//! Servos on the emulated board, for scenes from the host.

use std::path::Path;

use firmware_harness::loop_request::{LoopRequest, StartReply};

use super::{EmulatorError, Guest, Transport};
use crate::lockstep::RemoteServo;

/// An emulated board that runs the servos of several scenes, one after the other.
pub struct ServoClient {
    guest: Box<dyn Transport>,
    /// Ticks of the request that have not been run.
    ticks_left: u32,
}

impl ServoClient {
    /// Starts `servo_server`, built by [`build_harness`](crate::toolchain::Toolchain::build_harness).
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self::with_transport(Guest::boot(elf, &[])?))
    }

    /// A client of a running program.
    pub fn with_transport(guest: impl Transport + 'static) -> Self {
        Self { guest: Box::new(guest), ticks_left: 0 }
    }

    /// Lets the board certify a scene and, if it passes, run its servo from rest. The remaining ticks of the
    /// previous request run first, with the device at zero.
    pub fn start(&mut self, request: &LoopRequest) -> Result<StartReply, EmulatorError> {
        while self.ticks_left > 0 {
            self.exchange(0)?;
        }
        let mut answer = [0; 8];
        self.guest.ask(&request.encode(), &mut answer)?;
        let reply = StartReply::from_bytes(answer).ok_or(EmulatorError::NoReply)?;
        if reply == StartReply::Ready {
            self.ticks_left = request.ticks;
        }
        Ok(reply)
    }

    /// Ends the board.
    pub fn finish(mut self) -> Result<(), EmulatorError> {
        while self.ticks_left > 0 {
            self.exchange(0)?;
        }
        self.guest.finish()
    }
}

impl RemoteServo for ServoClient {
    type Error = EmulatorError;

    /// One tick of the current request.
    fn exchange(&mut self, raw: i32) -> Result<u16, EmulatorError> {
        let mut code = [0; 2];
        self.guest.exchange(&raw.to_le_bytes(), &mut code)?;
        self.ticks_left = self.ticks_left.saturating_sub(1);
        Ok(u16::from_le_bytes(code))
    }
}
