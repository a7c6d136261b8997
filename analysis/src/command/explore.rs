//! `haptic explore`: a scene in a browser, to change, watch, hold and send.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;

use super::building::{building, set_up};
use super::output_file::{FileArgument, check_writable, refuse_overwriting};
use super::shared_arguments::{warned, write};
use super::status::{CommandError, CommandStatus};
use crate::explore;
use crate::file::{self, Format};
use crate::toolchain::Tools;

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

pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let extension = arguments.output.extension().map(|e| e.to_string_lossy().to_lowercase());
    if !matches!(extension.as_deref(), Some("html" | "htm")) {
        return Err(CommandError::NoPage { path: arguments.output.clone() });
    }
    let scene = FileArgument::of("FILE", arguments.scene.as_deref().map(Path::new));
    refuse_overwriting(&[scene], &[FileArgument::of("-o", Some(&arguments.output))])?;
    // Before minutes of building.
    check_writable(&arguments.output)?;
    let page = page(arguments.scene.as_deref())?;
    write(&arguments.output, &page)?;
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
        Some(name) => {
            let (scene, keys) = file::load_with_json(name)?;
            warned(scene);
            file::canonical(keys)
        }
        None => file::as_json("wall.toml", Format::Toml, START)?,
    };
    Ok(explore::page(&module()?, &scene)?)
}

/// The program of every page.
fn module() -> Result<Vec<u8>, CommandError> {
    let toolchain = set_up(Tools::CompilerForBrowser)?;
    let what = "the certificate and the servo for a browser";
    let path = building(what, || toolchain.build_browser_module())?;
    std::fs::read(&path).map_err(|source| CommandError::Unwritable { path, source })
}

/// Opens the page with the system's default program.
fn open(page: &PathBuf) -> Result<(), CommandError> {
    let opener = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let why = match Command::new(opener).arg(page).status() {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => format!("{opener} ended with {status}"),
        Err(error) => format!("{opener}: {error}"),
    };
    Err(CommandError::NoBrowser { why })
}
