//! The choice of the compiler for the board, and the steps before: a pure function of the machine's observed
//! state.
//!
//! The toolchain that built this program is used if it has the target, or if the target may be added. If the
//! machine's owner forbids fetching toolchains (`RUSTUP_AUTO_INSTALL=0`), or there is no rustup, Debian's
//! packages are used: a compiler, and the source of `core` to build for the target.

use std::fmt;

use super::build::Compiler;
use super::host_environment::{HostEnvironment, NativeBuildTools, Package, PackageState, Rust};
use super::unpacked::QEMU;
use super::{Target, Version, apt};

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
    /// The target of the programs.
    pub const fn target(self) -> Target {
        match self {
            Self::Compiler | Self::CompilerAndEmulator | Self::CompilerAndVirtualBoard => {
                Target::Board
            }
            Self::CompilerForBrowser => Target::Browser,
        }
    }
}

/// The next action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Plan {
    /// None: this compiler is ready.
    Ready(Compiler),
    /// One step, and then observe again.
    Do(Step),
    /// The user must install something.
    Ask(Vec<ManualStep>),
}

/// A step that this program may take by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// `rustup target add`.
    AddTarget(Target),
    /// `apt-get update`.
    FetchLists,
    /// `apt-get install`.
    Install(Vec<Package>),
    /// `apt-get download`, and into a folder of this workspace.
    Unpack(Vec<Package>),
}

/// A step that the user must take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ManualStep {
    /// Install packages as root.
    Packages(Vec<Package>),
    /// Get a compiler with the target.
    Compiler {
        /// The installed compiler.
        found: Option<Version>,
        /// Whether rustup can provide it.
        rustup: bool,
        /// Its target.
        target: Target,
    },
    /// Get the emulator.
    Emulator {
        /// The installed version, which is too old.
        found: Option<Version>,
    },
    /// Get the tools that build the virtual board's processor.
    NativeBuildTools(NativeBuildTools),
}

/// How to get one of the two tools.
enum Need {
    Nothing,
    AddTarget,
    Packages(Vec<Package>),
    Person(ManualStep),
}

/// Makes the plan.
pub fn plan(host: &HostEnvironment, tools: Tools) -> Plan {
    let target = tools.target();
    let (compiler, compiler_need) = compiler(host, target);
    let emulator = match tools {
        Tools::CompilerAndEmulator => emulator(host),
        _ => Need::Nothing,
    };
    let native = match tools {
        Tools::CompilerAndVirtualBoard => native(host),
        _ => Need::Nothing,
    };
    let needs = [compiler_need, emulator, native];
    let mut requests: Vec<_> = needs.iter().filter_map(Need::request).collect();
    let packages: Vec<_> = needs.iter().flat_map(Need::packages).copied().collect();
    let lists_may_help = host.debian.as_ref().is_some_and(|debian| !debian.lists_are_fresh);
    if !requests.is_empty() && lists_may_help {
        return Plan::Do(Step::FetchLists);
    }
    let (installed, others): (Vec<_>, Vec<_>) =
        packages.into_iter().partition(|package| host.may_install(*package));
    let (unpacked, by_hand): (Vec<_>, Vec<_>) =
        others.into_iter().partition(|package| package.runs_unpacked());
    if !by_hand.is_empty() {
        requests.insert(0, ManualStep::Packages(by_hand));
    }
    if !requests.is_empty() {
        return Plan::Ask(requests);
    }
    if !installed.is_empty() {
        return Plan::Do(Step::Install(installed));
    }
    if !unpacked.is_empty() {
        return Plan::Do(Step::Unpack(unpacked));
    }
    if needs.iter().any(|need| matches!(need, Need::AddTarget)) {
        return Plan::Do(Step::AddTarget(target));
    }
    Plan::Ready(compiler)
}

fn compiler(host: &HostEnvironment, target: Target) -> (Compiler, Need) {
    let own = host.rust.filter(|rust| rust.version >= Version::RUST);
    let may_fetch = host.rustup && !host.fetching_forbidden;
    match own {
        Some(Rust { has_target: true, .. }) => (Compiler::Own, Need::Nothing),
        Some(_) if may_fetch => (Compiler::Own, Need::AddTarget),
        _ => {
            let found = host.rust.map(|rust| rust.version);
            let otherwise = ManualStep::Compiler { found, rustup: may_fetch, target };
            (Compiler::Debian, host.packages(&Package::COMPILER, otherwise))
        }
    }
}

fn emulator(host: &HostEnvironment) -> Need {
    match host.qemu {
        Some(version) if version >= Version::QEMU => Need::Nothing,
        found => host.packages(&[Package::Qemu], ManualStep::Emulator { found }),
    }
}

fn native(host: &HostEnvironment) -> Need {
    let NativeBuildTools { cmake, make, cxx, pkg_config, libclang } = host.native;
    let missing = [
        (cmake, Package::Cmake),
        (make, Package::Make),
        (cxx, Package::Cxx),
        (pkg_config, Package::PkgConfig),
        (libclang, Package::Libclang),
    ];
    let packages: Vec<_> =
        missing.into_iter().filter(|(there, _)| !there).map(|(_, package)| package).collect();
    match packages.is_empty() {
        true => Need::Nothing,
        false => host.packages(&packages, ManualStep::NativeBuildTools(host.native)),
    }
}

impl HostEnvironment {
    /// Whether a package may be installed: by root, without removing another package.
    fn may_install(&self, package: Package) -> bool {
        let state = self.debian.as_ref().map(|debian| debian.state(package));
        self.root && !matches!(state, Some(PackageState::Conflicting(_)))
    }

    /// The missing packages of a tool, or a manual step if they are not available.
    fn packages(&self, wanted: &[Package], otherwise: ManualStep) -> Need {
        let Some(debian) = &self.debian else { return Need::Person(otherwise) };
        let mut missing = Vec::new();
        for package in wanted {
            match debian.state(*package) {
                PackageState::Present(version) if package.is_served_by(version) => {}
                PackageState::Available(version) | PackageState::Conflicting(version)
                    if package.is_served_by(version) =>
                {
                    missing.push(*package);
                }
                _ => return Need::Person(otherwise),
            }
        }
        if missing.is_empty() { Need::Nothing } else { Need::Packages(missing) }
    }
}

impl Need {
    fn request(&self) -> Option<ManualStep> {
        match self {
            Self::Person(request) => Some(request.clone()),
            _ => None,
        }
    }

    fn packages(&self) -> &[Package] {
        match self {
            Self::Packages(packages) => packages,
            _ => &[],
        }
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AddTarget(target) => write!(f, "rustup target add {target}"),
            Self::FetchLists => f.write_str("apt-get update"),
            Self::Install(packages) => {
                let names: Vec<_> = packages.iter().map(|package| package.name()).collect();
                f.write_str(&apt::by_hand(&names))
            }
            Self::Unpack(packages) => {
                let names: Vec<_> = packages.iter().map(|package| package.name()).collect();
                write!(f, "apt-get download {}", names.join(" "))
            }
        }
    }
}

impl fmt::Display for ManualStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Packages(packages) => {
                write!(f, "install packages: sudo {}", Step::Install(packages.clone()))
            }
            Self::Compiler { found, rustup, target } => {
                let oldest = Version::RUST;
                write!(f, "install Rust {oldest} or later with the target {target}: ")?;
                match found {
                    Some(version) if *version < oldest && *rustup => {
                        write!(f, "this is Rust {version}; rustup update stable, then ")?;
                    }
                    Some(version) => write!(f, "this is Rust {version} without it; ")?,
                    None => f.write_str("from https://rustup.rs; ")?,
                }
                write!(f, "{}", Step::AddTarget(*target))
            }
            Self::Emulator { found } => {
                let oldest = Version::QEMU;
                match found {
                    Some(found) => write!(f, "replace {QEMU} {found} by {oldest} or later: ")?,
                    None => write!(f, "install {QEMU} {oldest} or later: ")?,
                }
                f.write_str(
                    "apt install qemu-system-arm (Debian, Ubuntu), dnf install \
                     qemu-system-arm-core (Fedora), pacman -S qemu-system-arm (Arch), brew install \
                     qemu (macOS)",
                )
            }
            Self::NativeBuildTools(native) => {
                let tools = [
                    (native.cmake, "cmake"),
                    (native.make, "make"),
                    (native.cxx, "a C++ compiler"),
                    (native.pkg_config, "pkg-config"),
                    (native.libclang, "libclang"),
                ];
                let missing: Vec<_> =
                    tools.iter().filter(|(there, _)| !there).map(|(_, name)| *name).collect();
                write!(
                    f,
                    "install {}, to build the processor of the virtual board: apt install cmake \
                     make g++ pkg-config libclang-dev (Debian, Ubuntu), dnf install cmake make \
                     gcc-c++ pkgconf clang-devel (Fedora), pacman -S cmake make gcc pkgconf clang \
                     (Arch), brew install cmake pkgconf llvm (macOS)",
                    missing.join(" and ")
                )
            }
        }
    }
}

#[cfg(test)]
mod tests;
