//! A client of a haptic board.
//!
//! [`Link`] asks a board behind a serial port or a socket and waits for its answers; [`BoardPoller`] receives all
//! that it sends in a thread, and connects again when the link is lost. Both carry the conversation of
//! [`haptic_model::board::client`], which has neither a port nor a clock. A [`simulated`] board answers like a
//! real one.
//!
//! ```
//! use haptic_client::simulated::{Pacing, SimulatedBoard};
//! use haptic_client::{Address, Link, RequestResult};
//! use haptic_model::file::{Format, example, parse};
//!
//! let text = example::toml("damper-wall").expect("an example");
//! let file = parse("wall.toml", Format::Toml, &text)?;
//! let address = Address::Tcp("127.0.0.1:0".to_owned());
//! let board = SimulatedBoard::of_file(&file, &address, Pacing::RealTime)?;
//!
//! let mut link = Link::open(board.address())?;
//! assert_eq!(link.arm()?, RequestResult::Done);
//! assert!(link.status()?.state.is_armed());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
// Empty for a board, whose programs are built from the same workspace.
#![cfg(not(target_os = "none"))]

mod address;
mod error;
mod holder;
mod link;
mod poller;
pub mod simulated;
mod stream;
#[cfg(test)]
mod tests;
mod transport;

pub use address::Address;
pub use error::LinkError;
pub use haptic_model::board::change;
pub use haptic_model::board::client::{Connected, Event, frame};
pub use haptic_model::board::request::{Reply, Request, RequestResult};
pub use link::Link;
pub use poller::BoardPoller;
pub use stream::{StreamError, StreamTick};
pub use transport::{Transport, is_timeout, open, read_within};

/// A message of a board that owns its text.
pub type Message = haptic_servo::wire::message::ToHost<String>;
