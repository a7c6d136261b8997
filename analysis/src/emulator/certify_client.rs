//! Certificates computed by the emulated board, for scenes from the host.

use firmware_harness::scene_codec::{CertifyReply, CertifyRequest};
use haptic_servo::scene::Scene;

use super::EmulatorError;
use super::client::Client;

/// The program `certify_server`.
pub enum CertifyServer {}

/// The client of a board that certifies scenes.
pub type CertifyClient = Client<CertifyServer>;

impl CertifyClient {
    /// Lets the board certify a scene.
    pub fn certify(&mut self, scene: &Scene) -> Result<CertifyReply, EmulatorError> {
        self.ask(&CertifyRequest(*scene))
    }
}
