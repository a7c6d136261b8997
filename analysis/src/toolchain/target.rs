//! The targets of programs other than this machine.

use std::fmt;

/// The target of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The boards: Cortex-M4 with its single-precision unit.
    Board,
    /// A page in a browser: WebAssembly.
    Browser,
}

impl Target {
    /// Its name for the compiler.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Board => super::TARGET,
            Self::Browser => "wasm32-unknown-unknown",
        }
    }

    /// The libraries of Rust that are built with a program if the compiler has none for the target.
    pub(super) const fn libraries(self) -> [&'static str; 2] {
        match self {
            Self::Board => ["-Zbuild-std=core", "-Zbuild-std-features=compiler-builtins-mem"],
            Self::Browser => {
                ["-Zbuild-std=std,panic_abort", "-Zbuild-std-features=optimize_for_size"]
            }
        }
    }

    /// The variable of the compiler's flags, and their value if these libraries are also built: a page needs
    /// no text for a panic.
    pub(super) const fn flags(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Board => None,
            Self::Browser => Some((
                "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS",
                "-Zunstable-options -Cpanic=immediate-abort -Zlocation-detail=none",
            )),
        }
    }

    /// The variable with the linker for cargo, and its value for Debian's toolchain.
    pub(super) const fn linker(self) -> (&'static str, &'static str) {
        match self {
            Self::Board => ("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", "ld.lld"),
            Self::Browser => ("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", "wasm-ld"),
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
