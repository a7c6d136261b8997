//! The state that all threads of a server share.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::access::Access;
use super::connections::Connections;
use super::port::{Report, Seats};

/// The data for every connection.
pub(super) struct Shared {
    pub access: Access,
    pub page: String,
    pub seats: Seats,
    pub over: Arc<AtomicBool>,
    pub connections: Connections,
    pub report: Report,
}
