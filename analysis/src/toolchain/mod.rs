//! How programs for the board are built: the one place that knows.
//!
//! [`prepare`] looks at the machine ([`observe`]), chooses a route ([`plan`], a pure function), takes
//! it, and gives a [`Toolchain`]; everything else asks that.

mod apt;
mod board;
mod build;
pub mod host_environment;
mod memory;
pub mod observe;
mod output;
pub mod plan;
mod prepare;
pub mod probe;
mod size;
mod sources;
mod target;
mod version;

pub use apt::AptError;
pub use board::{BoardModel, TorqueOutput, UnknownBoard};
pub use build::{BuildError, NumberFormat, Program, Toolchain, build_haptic_with};
pub use memory::Memory;
pub use plan::Tools;
pub use prepare::{SetupError, install, prepare};
pub use size::Sizes;
pub use sources::{Sources, SourcesError};
pub use target::Target;
pub use version::Version;

/// The target that the boards' programs are built for: Cortex-M4 with its single-precision unit.
pub const TARGET: &str = "thumbv7em-none-eabihf";
