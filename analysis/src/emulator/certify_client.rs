//! Certificates computed by the emulated board, for scenes from the host.

use firmware_harness::scene_codec::{CertifyReply, ReplyWords, SceneWords, decode_reply, encode};
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
        let mut words = [[0; 8]; size_of::<ReplyWords>() / 8];
        self.board.ask(&encode(scene), words.as_flattened_mut())?;
        decode_reply(&words.map(u64::from_le_bytes)).ok_or(EmulatorError::NoReply)
    }
}

/// A request fits into a pipe's buffer, so that sending it never waits for the board.
const _: () = assert!(size_of::<SceneWords>() <= 4096);
