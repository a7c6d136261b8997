//! The targets of programs other than this machine.

use std::fmt;

/// The target of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Its name for the compiler.
    pub name: &'static str,
    /// The libraries of Rust that are built with a program if the compiler has none for the target.
    pub(super) libraries: [&'static str; 2],
    /// The variable of the compiler's flags, and their value if these libraries are also built.
    pub(super) flags: Option<(&'static str, &'static str)>,
    /// The variable with the linker for cargo, and its value for Debian's toolchain.
    pub(super) linker: (&'static str, &'static str),
}

impl Target {
    /// The boards: Cortex-M4 with its single-precision unit.
    pub const BOARD: Self = Self {
        name: "thumbv7em-none-eabihf",
        libraries: ["-Zbuild-std=core", "-Zbuild-std-features=compiler-builtins-mem"],
        flags: None,
        linker: ("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", "ld.lld"),
    };
    /// A page in a browser: WebAssembly. A page needs no text for a panic.
    pub const BROWSER: Self = Self {
        name: "wasm32-unknown-unknown",
        libraries: ["-Zbuild-std=std,panic_abort", "-Zbuild-std-features=optimize_for_size"],
        flags: Some((
            "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS",
            "-Zunstable-options -Cpanic=immediate-abort -Zlocation-detail=none",
        )),
        linker: ("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", "wasm-ld"),
    };
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name)
    }
}
