//! A board at the other end of a serial line or a socket.

mod address;
mod connection;
mod error;
mod transport;

pub use address::{Address, AddressError};
pub use connection::{Answer, Link, Message};
pub use error::LinkError;
