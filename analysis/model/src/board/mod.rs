//! A running board in words and units, the same on a terminal and in a browser. The transport of its messages
//! is elsewhere.

pub mod budget;
pub mod change;
pub mod client;
pub mod formatting;
pub mod history;
mod other_protocol;
mod power;
mod report;
pub mod request;
pub mod sample;
pub mod timing;

pub use other_protocol::OtherProtocol;
pub use power::Power;
pub use report::Report;
