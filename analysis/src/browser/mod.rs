//! A headless browser, driven by the protocol of its developer tools, to examine pages.

mod devtools;
mod site;

pub use devtools::Page;
pub use site::Site;

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use thiserror::Error;

/// Name of the browser and of its package.
pub const NAME: &str = "chromium";

/// Timeout of its operations, its start included, on a slow machine.
pub const TIMEOUT: Duration = Duration::from_secs(120);

/// No window; no sandbox, which is not available to root; no network traffic of its own.
const ARGUMENTS: [&str; 9] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
];

/// The reason why a page could not be examined.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum BrowserError {
    #[error("there is no {NAME}; install it (Debian: apt install {NAME})")]
    Missing,
    #[error("{NAME} could not be started: {0}")]
    Unstartable(#[source] io::Error),
    #[error("{NAME} did not start within {} s", TIMEOUT.as_secs())]
    NotStarted,
    #[error("the developer tools of {NAME} have broken off: {0}")]
    Socket(#[source] Box<tungstenite::Error>),
    /// The browser, or the page in it, does not do what it should: a sentence.
    #[error("{0}")]
    Page(String),
    #[error("a page could not be given out on this machine: {0}")]
    Site(#[source] io::Error),
}

impl From<tungstenite::Error> for BrowserError {
    fn from(error: tungstenite::Error) -> Self {
        Self::Socket(Box::new(error))
    }
}

/// The command that starts the browser, with a folder for its profile and a window of this width and height
/// in pixels.
pub fn command(profile: &Path, [width, height]: [u32; 2]) -> Command {
    let mut command = Command::new(NAME);
    command
        .args(ARGUMENTS)
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("--window-size={width},{height}"))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}
