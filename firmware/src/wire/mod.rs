//! Protocol of a board and its host, as bytes on a serial line or a socket. [`message`] lists the messages,
//! [`mod@frame`] and [`decoder`] carry it, [`telemetry`] packs ticks, [`session`] answers on the board. With
//! a [`description`] of the running scene the host computes the text of a refusal. [`sweep`] has the requests to
//! a board that plays a sweep. The host sends requests
//! and the board answers; without a request the board sends only telemetry, once a host has started it.

mod changes;
pub mod decoder;
pub mod description;
pub mod frame;
pub mod host;
mod link;
pub mod message;
pub mod session;
pub mod sweep;
pub mod telemetry;

pub use decoder::{Decoder, Discarded};
pub use frame::{CHECKSUM, TooLong, encode, largest_frame};
pub use link::{BroughtUp, Link, Port, bring_up};
pub use message::PROTOCOL;
pub use session::{BoardInfo, Session};

#[cfg(test)]
mod tests;
