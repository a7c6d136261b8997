//! Prepares this machine to build for the board, or states the steps for the user.

use std::io;
use std::path::Path;
use std::process::Command;

use super::apt::{Apt, AptError};
use super::build::{Toolchain, Workspace};
use super::needs::{Needs, Tools};
use super::output::finished;
use super::package::{Package, by_hand};
use super::unpacked::Unpacked;
use super::{BuildError, Target, observe};

/// The reason why programs for the board cannot be built here.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The user must install packages first.
    #[error(
        "tools to build and run the programs for boards are missing:{}\nnot installed here: {why}",
        by_hand(packages, *target)
    )]
    Missing {
        /// The packages.
        packages: Vec<Package>,
        /// The target of the programs.
        target: Target,
        /// The reason why they were neither installed nor unpacked.
        why: AptError,
    },
    /// Packages were installed without effect.
    #[error("{0:?} were installed, but are still not found")]
    InVain(Vec<&'static str>),
    /// rustup failed.
    #[error(transparent)]
    Rustup(#[from] io::Error),
    /// The workspace cannot be found or written to.
    #[error(transparent)]
    Workspace(#[from] BuildError),
}

/// Ensures that programs for the board can be built and, if requested, run; returns the toolchain.
///
/// As root on Debian it installs missing packages. If that would remove a package, or without root's rights,
/// it unpacks them into a folder of this workspace. With rustup it adds the target, unless the machine's owner
/// forbids it. `progress` receives each step before it is taken. No package is ever removed.
///
/// # Errors
/// Otherwise, [`SetupError::Missing`] states exactly what to install.
pub fn prepare(tools: Tools, progress: impl Fn(&str)) -> Result<Toolchain, SetupError> {
    let workspace = Workspace::find()?;
    // Two programs that install at the same time would disturb each other.
    let _lock = workspace.lock("setup")?;
    let unpacked = workspace.unpacked();
    let target = tools.target();
    let is_there = |package| observe::is_there(package, &unpacked);
    let needs = Needs::of(tools, observe::own(target), is_there);
    let apt = Apt::new(&unpacked, &progress);
    for packages in &needs.packages {
        if let Err(why) = apt.provide(packages) {
            let mut packages = needs.packages.concat();
            packages.retain(|package| !is_there(*package));
            return Err(SetupError::Missing { packages, target, why });
        }
        if !packages.iter().all(|package| is_there(*package)) {
            let names = packages.iter().map(|package| package.name()).collect();
            return Err(SetupError::InVain(names));
        }
    }
    if needs.adds_target {
        progress(&format!("rustup target add {target}"));
        finished(Command::new("rustup").args(["target", "add", target.name()]))?;
    }
    Ok(Toolchain::new(needs.compiler, workspace))
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
    // Installed, never unpacked.
    let unpacked = Unpacked::beside(Path::new(""));
    match Apt::new(&unpacked, &|step| eprintln!("{step}")).install(&[package]) {
        Ok(()) if is_there() => Ok(()),
        Ok(()) => Err(by_hand),
        Err(error) => Err(format!("{error}; {by_hand}")),
    }
}
