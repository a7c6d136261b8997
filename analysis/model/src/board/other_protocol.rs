//! A board with another version of the protocol.

use haptic_servo::wire::PROTOCOL;
use thiserror::Error;

/// A board with another version of the protocol.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "the board on {address} runs `{program}` with version {theirs} of the protocol, but this program speaks \
     version {PROTOCOL}: flash the board again"
)]
pub struct OtherProtocol {
    /// Where the board is.
    pub address: String,
    /// The board's program.
    pub program: String,
    /// The board's version.
    pub theirs: u16,
}
