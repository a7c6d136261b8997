//! The packages that programs for boards may need.

use super::{Target, Version};

/// A package.
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

/// The commands that install packages, and the systems that have them.
const SYSTEMS: [(&str, &str); 4] = [
    ("Debian, Ubuntu", "sudo apt-get install --no-install-recommends"),
    ("Fedora", "sudo dnf install"),
    ("Arch", "sudo pacman -S"),
    ("macOS", "brew install"),
];

impl Package {
    /// A compiler for the target, where rustup does not provide it.
    pub const COMPILER: [Self; 4] = [Self::Rustc, Self::Cargo, Self::RustSource, Self::Lld];
    /// The tools that build the virtual board's processor. They look for their parts where they are
    /// installed, so they do not run from another folder.
    pub const NATIVE: [Self; 5] =
        [Self::Cmake, Self::Make, Self::Cxx, Self::PkgConfig, Self::Libclang];

    /// Its name.
    pub const fn name(self) -> &'static str {
        self.names()[0]
    }

    /// Its names on each of the systems; empty where the system has it, or rustup.
    const fn names(self) -> [&'static str; 4] {
        match self {
            Self::Rustc => ["rustc-web", "", "", ""],
            Self::Cargo => ["cargo-web", "", "", ""],
            Self::RustSource => ["rust-web-src", "", "", ""],
            Self::Lld => ["lld", "", "", ""],
            Self::Qemu => ["qemu-system-arm", "qemu-system-arm-core", "qemu-system-arm", "qemu"],
            Self::Cmake => ["cmake"; 4],
            Self::Make => ["make", "make", "make", ""],
            Self::Cxx => ["g++", "gcc-c++", "gcc", ""],
            Self::PkgConfig => ["pkg-config", "pkgconf", "pkgconf", "pkgconf"],
            Self::Libclang => ["libclang-dev", "clang-devel", "clang", "llvm"],
        }
    }

    /// Its oldest sufficient version.
    pub const fn oldest(self) -> Option<Version> {
        match self {
            Self::Rustc | Self::Cargo | Self::RustSource => Some(Version::RUST),
            Self::Qemu => Some(Version::QEMU),
            _ => None,
        }
    }

    pub(super) fn is_served_by(self, version: Version) -> bool {
        self.oldest().is_none_or(|oldest| version >= oldest)
    }
}

/// How a user gets packages, or what serves in their place, on each system.
pub fn by_hand(packages: &[Package], target: Target) -> String {
    let (compiler, others): (Vec<_>, Vec<Package>) =
        packages.iter().copied().partition(|package| Package::COMPILER.contains(package));
    let mut text = String::new();
    if !compiler.is_empty() {
        let oldest = Version::RUST;
        text += &format!(
            "\n- Rust {oldest} or later with the target {target}: from https://rustup.rs, rustup \
             update stable, then rustup target add {target}"
        );
    }
    if others.is_empty() {
        return text;
    }
    let tool = |package: &Package| match package.oldest() {
        Some(oldest) => format!("{} {oldest} or later", package.name()),
        None => package.name().to_owned(),
    };
    text += &format!("\n- {}:", others.iter().map(tool).collect::<Vec<_>>().join(", "));
    for (index, (system, command)) in SYSTEMS.into_iter().enumerate() {
        let names = others.iter().map(|package| package.names()[index]);
        let names: Vec<_> = names.filter(|name| !name.is_empty()).collect();
        text += &format!("\n  {command} {} ({system})", names.join(" "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_name_tools_versions_and_commands() {
        let packages = [Package::Rustc, Package::Lld, Package::Qemu, Package::Cxx];
        let expected = "
- Rust 1.95 or later with the target wasm32-unknown-unknown: from https://rustup.rs, rustup update stable, \
                        then rustup target add wasm32-unknown-unknown
- qemu-system-arm 7.2 or later, g++:
  sudo apt-get install --no-install-recommends qemu-system-arm g++ (Debian, Ubuntu)
  sudo dnf install qemu-system-arm-core gcc-c++ (Fedora)
  sudo pacman -S qemu-system-arm gcc (Arch)
  brew install qemu (macOS)";
        assert_eq!(by_hand(&packages, Target::Browser), expected);
    }
}
