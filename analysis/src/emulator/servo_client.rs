//! Servos on the emulated board, for scenes from the host.

use firmware_harness::loop_request::{LoopRequest, StartReply};

use super::EmulatorError;
use super::client::Client;
use crate::lockstep::RemoteServo;

/// The program `servo_server`.
pub enum ServoServer {}

/// The client of a board that runs the servos of several scenes, one after the other.
pub type ServoClient = Client<ServoServer>;

impl ServoClient {
    /// Lets the board certify a scene and, if it passes, run its servo from rest. The remaining ticks of the
    /// previous request run first, with the device at zero.
    pub fn start(&mut self, request: &LoopRequest) -> Result<StartReply, EmulatorError> {
        self.run_ticks_left()?;
        let reply = self.ask(request)?;
        if reply == StartReply::Ready {
            self.ticks_left = request.ticks;
        }
        Ok(reply)
    }
}

impl RemoteServo for ServoClient {
    type Error = EmulatorError;

    /// One tick of the current request.
    fn exchange(&mut self, raw: i32) -> Result<u16, EmulatorError> {
        self.tick(raw)
    }
}
