//! The transport of requests to a measuring program, and of its answers.

use firmware_harness::scene_codec::{FRAME, decode, encode};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{EmulatorError, Guest};

/// A board with a program that answers requests in bytes.
pub trait Transport {
    /// Sends bytes to the board and waits until it has filled `answer`.
    ///
    /// # Errors
    /// If it does not answer.
    fn exchange(&mut self, request: &[u8], answer: &mut [u8]) -> Result<(), EmulatorError>;

    /// Ends the requests, and waits for the program's end.
    ///
    /// # Errors
    /// If it does not end, or ends with a failure.
    fn finish(self: Box<Self>) -> Result<(), EmulatorError>;
}

/// Sends a request to the board, and returns its reply.
///
/// # Errors
/// If it does not answer.
pub(super) fn ask<Q: Serialize, R: DeserializeOwned>(
    guest: &mut dyn Transport,
    request: &Q,
) -> Result<R, EmulatorError> {
    let mut reply = [0; FRAME];
    guest.exchange(&encode(request), &mut reply)?;
    decode(&reply).ok_or(EmulatorError::NoReply)
}

/// Through pipes to QEMU.
impl Transport for Guest {
    fn exchange(&mut self, request: &[u8], answer: &mut [u8]) -> Result<(), EmulatorError> {
        Self::exchange(self, request, answer)
    }

    fn finish(self: Box<Self>) -> Result<(), EmulatorError> {
        Self::finish(*self).map(drop)
    }
}
