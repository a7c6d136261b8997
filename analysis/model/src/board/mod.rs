//! A board that runs, in words and units: the same ones on a terminal and in a browser. What carries its
//! messages is elsewhere.

pub mod change;
pub mod formatting;
pub mod history;
mod other_protocol;
mod power;
pub mod request;
pub mod sample;
pub mod timing;

pub use other_protocol::OtherProtocol;
pub use power::Power;
