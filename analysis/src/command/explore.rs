//! `haptic explore`: a scene in a browser, to change, watch, hold and send.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::Command;

use clap::Args;

use super::status::{CommandError, CommandStatus};
use crate::explore;
use crate::file::{self, Format};
use crate::progress;
use crate::toolchain::{self, Tools};

/// Arguments of `haptic explore`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file, TOML or JSON, that the page starts with; `-` is standard input. Without it the page
    /// starts with the damper wall of the paper
    #[arg(value_name = "FILE")]
    pub scene: Option<String>,
    /// File of the page, .html
    #[arg(short, long, value_name = "PAGE")]
    pub output: PathBuf,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
}

/// The scene of a page without a file.
const START: &str = include_str!("../../pictures/wall.toml");

/// Writes the page.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let extension = arguments.output.extension().map(|e| e.to_string_lossy().to_lowercase());
    if !matches!(extension.as_deref(), Some("html" | "htm")) {
        return Err(CommandError::NoPage { path: arguments.output.clone() });
    }
    let unwritable = |source| CommandError::Unwritable { path: arguments.output.clone(), source };
    let page = page(arguments.scene.as_deref())?;
    std::fs::write(&arguments.output, &page).map_err(unwritable)?;
    let kilobytes = page.len().div_ceil(1000);
    writeln!(io::stdout().lock(), "{}: {kilobytes} kB", arguments.output.display())?;
    if arguments.open {
        open(&arguments.output)?;
    }
    Ok(CommandStatus::Success)
}

/// The page that starts with this scene.
pub(super) fn page(scene: Option<&str>) -> Result<String, CommandError> {
    let scene = match scene {
        Some(name) => file::load_json(name)?,
        None => file::as_json("wall.toml", Format::Toml, START)?,
    };
    Ok(explore::page(&module()?, &scene)?)
}

/// The program of every page.
pub(super) fn module() -> Result<Vec<u8>, CommandError> {
    let toolchain =
        toolchain::prepare(Tools::CompilerForBrowser, |step| eprintln!("set-up: {step}"))?;
    let spinner = progress::spinner("building the certificate and the servo for a browser");
    let path = toolchain.build_browser_module()?;
    let module =
        std::fs::read(&path).map_err(|source| CommandError::Unwritable { path, source })?;
    spinner.finish_and_clear();
    Ok(module)
}

/// Opens the page with the system's default program.
fn open(page: &PathBuf) -> Result<(), CommandError> {
    let opener = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let status = Command::new(opener).arg(page).status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(CommandError::NoBrowser { why: format!("{opener} ended with {status}") }),
        Err(error) => Err(CommandError::NoBrowser { why: format!("{opener}: {error}") }),
    }
}
