//! The servo of scenes that the host chooses, on the emulated board.

use std::path::Path;

use firmware_harness::play::{Curtain, Play};

use super::{EmulatorError, Guest, Transport};
use crate::lockstep::RemoteServo;

/// An emulated board that plays one scene after the other.
pub struct Player {
    guest: Box<dyn Transport>,
    /// Ticks of the play that have not been played.
    left: u32,
}

impl Player {
    /// Starts the playing program; see
    /// [`build_player`](crate::toolchain::Toolchain::build_player).
    ///
    /// # Errors
    /// Where the emulator cannot be started.
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self::over(Guest::boot(elf, &[])?))
    }

    /// The same program, started by somebody else.
    pub fn over(guest: impl Transport + 'static) -> Self {
        Self { guest: Box::new(guest), left: 0 }
    }

    /// Has the board judge a scene and, where it is certified, be its servo from rest. What is left
    /// of the play before is played first, with the device at zero.
    ///
    /// # Errors
    /// Where the board has ended or does not answer.
    pub fn open(&mut self, play: &Play) -> Result<Curtain, EmulatorError> {
        while self.left > 0 {
            self.exchange(0)?;
        }
        let mut answer = [0; 8];
        self.guest.ask(&play.words(), &mut answer)?;
        let curtain = Curtain::from_bytes(answer).ok_or(EmulatorError::NoReply)?;
        if curtain == Curtain::Open {
            self.left = play.ticks;
        }
        Ok(curtain)
    }

    /// Ends the board.
    ///
    /// # Errors
    /// Where it does not end, or ends with a failure.
    pub fn finish(mut self) -> Result<(), EmulatorError> {
        while self.left > 0 {
            self.exchange(0)?;
        }
        self.guest.finish()
    }
}

impl RemoteServo for Player {
    type Error = EmulatorError;

    /// One tick of the play that is open.
    fn exchange(&mut self, raw: i32) -> Result<u16, EmulatorError> {
        let mut code = [0; 2];
        self.guest.exchange(&raw.to_le_bytes(), &mut code)?;
        self.left = self.left.saturating_sub(1);
        Ok(u16::from_le_bytes(code))
    }
}
