//! Prepares this machine to build for the board, or states the steps for the user.
//!
//! The toolchain that built this program is used if it has the target, or if the target may be added. If the
//! machine's owner forbids fetching toolchains (`RUSTUP_AUTO_INSTALL=0`), or there is no rustup, Debian's
//! packages are used: a compiler, and the source of `core` to build for the target.

use std::env;
use std::io;
use std::path::Path;
use std::process::Command;

use super::apt::Apt;
use super::build::{Compiler, Toolchain, Workspace};
use super::output::finished;
use super::package::{Package, by_hand, output};
use super::unpacked::Unpacked;
use super::{BuildError, Target, Version};

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
    const fn needs(self) -> (Target, &'static [Package]) {
        match self {
            Self::Compiler => (Target::BOARD, &[]),
            Self::CompilerAndEmulator => (Target::BOARD, &[Package::EMULATOR]),
            Self::CompilerAndVirtualBoard => (Target::BOARD, &Package::NATIVE),
            Self::CompilerForBrowser => (Target::BROWSER, &[]),
        }
    }
}

/// The reason why programs for the board cannot be built here.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum SetupError {
    #[error(
        "tools to build and run the programs for boards are missing:{}\nnot installed here: {why}",
        by_hand(packages, target)
    )]
    Missing { packages: Vec<Package>, target: &'static str, why: io::Error },
    #[error("{0:?} were installed, but are still not found")]
    InVain(Vec<&'static str>),
    #[error(transparent)]
    Rustup(#[from] io::Error),
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
    let (target, more) = tools.needs();
    let is_there = |package: Package| package.is_there(&unpacked);
    let needs = Needs::of(more, Own::observe(target), is_there);
    let apt = Apt::new(&unpacked, &progress);
    for packages in &needs.packages {
        if let Err(why) = apt.provide(packages) {
            let mut packages = needs.packages.concat();
            packages.retain(|package| !is_there(*package));
            return Err(SetupError::Missing { packages, target: target.name, why });
        }
        if !packages.iter().all(|package| is_there(*package)) {
            return Err(SetupError::InVain(packages.iter().map(|package| package.name).collect()));
        }
    }
    if needs.adds_target {
        progress(&format!("rustup target add {target}"));
        finished(Command::new("rustup").args(["target", "add", target.name]))?;
    }
    Ok(Toolchain::new(needs.compiler, workspace))
}

/// Makes sure that a program is installed beside the project; its package has the same name.
pub fn set_up_tool(name: &str) -> Result<(), String> {
    set_up_package(name, &[name, "--version"])
}

/// Makes sure that a package is installed beside the project: `command` has to succeed. If it fails, root on
/// Debian installs the package, as for the project's other tools.
///
/// # Errors
/// Elsewhere, with the package to install.
pub fn set_up_package(name: &str, command: &[&str]) -> Result<(), String> {
    let is_there = || output(Command::new(command[0]).args(&command[1..])).is_some();
    if is_there() {
        return Ok(());
    }
    let by_hand = format!("install it (Debian: apt install {name})");
    // Installed, never unpacked.
    let unpacked = Unpacked::beside(Path::new(""));
    match Apt::new(&unpacked, &|step| eprintln!("{step}")).install(name) {
        Ok(()) if is_there() => Ok(()),
        Ok(()) => Err(by_hand),
        Err(error) => Err(format!("{error}; {by_hand}")),
    }
}

/// The toolchain that cargo runs here.
#[derive(Clone, Copy, Debug)]
struct Own {
    /// The version of its compiler, if there is one.
    rust: Option<Version>,
    /// Whether it has `core` for the target of the programs.
    has_target: bool,
    /// Whether there is a rustup, to add the target.
    rustup: bool,
    /// Whether the machine's owner forbids fetching toolchains.
    fetching_forbidden: bool,
}

impl Own {
    fn observe(target: Target) -> Self {
        let rustc = || Command::new(env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
        let version = output(rustc().arg("--version"));
        let folder = output(rustc().args(["--print", "target-libdir", "--target", target.name]));
        let forbids = |value| value == "0";
        Self {
            rust: version.and_then(|version| Version::find(&version)),
            has_target: folder.is_some_and(|folder| has_core(Path::new(folder.trim()))),
            rustup: output(Command::new("rustup").arg("--version")).is_some(),
            fetching_forbidden: env::var_os("RUSTUP_AUTO_INSTALL").is_some_and(forbids),
        }
    }
}

/// Whether a folder of libraries holds a compiled `core`.
fn has_core(folder: &Path) -> bool {
    let Ok(entries) = folder.read_dir() else { return false };
    entries.flatten().any(|entry| entry.file_name().to_string_lossy().starts_with("libcore-"))
}

/// The compiler for the board, and its needs.
#[derive(Debug, PartialEq, Eq)]
struct Needs {
    compiler: Compiler,
    /// Whether rustup has to add the target.
    adds_target: bool,
    /// Missing packages, which are installed or unpacked together.
    packages: Vec<Vec<Package>>,
}

impl Needs {
    /// Of tools with these packages besides the compiler's: a pure function of what was observed.
    fn of(more: &[Package], own: Own, is_there: impl Fn(Package) -> bool) -> Self {
        let serves = own.rust.is_some_and(|rust| rust >= Version::RUST);
        let adds_target = serves && !own.has_target && own.rustup && !own.fetching_forbidden;
        let is_own = serves && own.has_target || adds_target;
        let compiler = if is_own { Compiler::Own } else { Compiler::Debian };
        let wanted: [&[Package]; 2] = [if is_own { &[] } else { &Package::COMPILER }, more];
        let missing = wanted.map(|all| all.iter().copied().filter(|one| !is_there(*one)).collect());
        let packages = missing.into_iter().filter(|missing: &Vec<_>| !missing.is_empty()).collect();
        Self { compiler, adds_target, packages }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// rustup's toolchain, without the target.
    const OWN: Own = Own {
        rust: Some(Version::RUST),
        has_target: false,
        rustup: true,
        fetching_forbidden: false,
    };

    fn needs(own: Own, packages: &[Package]) -> Needs {
        Needs::of(&[Package::EMULATOR], own, |package| packages.contains(&package))
    }

    #[test]
    fn rustup_adds_the_target_where_it_may() {
        let expected = Needs { compiler: Compiler::Own, adds_target: true, packages: Vec::new() };
        assert_eq!(needs(OWN, &[Package::EMULATOR]), expected);
        // Also beside Debian's packages, which would be a second compiler.
        let all = [&Package::COMPILER[..], &[Package::EMULATOR]].concat();
        assert_eq!(needs(OWN, &all), expected);
    }

    #[test]
    fn rustup_fetches_nothing_where_it_is_forbidden_or_not_there() {
        // It would fetch another toolchain.
        let old = Own { rust: Some(Version { major: 1, minor: 85 }), has_target: true, ..OWN };
        let none = Own { rust: None, rustup: false, ..OWN };
        let forbidden = Own { fetching_forbidden: true, ..OWN };
        let (compiler, adds_target) = (Compiler::Debian, false);
        let [rustc, cargo, source, lld] = Package::COMPILER;
        for own in [forbidden, Own { rustup: false, ..OWN }, old, none] {
            let expected = |packages| Needs { compiler, adds_target, packages };
            let all = vec![Package::COMPILER.to_vec(), vec![Package::EMULATOR]];
            assert_eq!(needs(own, &all.concat()), expected(Vec::new()));
            assert_eq!(needs(own, &[]), expected(all));
            let some = needs(own, &[rustc, cargo, Package::EMULATOR]);
            assert_eq!(some, expected(vec![vec![source, lld]]));
        }
    }

    #[test]
    fn a_toolchain_with_the_target_serves_wherever_it_is_from() {
        let own = Own { has_target: true, rustup: false, fetching_forbidden: true, ..OWN };
        let packages = vec![vec![Package::EMULATOR]];
        let expected = Needs { compiler: Compiler::Own, adds_target: false, packages };
        assert_eq!(needs(own, &[]), expected);
        // A virtual board needs no emulator.
        let (_, native) = Tools::CompilerAndVirtualBoard.needs();
        let [cmake, .., libclang] = Package::NATIVE;
        let missing = Needs::of(native, own, |package| package != cmake && package != libclang);
        assert_eq!(missing.packages, [[cmake, libclang]]);
    }
}
