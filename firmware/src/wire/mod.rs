//! Protocol of a board and its host, as bytes on a serial line or a socket. [`message`] lists the messages,
//! [`mod@frame`] and [`decoder`] carry it, [`telemetry`] packs ticks, [`session`] answers on the board, and
//! with a [`description`] of the running scene the host has the words for a refusal. The host asks and the
//! board answers; of itself the board sends telemetry only, once it was asked to.

mod changes;
pub mod decoder;
pub mod description;
pub mod frame;
mod link;
pub mod message;
pub mod session;
pub mod telemetry;

pub use decoder::{Decoder, Discarded};
pub use frame::{CHECKSUM, TooLong, encode, largest_frame};
pub use link::{BroughtUp, Link, Port, bring_up};
pub use session::{BoardInfo, Session};

/// Version of the messages. Board and host must have the same; [`message::ToBoard::Hello`] and
/// [`message::ToHost::Welcome`] begin alike in all versions, so that each can say which it has.
pub const PROTOCOL: u16 = 7;

#[cfg(test)]
mod tests;
