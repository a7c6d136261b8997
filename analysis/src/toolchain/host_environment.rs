//! The host's environment: its compiler, its emulator, its packages.

use super::Version;

/// Tools that were found on the host.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostEnvironment {
    /// The compiler that `cargo` runs here.
    pub rust: Option<Rust>,
    /// Whether there is a rustup, to add a target.
    pub rustup: bool,
    /// Whether the machine's owner forbids fetching toolchains.
    pub fetching_forbidden: bool,
    /// Version of the emulator.
    pub qemu: Option<Version>,
    /// The tools that build the virtual board's processor.
    pub native: NativeBuildTools,
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
    /// Whether it has `core` for the target of the programs.
    pub has_target: bool,
}

/// Tools that build a library in C and read its header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NativeBuildTools {
    /// Whether there is cmake.
    pub cmake: bool,
    /// Whether there is make.
    pub make: bool,
    /// Whether there is a C++ compiler, which cmake requires.
    pub cxx: bool,
    /// Whether there is pkg-config, without which the library's own configuration fails.
    pub pkg_config: bool,
    /// Whether there is libclang.
    pub libclang: bool,
}

/// Debian's packages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Debian {
    /// Whether the lists of packages have just been fetched, so that missing packages are not available.
    pub lists_are_fresh: bool,
    /// The state of each package of [`Package::ALL`], in that order.
    pub packages: [PackageState; Package::ALL.len()],
}

impl Debian {
    pub(super) fn state(&self, package: Package) -> PackageState {
        let index = Package::ALL.iter().position(|p| *p == package);
        index.map_or(PackageState::Unknown, |index| self.packages[index])
    }
}

/// The state of a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PackageState {
    /// It is installed, or unpacked for this workspace.
    Present(Version),
    /// It could be installed.
    Available(Version),
    /// It could be installed, but another package would be removed.
    Conflicting(Version),
    /// The lists do not contain it.
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
    /// Runs the output of cmake.
    Make,
    /// The compiler that cmake requires.
    Cxx,
    /// Finds libraries for the library's own configuration.
    PkgConfig,
    /// Reads its header.
    Libclang,
}

impl Package {
    /// All packages.
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
    /// The packages of a compiler for the target.
    pub(super) const COMPILER: [Self; 4] = [Self::Rustc, Self::Cargo, Self::RustSource, Self::Lld];

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

    /// Its oldest sufficient version.
    const fn oldest(self) -> Option<Version> {
        match self {
            Self::Rustc | Self::Cargo | Self::RustSource => Some(Version::RUST),
            Self::Qemu => Some(Version::QEMU),
            Self::Lld | Self::Cmake | Self::Make | Self::Cxx | Self::PkgConfig | Self::Libclang => {
                None
            }
        }
    }

    /// Whether its programs run from a folder in which they are unpacked. The tools that build the virtual
    /// board's processor look for their parts where they are installed.
    pub(super) const fn runs_unpacked(self) -> bool {
        match self {
            Self::Rustc | Self::Cargo | Self::RustSource | Self::Lld | Self::Qemu => true,
            Self::Cmake | Self::Make | Self::Cxx | Self::PkgConfig | Self::Libclang => false,
        }
    }

    pub(super) fn is_served_by(self, version: Version) -> bool {
        self.oldest().is_none_or(|oldest| version >= oldest)
    }
}
