//! Prepares this machine to build for the board, or states the steps for the user.

use std::io;
use std::process::{Command, ExitStatus, Stdio};

use super::apt::{Apt, AptError, person_agrees};
use super::build::{Toolchain, Workspace};
use super::observe::observe;
use super::output::last_lines;
use super::plan::{ManualStep, Plan, Step, Tools, plan};
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
/// As root on Debian it installs missing packages; with rustup it adds the target, unless the machine's owner
/// forbids it. `progress` receives each step before it is taken. A package is removed only after a yes at the
/// terminal.
///
/// # Errors
/// Otherwise, [`SetupError::Missing`] states exactly what to install.
pub fn prepare(tools: Tools, progress: impl Fn(&str)) -> Result<Toolchain, SetupError> {
    let workspace = Workspace::find()?;
    // Two programs that install at the same time would disturb each other.
    let _lock = workspace.lock("setup")?;
    let mut taken = Vec::new();
    loop {
        let step = match plan(&observe(tools.target(), taken.contains(&Step::FetchLists)), tools) {
            Plan::Ready(compiler) => return Ok(Toolchain::new(compiler, workspace)),
            Plan::Ask(requests) => return Err(SetupError::Missing(requests)),
            Plan::Do(step) => step,
        };
        if taken.contains(&step) {
            return Err(SetupError::InVain(step));
        }
        match (take(&step, &progress), &step) {
            // A mirror may have dropped the versions that old lists name.
            (Err(SetupError::Apt(AptError::Failed { .. })), Step::Install(_))
                if !taken.contains(&Step::FetchLists) =>
            {
                take(&Step::FetchLists, &progress)?;
                taken.push(Step::FetchLists);
                take(&step, &progress)?;
            }
            (result, _) => result?,
        }
        taken.push(step);
    }
}

/// Announces a step and takes it.
fn take(step: &Step, progress: &impl Fn(&str)) -> Result<(), SetupError> {
    match step {
        Step::AddTarget(target) => {
            progress(&step.to_string());
            add_target(step, *target)
        }
        Step::FetchLists => {
            progress(&step.to_string());
            Ok(Apt::default().update()?)
        }
        Step::Install(packages) => {
            let names: Vec<_> = packages.iter().map(|package| package.name()).collect();
            Ok(Apt::default().install(&names, progress, person_agrees)?)
        }
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
    let apt = Apt::default();
    let root = nix::unistd::geteuid().is_root();
    if !root {
        return Err(AptError::Unrunnable(io::ErrorKind::PermissionDenied.into()));
    }
    let install = || apt.install(packages, &progress, person_agrees);
    match install() {
        Err(AptError::Failed { .. }) => {
            apt.update()?;
            install()
        }
        result => result,
    }
}
