//! The certificate as the emulated board computes it, for scenes that the host chooses.

use std::path::Path;

use firmware::scene::Scene;
use firmware_harness::question::{Question, Reply, ReplyWords, ask, reply};

use super::{EmulatorError, Guest, Transport};

/// An emulated board that judges scenes.
pub struct Judge {
    guest: Box<dyn Transport>,
}

impl Judge {
    /// Starts the judging program; see [`build_judge`](crate::toolchain::Toolchain::build_judge).
    ///
    /// # Errors
    /// Where the emulator cannot be started.
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self::over(Guest::boot(elf, &[])?))
    }

    /// The same program, started by somebody else.
    pub fn over(guest: impl Transport + 'static) -> Self {
        Self { guest: Box::new(guest) }
    }

    /// Has the board judge a scene.
    ///
    /// # Errors
    /// Where the board has ended or does not answer.
    pub fn judge(&mut self, scene: &Scene) -> Result<Reply, EmulatorError> {
        let mut words = [[0; 8]; size_of::<ReplyWords>() / 8];
        self.guest.ask(&ask(scene), words.as_flattened_mut())?;
        reply(&words.map(u64::from_le_bytes)).ok_or(EmulatorError::NoReply)
    }

    /// Ends the board.
    ///
    /// # Errors
    /// Where it does not end, or ends with a failure.
    pub fn finish(self) -> Result<(), EmulatorError> {
        self.guest.finish()
    }
}

/// A question fits into a pipe at once, so that asking never waits for the board.
const _: () = assert!(size_of::<Question>() <= 4096);
