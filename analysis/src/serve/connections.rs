//! The open connections: a limited number, in which a client without the token makes room for the next one.

use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// Largest number of connections: a page uses two, and a browser opens some in advance.
pub const CONNECTIONS: usize = 16;

/// The open connections, the oldest first.
#[derive(Default)]
pub(super) struct Connections(Mutex<Vec<Weak<Connection>>>);

/// A connection that is served; makes room when dropped.
pub(super) struct Connection {
    pub stream: TcpStream,
    /// Whether its client has sent the token.
    is_trusted: AtomicBool,
}

impl Connections {
    /// Makes a connection one of the open ones. At the limit, closes the oldest one whose client has not sent
    /// the token: programs of this machine share an address, so nothing else distinguishes a client that
    /// holds connections from the page. Returns the stream if all clients have sent it.
    pub fn open(&self, stream: TcpStream) -> Result<Arc<Connection>, TcpStream> {
        let mut open = self.lock();
        open.retain(|one| one.strong_count() > 0);
        if open.len() >= CONNECTIONS {
            let is_trusted = |one: &Connection| one.is_trusted.load(Ordering::Relaxed);
            let may_go =
                |one: &Weak<Connection>| one.upgrade().is_some_and(|one| !is_trusted(&one));
            let Some(oldest) = open.iter().position(may_go) else { return Err(stream) };
            close(&open.remove(oldest));
        }
        let connection = Arc::new(Connection { stream, is_trusted: AtomicBool::new(false) });
        open.push(Arc::downgrade(&connection));
        Ok(connection)
    }

    /// Closes all connections.
    pub fn close(&self) {
        self.lock().iter().for_each(close);
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Weak<Connection>>> {
        // The list is valid after a panic, too: every change of it is complete.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Its thread then reads the end of the connection. A connection that the client has closed is closed already.
fn close(connection: &Weak<Connection>) {
    if let Some(connection) = connection.upgrade() {
        let _ = connection.stream.shutdown(Shutdown::Both);
    }
}

impl Connection {
    /// The client has sent the token.
    pub fn trust(&self) {
        self.is_trusted.store(true, Ordering::Relaxed);
    }
}
