//! The torque output of a program: the DAC with an external amplifier, or, with the feature `bridge`, the
//! board's own bridge.
//!
//! Each of the two has the same names for the rest of the board: [`Output`] and its [`Setup`], the [`Pace`]
//! of the servo's interrupt, [`power_reading`] for the host, and [`off`] and [`stop`] for a program that
//! ends.

#[cfg(not(feature = "bridge"))]
mod analog;
#[cfg(feature = "bridge")]
pub mod bridge;
pub mod dac;
#[cfg(feature = "bridge")]
pub mod gates;
mod periods;
pub mod pin;
#[cfg(not(feature = "bridge"))]
mod tick_timer;

#[cfg(not(feature = "bridge"))]
pub use analog::{Output, Setup, off, power_reading, stop};
#[cfg(feature = "bridge")]
pub use bridge::{Output, Pace, Setup, off, power_reading, stop};
#[cfg(not(feature = "bridge"))]
pub use tick_timer::TickTimer as Pace;
