//! Builds programs for the board; no other module knows how.
//!
//! [`prepare`] observes the machine, decides what it needs, provides that, and returns a [`Toolchain`], which
//! everything else uses.

mod apt;
mod board;
mod build;
mod memory;
mod needs;
mod observe;
mod output;
mod package;
mod prepare;
pub mod probe;
pub mod python;
mod size;
mod sources;
mod target;
mod unpacked;
mod version;

pub use apt::AptError;
pub use board::{BoardModel, TorqueOutput, UnknownBoard};
pub use build::{
    BuildError, NumberFormat, Program, Toolchain, build_haptic_with, emulator, target_folder,
};
pub use memory::Memory;
pub use needs::Tools;
pub use prepare::{SetupError, prepare, set_up_package, set_up_tool};
pub use size::Sizes;
pub use sources::{Sources, SourcesError};
pub use target::Target;
pub use unpacked::QEMU;
pub use version::Version;

/// The target of the boards' programs: Cortex-M4 with its single-precision unit.
pub const TARGET: &str = "thumbv7em-none-eabihf";
