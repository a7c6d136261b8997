//! Prepares this machine to build for the board, or states the steps for the user.

use std::io;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use super::apt::{self, Apt, AptError};
use super::build::{Toolchain, Workspace};
use super::host_environment::Package;
use super::observe::{Findings, is_root, observe};
use super::output::last_lines;
use super::plan::{ManualStep, Plan, Step, Tools, plan};
use super::unpacked::Unpacked;
use super::{BuildError, Target};

/// The reason why programs for the board cannot be built here.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The user must do something first.
    #[error("tools to build and run the programs for boards are missing:{}", bullets(.0))]
    Missing(Vec<ManualStep>),
    /// A step could not be started.
    #[error("`{step}` could not be run: {source}")]
    Unrunnable {
        /// The step.
        step: Step,
        /// The cause.
        source: io::Error,
    },
    /// A step failed.
    #[error("`{step}` ended with {status}:\n{output}")]
    Failed {
        /// The step.
        step: Step,
        /// Its exit status.
        status: ExitStatus,
        /// The end of its output.
        output: String,
    },
    /// Packages were not installed.
    #[error(transparent)]
    Apt(#[from] AptError),
    /// A step was taken without effect.
    #[error("`{0}` succeeded, but the package that it should install is still not found")]
    InVain(Step),
    /// The workspace cannot be found or written to.
    #[error(transparent)]
    Workspace(#[from] BuildError),
}

fn bullets(requests: &[ManualStep]) -> String {
    requests.iter().map(|request| format!("\n  - {request}")).collect()
}

/// Ensures that programs for the board can be built and, if requested, run; returns the toolchain.
///
/// As root on Debian it installs missing packages. If that would remove a package, or without root's rights, it
/// unpacks them into a folder of this workspace. With rustup it adds the target, unless the machine's owner
/// forbids it. `progress` receives each step before it is taken. No package is ever removed.
///
/// # Errors
/// Otherwise, [`SetupError::Missing`] states exactly what to install.
pub fn prepare(tools: Tools, progress: impl Fn(&str)) -> Result<Toolchain, SetupError> {
    let workspace = Workspace::find()?;
    // Two programs that install at the same time would disturb each other.
    let _lock = workspace.lock("setup")?;
    let unpacked = workspace.unpacked();
    let apt = Apt::of(is_root(), unpacked.folder());
    let mut findings = Findings::default();
    let mut taken = Vec::new();
    loop {
        let host = observe(tools.target(), &unpacked, &apt, &findings);
        let step = match plan(&host, tools) {
            Plan::Ready(compiler) => return Ok(Toolchain::new(compiler, workspace)),
            Plan::Ask(requests) => return Err(SetupError::Missing(requests)),
            Plan::Do(step) => step,
        };
        if taken.contains(&step) {
            return Err(SetupError::InVain(step));
        }
        match (take(&step, &apt, &unpacked, &progress), &step) {
            (Err(SetupError::Apt(AptError::Removes { changes, .. })), Step::Install(packages)) => {
                progress(&format!("{step} {changes}: not done"));
                findings.conflicting.extend(conflicting(&apt, packages)?);
                continue;
            }
            // A mirror may have dropped the versions that old lists name.
            (Err(SetupError::Apt(AptError::Failed { .. })), Step::Install(_) | Step::Unpack(_))
                if !findings.lists_are_fresh =>
            {
                take(&Step::FetchLists, &apt, &unpacked, &progress)?;
                findings.lists_are_fresh = true;
                continue;
            }
            (result, _) => result?,
        }
        findings.lists_are_fresh |= step == Step::FetchLists;
        taken.push(step);
    }
}

/// The packages of a list that cannot be installed without removing others.
fn conflicting(apt: &Apt, packages: &[Package]) -> Result<Vec<Package>, AptError> {
    let mut found = Vec::new();
    for package in packages {
        if !apt.changes(&[package.name()])?.removed.is_empty() {
            found.push(*package);
        }
    }
    // Together they may remove what none removes alone.
    Ok(if found.is_empty() { packages.to_vec() } else { found })
}

/// Announces a step and takes it.
fn take(
    step: &Step,
    apt: &Apt,
    unpacked: &Unpacked,
    progress: &impl Fn(&str),
) -> Result<(), SetupError> {
    match step {
        Step::AddTarget(target) => {
            progress(&step.to_string());
            add_target(step, *target)
        }
        Step::FetchLists => {
            progress(&step.to_string());
            Ok(apt.update()?)
        }
        Step::Install(packages) => {
            let names: Vec<_> = packages.iter().map(|package| package.name()).collect();
            Ok(apt.install(&names, progress)?)
        }
        Step::Unpack(packages) => Ok(unpacked.add(packages, apt, progress)?),
    }
}

fn add_target(step: &Step, target: Target) -> Result<(), SetupError> {
    let output = Command::new("rustup")
        .args(["target", "add", target.name()])
        .stdin(Stdio::null())
        .output()
        .map_err(|source| SetupError::Unrunnable { step: step.clone(), source })?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].concat();
    Err(SetupError::Failed {
        step: step.clone(),
        status: output.status,
        output: last_lines(&String::from_utf8_lossy(&said), 20),
    })
}

/// Makes sure that a program is installed beside the project; its package has the same name.
///
/// # Errors
/// As for [`set_up_package`].
pub fn set_up_tool(name: &str) -> Result<(), String> {
    set_up_package(name, &[name, "--version"])
}

/// Makes sure that a package is installed beside the project: `command` has to succeed. If it fails, root on
/// Debian installs the package, as for the project's other tools.
///
/// # Errors
/// Elsewhere, with the package to install.
pub fn set_up_package(package: &str, command: &[&str]) -> Result<(), String> {
    let run = || Command::new(command[0]).args(&command[1..]).output();
    let is_there = || run().is_ok_and(|output| output.status.success());
    if is_there() {
        return Ok(());
    }
    let by_hand = format!("install it (Debian: apt install {package})");
    match install(&[package], |step| eprintln!("{step}")) {
        Ok(()) if is_there() => Ok(()),
        Ok(()) => Err(by_hand),
        Err(error) => Err(format!("{error}; {by_hand}")),
    }
}

/// Installs Debian packages that no board's program needs, if this machine allows it: as root, and without
/// removing packages.
///
/// # Errors
/// If it does not allow it, or if it fails.
fn install(packages: &[&str], progress: impl Fn(&str)) -> Result<(), AptError> {
    if !is_root() {
        return Err(AptError::NotRoot(apt::by_hand(packages)));
    }
    let apt = Apt::of(true, Path::new(""));
    let install = || apt.install(packages, &progress);
    match install() {
        Err(AptError::Failed { .. }) => {
            apt.update()?;
            install()
        }
        result => result,
    }
}
