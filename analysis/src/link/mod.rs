//! A board at the other end of a serial line or a socket.

mod address;
mod connection;
mod error;
mod holder;
mod transport;

pub use address::Address;
pub(crate) use connection::Wire;
pub use connection::{Link, Message};
pub use error::LinkError;
pub use haptic_model::board::change;
pub use haptic_model::board::client::frame;
pub use haptic_model::board::request::RequestResult;
pub(crate) use transport::{Transport, is_timeout, open, read_within};
