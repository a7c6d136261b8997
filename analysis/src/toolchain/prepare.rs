//! Prepares this machine to build for the board, or states the steps for the user.
//!
//! The toolchain that built this program is used if it has the target, or if the target may be added. If the
//! machine's owner forbids fetching toolchains (`RUSTUP_AUTO_INSTALL=0`), or there is no rustup, Debian's
//! packages are used: a compiler, and the source of `core` to build for the target.

use std::env;
use std::fs::DirEntry;
use std::path::Path;
use std::process::Command;

use super::build::{Compiler, Toolchain, Workspace};
use super::output::finished;
use super::packages::{COMPILER, EMULATOR, NATIVE, Package, install};
use super::{BuildError, Target};

/// The purpose of the set-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tools {
    /// To build programs for a board.
    Compiler,
    /// To build them and to run them on the emulated board.
    CompilerAndEmulator,
    /// To build them and to run them on a virtual board, which is built here, too.
    CompilerAndVirtualBoard,
    /// To build what a page runs in a browser.
    CompilerForBrowser,
}

impl Tools {
    /// The target of the programs, and the packages in addition to the compiler's.
    const fn needs(self) -> (Target, &'static [Package<'static>]) {
        match self {
            Self::Compiler => (Target::BOARD, &[]),
            Self::CompilerAndEmulator => (Target::BOARD, &[EMULATOR]),
            Self::CompilerAndVirtualBoard => (Target::BOARD, &NATIVE),
            Self::CompilerForBrowser => (Target::BROWSER, &[]),
        }
    }
}

/// The reason why programs for the board cannot be built here.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum SetupError {
    #[error(
        "tools to build for {target} are missing: a Rust toolchain with this target (rustup target add \
         {target}), or Debian's: apt-get install --no-install-recommends {}",
        packages.join(" ")
    )]
    Compiler { packages: Vec<&'static str>, target: &'static str },
    #[error(
        "tools to run programs for boards are missing: apt-get install --no-install-recommends {} \
         (Debian), or the same tools of your system",
        .0.join(" ")
    )]
    Missing(Vec<&'static str>),
    #[error("{0}")]
    Rustup(String),
    #[error(transparent)]
    Workspace(#[from] BuildError),
}

/// Ensures that programs for the board can be built and, if requested, run; returns the toolchain.
///
/// As root on Debian it installs missing packages, and prints them before that; no package is ever removed.
/// With rustup it adds the target, unless the machine's owner forbids it.
///
/// # Errors
/// Otherwise, the error states exactly what to install.
pub fn prepare(tools: Tools) -> Result<Toolchain, SetupError> {
    let workspace = Workspace::find()?;
    // Two programs that install at the same time would disturb each other.
    let _lock = workspace.lock("setup")?;
    let (target, more) = tools.needs();
    let compiler = if has_core(target) {
        Compiler::Own
    } else if may_add_target() {
        eprintln!("set-up: rustup target add {target}");
        let mut rustup = Command::new("rustup");
        finished(rustup.args(["target", "add", target.name])).map_err(SetupError::Rustup)?;
        Compiler::Own
    } else {
        let missing = |packages| SetupError::Compiler { packages, target: target.name };
        install(&COMPILER, workspace.packages()).map_err(missing)?;
        Compiler::Debian
    };
    install(more, workspace.packages()).map_err(SetupError::Missing)?;
    Ok(Toolchain::new(compiler, workspace))
}

/// Makes sure that a program is installed beside the project; its package has the same name.
///
/// # Errors
/// With the package to install.
pub fn set_up_tool(name: &str) -> Result<(), String> {
    set_up_package(name, &format!("{name} --version"))
}

/// Makes sure that a package is installed beside the project: a command of the shell then succeeds.
///
/// # Errors
/// With the package to install.
pub fn set_up_package(name: &str, check: &str) -> Result<(), String> {
    let folder = Workspace::find().map_err(|error| error.to_string())?.packages();
    let missing = |_| format!("install it (Debian: apt install {name})");
    install(&[(name, check)], folder).map_err(missing)
}

/// Whether the toolchain that cargo runs here has a compiled `core` for the target.
fn has_core(target: Target) -> bool {
    let mut rustc = Command::new(env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    let folder = finished(rustc.args(["--print", "target-libdir", "--target", target.name]));
    let entries = folder.ok().and_then(|folder| Path::new(folder.trim()).read_dir().ok());
    let is_core = |entry: DirEntry| entry.file_name().to_string_lossy().starts_with("libcore-");
    entries.is_some_and(|entries| entries.flatten().any(is_core))
}

/// Whether there is a rustup to add a target, and the machine's owner does not forbid fetching.
fn may_add_target() -> bool {
    let forbidden = env::var_os("RUSTUP_AUTO_INSTALL").is_some_and(|value| value == "0");
    !forbidden && finished(Command::new("rustup").arg("--version")).is_ok()
}
