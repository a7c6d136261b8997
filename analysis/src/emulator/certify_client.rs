//! Certificates computed by the emulated board, for scenes from the host.

use std::path::Path;

use firmware_harness::scene_codec::{CertifyReply, CertifyRequest};
use haptic_servo::scene::Scene;

use super::transport::ask;
use super::{EmulatorError, Guest, Transport};

/// An emulated board that certifies scenes.
pub struct CertifyClient {
    guest: Box<dyn Transport>,
}

impl CertifyClient {
    /// Starts `certify_server`, built by [`build_harness`](crate::toolchain::Toolchain::build_harness).
    ///
    /// # Errors
    /// If the emulator cannot be started.
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self::with_transport(Guest::boot(elf, &[])?))
    }

    /// A client of a running program.
    pub fn with_transport(guest: impl Transport + 'static) -> Self {
        Self { guest: Box::new(guest) }
    }

    /// Lets the board certify a scene.
    ///
    /// # Errors
    /// If the board has ended or does not answer.
    pub fn certify(&mut self, scene: &Scene) -> Result<CertifyReply, EmulatorError> {
        ask(&mut *self.guest, &CertifyRequest(*scene))
    }

    /// Ends the board.
    ///
    /// # Errors
    /// If it does not end, or ends with a failure.
    pub fn finish(self) -> Result<(), EmulatorError> {
        self.guest.finish()
    }
}
