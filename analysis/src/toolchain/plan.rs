//! Which compiler builds for the board, and what has to be done first: a pure function of what was
//! seen on the machine.
//!
//! The toolchain that built this program serves where it has the target, or may have it added.
//! Where the machine's owner has said that toolchains are not to be fetched
//! (`RUSTUP_AUTO_INSTALL=0`), or there is no rustup, Debian's packages serve: a compiler, and the
//! source of `core` to build for the target.

use std::fmt;

use super::{TARGET, Version, apt};
use crate::emulator::QEMU;

/// What is wanted of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tools {
    /// To build programs for a board.
    Compiler,
    /// To build them and to run them on the emulated board.
    CompilerAndEmulator,
    /// To build them and to run them on a virtual board, which is built here, too.
    CompilerAndVirtualBoard,
}

/// What was seen on the machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// The compiler that `cargo` runs here.
    pub rust: Option<Rust>,
    /// Whether there is a rustup to add a target with.
    pub rustup: bool,
    /// Whether the machine's owner forbids toolchains to be fetched.
    pub fetching_forbidden: bool,
    /// Version of the emulator.
    pub qemu: Option<Version>,
    /// Whether there is what the virtual board's processor is built with.
    pub native: Native,
    /// The packages, on a system that has Debian's.
    pub debian: Option<Debian>,
    /// Whether packages may be installed.
    pub root: bool,
}

/// A compiler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rust {
    /// Its version.
    pub version: Version,
    /// Whether it has `core` for the target.
    pub has_target: bool,
}

/// What builds a library in C, and reads its header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Native {
    /// Whether there is cmake.
    pub cmake: bool,
    /// Whether there is make.
    pub make: bool,
    /// Whether there is a C++ compiler, which cmake asks for.
    pub cxx: bool,
    /// Whether there is pkg-config, without which the library's own configuration fails.
    pub pkg_config: bool,
    /// Whether there is libclang.
    pub libclang: bool,
}

/// Debian's packages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Debian {
    /// Whether the lists of packages have just been fetched, so that what they lack is not to be
    /// had.
    pub lists_are_fresh: bool,
    /// Of each of [`Package::ALL`], in that order.
    pub packages: [PackageState; Package::ALL.len()],
}

/// What is known of a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PackageState {
    /// It is installed.
    Installed(Version),
    /// It could be installed.
    Available(Version),
    /// The lists do not have it.
    Unknown,
}

/// A package that may be needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Package {
    /// The compiler.
    Rustc,
    /// Cargo of the same version.
    Cargo,
    /// The source of `core`.
    RustSource,
    /// The linker.
    Lld,
    /// The emulator.
    Qemu,
    /// Builds the virtual board's processor.
    Cmake,
    /// Runs what cmake writes.
    Make,
    /// The compiler that cmake asks for.
    Cxx,
    /// Finds libraries for the library's own configuration.
    PkgConfig,
    /// Reads its header.
    Libclang,
}

impl Package {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Rustc,
        Self::Cargo,
        Self::RustSource,
        Self::Lld,
        Self::Qemu,
        Self::Cmake,
        Self::Make,
        Self::Cxx,
        Self::PkgConfig,
        Self::Libclang,
    ];
    /// Those that make a compiler for the target.
    const COMPILER: [Self; 4] = [Self::Rustc, Self::Cargo, Self::RustSource, Self::Lld];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rustc => "rustc-web",
            Self::Cargo => "cargo-web",
            Self::RustSource => "rust-web-src",
            Self::Lld => "lld",
            Self::Qemu => "qemu-system-arm",
            Self::Cmake => "cmake",
            Self::Make => "make",
            Self::Cxx => "g++",
            Self::PkgConfig => "pkg-config",
            Self::Libclang => "libclang-dev",
        }
    }

    /// Its oldest version that serves.
    const fn oldest(self) -> Option<Version> {
        match self {
            Self::Rustc | Self::Cargo | Self::RustSource => Some(Version::RUST),
            Self::Qemu => Some(Version::QEMU),
            Self::Lld | Self::Cmake | Self::Make | Self::Cxx | Self::PkgConfig | Self::Libclang => {
                None
            }
        }
    }

    fn is_served_by(self, version: Version) -> bool {
        self.oldest().is_none_or(|oldest| version >= oldest)
    }
}

/// The compiler that builds for the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compiler {
    /// The one that builds everything else here.
    Own,
    /// Debian's, which builds `core` from source as well.
    Debian,
}

/// What to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Plan {
    /// Nothing: this compiler builds.
    Ready(Compiler),
    /// One step, and then to look again.
    Do(Step),
    /// The person has to install something.
    Ask(Vec<Request>),
}

/// A step that this program may take by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// `rustup target add`.
    AddTarget,
    /// `apt-get update`.
    FetchLists,
    /// `apt-get install`.
    Install(Vec<Package>),
}

/// Something that the person has to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Install packages as root.
    Packages(Vec<Package>),
    /// Get a compiler with the target.
    Compiler {
        /// The compiler that is there.
        found: Option<Version>,
        /// Whether it may be had by rustup.
        rustup: bool,
    },
    /// Get the emulator.
    Emulator {
        /// The one that is there and too old.
        found: Option<Version>,
    },
    /// Get what builds the virtual board's processor.
    Native(Native),
}

/// How one of the two tools is to be had.
enum Need {
    Nothing,
    AddTarget,
    Packages(Vec<Package>),
    Person(Request),
}

/// Chooses the route.
pub fn plan(facts: &Facts, tools: Tools) -> Plan {
    let (compiler, compiler_need) = compiler(facts);
    let emulator = match tools {
        Tools::Compiler | Tools::CompilerAndVirtualBoard => Need::Nothing,
        Tools::CompilerAndEmulator => emulator(facts),
    };
    let native = match tools {
        Tools::Compiler | Tools::CompilerAndEmulator => Need::Nothing,
        Tools::CompilerAndVirtualBoard => native(facts),
    };
    let needs = [compiler_need, emulator, native];
    let requests: Vec<_> = needs.iter().filter_map(Need::request).collect();
    let packages: Vec<_> = needs.iter().flat_map(Need::packages).copied().collect();
    let lists_may_help =
        facts.root && facts.debian.as_ref().is_some_and(|debian| !debian.lists_are_fresh);
    if !requests.is_empty() && lists_may_help {
        return Plan::Do(Step::FetchLists);
    }
    if !requests.is_empty() || (!packages.is_empty() && !facts.root) {
        let packages = (!packages.is_empty()).then_some(Request::Packages(packages));
        return Plan::Ask(packages.into_iter().chain(requests).collect());
    }
    if !packages.is_empty() {
        return Plan::Do(Step::Install(packages));
    }
    if needs.iter().any(|need| matches!(need, Need::AddTarget)) {
        return Plan::Do(Step::AddTarget);
    }
    Plan::Ready(compiler)
}

fn compiler(facts: &Facts) -> (Compiler, Need) {
    let own = facts.rust.filter(|rust| rust.version >= Version::RUST);
    let may_fetch = facts.rustup && !facts.fetching_forbidden;
    match own {
        Some(Rust { has_target: true, .. }) => (Compiler::Own, Need::Nothing),
        Some(_) if may_fetch => (Compiler::Own, Need::AddTarget),
        _ => {
            let found = facts.rust.map(|rust| rust.version);
            let otherwise = Request::Compiler { found, rustup: may_fetch };
            (Compiler::Debian, facts.packages(&Package::COMPILER, otherwise))
        }
    }
}

fn emulator(facts: &Facts) -> Need {
    match facts.qemu {
        Some(version) if version >= Version::QEMU => Need::Nothing,
        found => facts.packages(&[Package::Qemu], Request::Emulator { found }),
    }
}

fn native(facts: &Facts) -> Need {
    let Native { cmake, make, cxx, pkg_config, libclang } = facts.native;
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
        false => facts.packages(&packages, Request::Native(facts.native)),
    }
}

impl Facts {
    /// Packages that serve: those of them that are missing, or the request that stands in for them
    /// where they are not to be had.
    fn packages(&self, wanted: &[Package], otherwise: Request) -> Need {
        let Some(debian) = &self.debian else { return Need::Person(otherwise) };
        let mut missing = Vec::new();
        for package in wanted {
            match debian.state(*package) {
                PackageState::Installed(version) if package.is_served_by(version) => {}
                PackageState::Available(version) if package.is_served_by(version) => {
                    missing.push(*package);
                }
                _ => return Need::Person(otherwise),
            }
        }
        if missing.is_empty() { Need::Nothing } else { Need::Packages(missing) }
    }
}

impl Debian {
    fn state(&self, package: Package) -> PackageState {
        let index = Package::ALL.iter().position(|p| *p == package);
        index.map_or(PackageState::Unknown, |index| self.packages[index])
    }
}

impl Need {
    fn request(&self) -> Option<Request> {
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
            Self::AddTarget => write!(f, "rustup target add {TARGET}"),
            Self::FetchLists => f.write_str("apt-get update"),
            Self::Install(packages) => {
                let names: Vec<_> = packages.iter().map(|package| package.name()).collect();
                f.write_str(&apt::by_hand(&names))
            }
        }
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Packages(packages) => {
                write!(f, "install packages: sudo {}", Step::Install(packages.clone()))
            }
            Self::Compiler { found, rustup } => {
                let oldest = Version::RUST;
                write!(f, "install Rust {oldest} or later with the target {TARGET}: ")?;
                match found {
                    Some(version) if *version < oldest && *rustup => {
                        write!(f, "this is Rust {version}; rustup update stable, then ")?;
                    }
                    Some(version) => write!(f, "this is Rust {version} without it; ")?,
                    None => f.write_str("from https://rustup.rs; ")?,
                }
                write!(f, "{}", Step::AddTarget)
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
            Self::Native(native) => {
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
                    "install {}, with which the virtual board's processor is built: apt install \
                     cmake make g++ pkg-config libclang-dev (Debian, Ubuntu), dnf install cmake make \
                     gcc-c++ pkgconf clang-devel (Fedora), pacman -S cmake make gcc pkgconf clang \
                     (Arch), brew install cmake pkgconf llvm (macOS)",
                    missing.join(" and ")
                )
            }
        }
    }
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
