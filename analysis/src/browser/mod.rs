//! A headless browser, driven by the protocol of its developer tools, to examine pages.

mod devtools;
mod site;

pub use devtools::Page;
pub use site::Site;

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;
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
pub enum BrowserError {
    /// There is no browser.
    #[error("there is no {NAME}; install it (Debian: apt install {NAME})")]
    Missing,
    /// It could not be started, or the folder of its profile could not be created.
    #[error("{NAME} could not be started: {0}")]
    Unstartable(#[source] io::Error),
    /// It does not report where its tools listen.
    #[error("{NAME} did not start within {} s", TIMEOUT.as_secs())]
    NotStarted,
    /// The connection to its tools has failed.
    #[error("the developer tools of {NAME} have broken off: {0}")]
    Socket(#[source] Box<tungstenite::Error>),
    /// They sent a message that is not of their protocol.
    #[error("the developer tools of {NAME} have sent `{said}`, which is not a message: {source}")]
    NoMessage {
        /// The message.
        said: String,
        /// The reason.
        source: serde_json::Error,
    },
    /// They refuse a call, or answer without the requested value.
    #[error("{method}: {answer}")]
    Refused {
        /// The method of their protocol.
        method: String,
        /// The answer.
        answer: Value,
    },
    /// A page cannot be opened.
    #[error("{address} could not be opened: {why}")]
    Unopened {
        /// Its address.
        address: String,
        /// The cause.
        why: Value,
    },
    /// An expression has thrown.
    #[error("`{expression}` has thrown: {error}")]
    Thrown {
        /// The expression.
        expression: String,
        /// The exception.
        error: Value,
    },
    /// An expression that was waited for has not become true.
    #[error(
        "`{expression}` was not true within {} s; the page complains of {complaints:?}", TIMEOUT.as_secs()
    )]
    NeverTrue {
        /// The expression.
        expression: String,
        /// Errors and warnings of the page's console.
        complaints: Vec<String>,
    },
    /// Clicks on an element have hit others.
    #[error("`{selector}` was not clicked within {} s: another element is before it", TIMEOUT.as_secs())]
    NotClicked {
        /// The selector of the element.
        selector: String,
    },
    /// An expression has a value of the wrong type.
    #[error("`{expression}` is {value}; it must be {kind}")]
    OtherKind {
        /// The expression.
        expression: String,
        /// Its value.
        value: Value,
        /// The requirement.
        kind: &'static str,
    },
    /// A page cannot be served.
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
