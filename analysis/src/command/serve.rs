//! `haptic serve`: serves a board to a page in a browser, which cannot open the board's port.

use std::io::{self, Write};
use std::net::SocketAddr;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

use clap::Args;

use super::explore;
use super::status::{CommandError, CommandStatus};
use crate::link::Address;
use crate::serve::{Port, Server};
use crate::terminal;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file, TOML or JSON, that the page starts with; `-` is standard input. As soon as the page knows
    /// the scene that runs on the board, it shows that, unless its scene was changed before
    #[arg(value_name = "FILE")]
    pub scene: Option<String>,
    /// Address of the board: /dev/ttyACM0 (@BAUD), tcp://HOST:PORT, unix:PATH
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Address of this machine to listen on; port 0 is any free one
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:0", value_parser = address)]
    pub listen: SocketAddr,
}

/// Longest time between two polls for the end.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

fn address(text: &str) -> Result<SocketAddr, String> {
    text.parse()
        .map_err(|_| format!("`{text}` is not an address with a port: expected 127.0.0.1:8080"))
}

/// Serves the page and the board's wire until Ctrl-C, or a signal to end.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let over = terminal::interrupted()?;
    Server::check(arguments.listen)?;
    // First, because a missing port is reported at once, and building a page takes a while.
    let port = Port::open(&arguments.port)?;
    let page = explore::page(arguments.scene.as_deref())?;
    let report = |sentence: &str| {
        // If the terminal is gone, the message is lost.
        let _ = writeln!(io::stderr(), "{sentence}");
    };
    let server = Server::start(port, arguments.listen, page, Box::new(report))?;
    writeln!(io::stdout(), "{}", server.url())?;
    io::stdout().flush()?;
    while !over.load(Ordering::Relaxed) {
        thread::sleep(POLL_INTERVAL);
    }
    Ok(CommandStatus::Success)
}
