//! Errors of the link to a board.

use std::io;
use std::path::Path;
use std::time::Duration;

use haptic_model::board::OtherProtocol;
use thiserror::Error;

use super::Address;
use super::holder::holders;

/// Errors of the link to a board.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum LinkError {
    #[error("cannot open {address}: {source}{}", why_not(.address))]
    Open { address: Address, source: io::Error },
    #[error(
        "no board answers on {address} within {} s{}",
        .after.as_secs_f64(),
        why_silent(.address)
    )]
    Silent { address: Address, after: Duration },
    /// The other end has closed the socket before it identified itself.
    #[error(
        "{address} is in use by another program: a board serves one at a time. If it is `haptic \
         scope`, press t there to tune, A to arm, d to disarm; or end it first"
    )]
    InUse { address: Address },
    #[error(transparent)]
    Protocol(#[from] OtherProtocol),
    #[error("the board on {address} has not answered {what} within {} s", .after.as_secs_f64())]
    Unanswered { address: Address, what: &'static str, after: Duration },
    #[error("the link to {address} is lost: {source}")]
    Lost { address: Address, source: io::Error },
}

impl LinkError {
    /// The same, where the board has not answered yet: a socket that it closes is in use. A serial line would be
    /// silent.
    pub fn before_an_answer(self) -> Self {
        use io::ErrorKind::{BrokenPipe, ConnectionReset, UnexpectedEof};
        match self {
            Self::Lost { address, source }
                if matches!(source.kind(), BrokenPipe | ConnectionReset | UnexpectedEof)
                    && !matches!(address, Address::Serial { .. }) =>
            {
                Self::InUse { address }
            }
            other => other,
        }
    }
}

/// The other programs that have a serial port open; empty for a socket.
fn holders_of(address: &Address) -> String {
    match address {
        Address::Serial { port, .. } => holders(port),
        _ => String::new(),
    }
}

/// The process that uses the port; if there is none, the available ports.
fn why_not(address: &Address) -> String {
    let holders = holders_of(address);
    if !holders.is_empty() || !matches!(address, Address::Serial { .. }) {
        return holders;
    }
    // The library panics where Linux lists no terminals, as in a container.
    let is_listed = !cfg!(target_os = "linux") || Path::new("/sys/class/tty").exists();
    let ports = is_listed.then(serialport::available_ports).and_then(Result::ok);
    match ports.filter(|ports| !ports.is_empty()) {
        None => "; there is no serial port here".to_owned(),
        Some(ports) => {
            let names: Vec<String> = ports.into_iter().map(|port| port.port_name).collect();
            format!("; the serial ports here are {}", names.join(", "))
        }
    }
}

/// Why no reply came: another process reads the port, or no board is there.
fn why_silent(address: &Address) -> String {
    match holders_of(address) {
        nobody if nobody.is_empty() => {
            ": is it powered, flashed with a scene's program, and is this its port (and its speed)?"
                .to_owned()
        }
        holders => holders,
    }
}
