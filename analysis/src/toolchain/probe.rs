//! Passes a program to probe-rs, which flashes it through a debug probe and shows its log.

use std::io;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use object::{Object, ObjectSection};

/// The program for debug probes.
pub const PROBE_RS: &str = "probe-rs";

/// Section of a program that contains the name of its chip.
const CHIP: &str = ".probe-rs.chip";

/// The reason why a program could not be flashed.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum ProbeError {
    #[error(
        "{PROBE_RS} is not installed: cargo install --locked probe-rs-tools, or see \
         https://probe.rs/docs/getting-started/installation"
    )]
    NotInstalled,
    #[error("{PROBE_RS} could not be started: {0}")]
    Start(#[source] io::Error),
    #[error(
        "no debug probe was found: connect the USB port of the board (on Linux, access needs the \
         udev rules of https://probe.rs/docs/getting-started/probe-setup)"
    )]
    NoProbe,
    #[error("the program does not say which chip it is for: {0}")]
    NoChip(String),
    /// probe-rs has printed the reason.
    #[error("{PROBE_RS} ended with {0}")]
    Failed(ExitStatus),
}

/// The name of a program's chip.
pub fn chip(elf: &[u8]) -> Result<String, ProbeError> {
    let file = object::File::parse(elf).map_err(|error| ProbeError::NoChip(error.to_string()))?;
    let section = file.section_by_name(CHIP);
    let data = section.and_then(|section| section.data().ok()).unwrap_or_default();
    match std::str::from_utf8(data) {
        Ok(name) if !name.is_empty() => Ok(name.into()),
        _ => Err(ProbeError::NoChip(format!("it has no section {CHIP}"))),
    }
}

/// Flashes a program and shows its log until the program or the user ends it.
///
/// `probe` selects one of several probes, in the format of probe-rs.
pub fn run(elf: &Path, chip: &str, probe: Option<&str>) -> Result<(), ProbeError> {
    if !any_probe()? {
        return Err(ProbeError::NoProbe);
    }
    let mut command = Command::new(PROBE_RS);
    command.args(["run", "--chip", chip]);
    if let Some(probe) = probe {
        command.args(["--probe", probe]);
    }
    let status = command.arg(elf).status().map_err(unstarted)?;
    if status.success() { Ok(()) } else { Err(ProbeError::Failed(status)) }
}

/// Whether probe-rs finds a probe. If it cannot list probes, it will report this when it flashes.
fn any_probe() -> Result<bool, ProbeError> {
    let listing = Command::new(PROBE_RS).arg("list").stdin(Stdio::null()).output();
    let listing = listing.map_err(unstarted)?;
    let said = [listing.stdout, listing.stderr].concat();
    Ok(!String::from_utf8_lossy(&said).contains("No debug probes"))
}

fn unstarted(error: io::Error) -> ProbeError {
    match error.kind() {
        io::ErrorKind::NotFound => ProbeError::NotInstalled,
        _ => ProbeError::Start(error),
    }
}
