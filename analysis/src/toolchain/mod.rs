//! Builds programs for the board; no other module knows how.
//!
//! [`prepare()`] provides the tools that the machine lacks, and returns a [`Toolchain`], which everything
//! else uses.

mod board;
mod build;
mod memory;
mod output;
mod packages;
mod prepare;
pub mod probe;
pub mod python;
mod size;
mod sources;
mod target;

pub use board::{BoardModel, TorqueOutput, UnknownBoard};
pub use build::{BuildError, NumberFormat, Program, Toolchain, build_haptic_with, target_folder};
pub use memory::Memory;
pub use packages::{QEMU, emulator};
pub use prepare::{SetupError, Tools, prepare, set_up_tool};
pub use size::Sizes;
pub use sources::{OtherDevice, Sources, SourcesError};
pub use target::Target;
