//! A board at the other end of a serial line or a socket.

mod address;
pub mod change;
mod connection;
mod error;
mod holder;
mod transport;

pub use address::{Address, AddressError};
pub(crate) use connection::REQUEST_TIMING;
pub use connection::{Link, Message, RequestResult};
pub use error::LinkError;
pub(crate) use transport::{Transport, is_timeout, open};
