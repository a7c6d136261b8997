//! Certificates computed by the emulated board, for scenes from the host.

use std::path::Path;

use firmware_harness::scene_codec::{CertifyReply, ReplyWords, SceneWords, decode_reply, encode};
use haptic_servo::scene::Scene;

use super::{EmulatorError, Guest, Transport};

/// An emulated board that certifies scenes.
pub struct CertifyClient {
    guest: Box<dyn Transport>,
}

impl CertifyClient {
    /// Starts `certify_server`, built by [`build_harness`](crate::toolchain::Toolchain::build_harness).
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self::with_transport(Guest::boot(elf, &[])?))
    }

    /// A client of a running program.
    pub fn with_transport(guest: impl Transport + 'static) -> Self {
        Self { guest: Box::new(guest) }
    }

    /// Lets the board certify a scene.
    pub fn certify(&mut self, scene: &Scene) -> Result<CertifyReply, EmulatorError> {
        let mut words = [[0; 8]; size_of::<ReplyWords>() / 8];
        self.guest.ask(&encode(scene), words.as_flattened_mut())?;
        decode_reply(&words.map(u64::from_le_bytes)).ok_or(EmulatorError::NoReply)
    }

    /// Ends the board.
    pub fn finish(self) -> Result<(), EmulatorError> {
        self.guest.finish()
    }
}

/// A request fits into a pipe's buffer, so that sending it never waits for the board.
const _: () = assert!(size_of::<SceneWords>() <= 4096);
