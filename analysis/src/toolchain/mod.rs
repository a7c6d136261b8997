//! How programs for the board are built: the one place that knows.
//!
//! [`prepare`] looks at the machine ([`facts`]), chooses a route ([`plan`], a pure function), takes
//! it, and gives a [`Toolchain`]; everything else asks that.

mod build;
pub mod facts;
pub mod plan;
mod prepare;
mod size;
mod version;

pub use build::{BuildError, NumberFormat, Toolchain};
pub use prepare::{SetupError, prepare};
pub use size::Sizes;
pub use version::Version;

/// The target that the boards' programs are built for: Cortex-M4 with its single-precision unit.
pub const TARGET: &str = "thumbv7em-none-eabihf";
