//! Builds programs for the board; no other module knows how.
//!
//! [`prepare()`] observes the machine, decides its needs, provides them, and returns a [`Toolchain`], which
//! everything else uses.

mod apt;
mod board;
mod build;
mod memory;
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

pub use board::{BoardModel, TorqueOutput, UnknownBoard};
pub use build::{
    BuildError, NumberFormat, Program, Toolchain, build_haptic_with, emulator, target_folder,
};
pub use memory::Memory;
pub use prepare::{SetupError, Tools, prepare, set_up_tool};
pub use size::Sizes;
pub use sources::{Sources, SourcesError};
pub use target::Target;
pub use unpacked::QEMU;
pub use version::Version;
