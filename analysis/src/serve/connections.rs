//! The open connections: a limited number, in which a client without the token makes room for the next one.

use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Largest number of connections: a page uses two, and a browser opens some in advance.
pub const CONNECTIONS: usize = 16;

/// The open connections.
#[derive(Default)]
pub(super) struct Connections(Mutex<State>);

#[derive(Default)]
struct State {
    /// Connections accepted so far.
    accepted: u64,
    /// The oldest first.
    open: Vec<Open>,
}

struct Open {
    number: u64,
    stream: Arc<TcpStream>,
    /// Whether its client has sent the token.
    is_trusted: bool,
}

/// A connection that is served; makes room when dropped.
pub(super) struct Connection {
    connections: Arc<Connections>,
    number: u64,
}

impl Connections {
    /// Makes a connection one of the open ones. At the limit, closes the oldest one whose client has not sent
    /// the token: programs of this machine share an address, so nothing else distinguishes a client that
    /// holds connections from the page. `None` if all clients have sent it.
    pub fn open(self: &Arc<Self>, stream: &Arc<TcpStream>) -> Option<Connection> {
        let mut state = self.state();
        if state.open.len() >= CONNECTIONS {
            let oldest = state.open.iter().position(|open| !open.is_trusted)?;
            close(&state.open.remove(oldest));
        }
        state.accepted += 1;
        let number = state.accepted;
        state.open.push(Open { number, stream: stream.clone(), is_trusted: false });
        Some(Connection { connections: self.clone(), number })
    }

    /// Closes all connections.
    pub fn close(&self) {
        self.state().open.iter().for_each(close);
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // The state is valid after a panic, too: every change of it is complete.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Its thread then reads the end of the connection. A connection that the client has closed is closed already.
fn close(open: &Open) {
    let _ = open.stream.shutdown(Shutdown::Both);
}

impl Connection {
    /// The client has sent the token.
    pub fn trust(&self) {
        let mut state = self.connections.state();
        if let Some(open) = state.open.iter_mut().find(|open| open.number == self.number) {
            open.is_trusted = true;
        }
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.connections.state().open.retain(|open| open.number != self.number);
    }
}
