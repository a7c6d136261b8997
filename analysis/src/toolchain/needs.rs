//! The compiler for the board, and the packages that are missing: a pure function of what was observed.
//!
//! The toolchain that built this program is used if it has the target, or if the target may be added. If the
//! machine's owner forbids fetching toolchains (`RUSTUP_AUTO_INSTALL=0`), or there is no rustup, Debian's
//! packages are used: a compiler, and the source of `core` to build for the target.

use super::build::Compiler;
use super::package::Package;
use super::{Target, Version};

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

    /// The packages in addition to the compiler's.
    const fn packages(self) -> &'static [Package] {
        match self {
            Self::Compiler | Self::CompilerForBrowser => &[],
            Self::CompilerAndEmulator => &[Package::Qemu],
            Self::CompilerAndVirtualBoard => &Package::NATIVE,
        }
    }
}

/// The toolchain that cargo runs here.
#[derive(Clone, Copy, Debug)]
pub struct Own {
    /// The version of its compiler, if there is one.
    pub rust: Option<Version>,
    /// Whether it has `core` for the target of the programs.
    pub has_target: bool,
    /// Whether there is a rustup, to add the target.
    pub rustup: bool,
    /// Whether the machine's owner forbids fetching toolchains.
    pub fetching_forbidden: bool,
}

/// The compiler for the board, and its needs.
#[derive(Debug, PartialEq, Eq)]
pub struct Needs {
    /// The compiler.
    pub compiler: Compiler,
    /// Whether rustup has to add the target.
    pub adds_target: bool,
    /// Missing packages, which are installed or unpacked together.
    pub packages: Vec<Vec<Package>>,
}

impl Needs {
    /// Of tools, on a machine with this toolchain and these packages.
    pub fn of(tools: Tools, own: Own, is_there: impl Fn(Package) -> bool) -> Self {
        let serves = own.rust.is_some_and(|rust| rust >= Version::RUST);
        let adds_target = serves && !own.has_target && own.rustup && !own.fetching_forbidden;
        let is_own = serves && own.has_target || adds_target;
        let compiler = if is_own { Compiler::Own } else { Compiler::Debian };
        let wanted: [&[Package]; 2] =
            [if is_own { &[] } else { &Package::COMPILER }, tools.packages()];
        let missing = wanted.map(|all| all.iter().copied().filter(|one| !is_there(*one)).collect());
        let packages = missing.into_iter().filter(|missing: &Vec<_>| !missing.is_empty()).collect();
        Self { compiler, adds_target, packages }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OLD: Version = Version { major: 1, minor: 85 };

    /// rustup's toolchain, without the target.
    const OWN: Own = Own {
        rust: Some(Version::RUST),
        has_target: false,
        rustup: true,
        fetching_forbidden: false,
    };

    fn needs(own: Own, packages: &[Package]) -> Needs {
        Needs::of(Tools::CompilerAndEmulator, own, |package| packages.contains(&package))
    }

    #[test]
    fn rustup_adds_the_target_where_it_may() {
        let (compiler, packages) = (Compiler::Own, Vec::new());
        let expected = Needs { compiler, adds_target: true, packages };
        assert_eq!(needs(OWN, &[Package::Qemu]), expected);
        // Also beside Debian's packages, which would be a second compiler.
        assert_eq!(needs(OWN, &[&Package::COMPILER[..], &[Package::Qemu]].concat()), expected);
    }

    #[test]
    fn rustup_fetches_nothing_where_it_is_forbidden_or_not_there() {
        let old = Own { rust: Some(OLD), has_target: true, ..OWN };
        let none = Own { rust: None, rustup: false, ..OWN };
        let (compiler, adds_target) = (Compiler::Debian, false);
        for own in [
            Own { fetching_forbidden: true, ..OWN },
            Own { rustup: false, ..OWN },
            // It would fetch another toolchain.
            old,
            none,
        ] {
            let packages = vec![Package::COMPILER.to_vec(), vec![Package::Qemu]];
            assert_eq!(needs(own, &[]), Needs { compiler, adds_target, packages });
            let there = [&Package::COMPILER[..], &[Package::Qemu]].concat();
            assert_eq!(needs(own, &there), Needs { compiler, adds_target, packages: Vec::new() });
            let packages = vec![vec![Package::RustSource, Package::Lld]];
            let there = [Package::Rustc, Package::Cargo, Package::Qemu];
            assert_eq!(needs(own, &there), Needs { compiler, adds_target, packages });
        }
    }

    #[test]
    fn a_toolchain_with_the_target_serves_wherever_it_is_from() {
        let own = Own { has_target: true, rustup: false, fetching_forbidden: true, ..OWN };
        let (compiler, adds_target) = (Compiler::Own, false);
        let packages = vec![vec![Package::Qemu]];
        assert_eq!(needs(own, &[]), Needs { compiler, adds_target, packages });
        let nothing = |tools| Needs::of(tools, own, |_| false).packages.is_empty();
        assert!(nothing(Tools::Compiler) && nothing(Tools::CompilerForBrowser));
    }

    #[test]
    fn a_virtual_board_is_built_with_cmake_and_libclang_and_needs_no_emulator() {
        let own = Own { has_target: true, ..OWN };
        let missing = [Package::Cmake, Package::Libclang];
        let needs =
            Needs::of(Tools::CompilerAndVirtualBoard, own, |package| !missing.contains(&package));
        assert_eq!(needs.packages, [missing]);
    }
}
