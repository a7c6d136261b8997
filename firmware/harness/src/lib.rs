//! What tests and measurements ask of the [`firmware`] on the emulated board, and what answers there.
//!
//! A host puts a scene to the board as words: to have it judged ([`question`]), to have its servo run
//! ([`play`]), or to have its torques and their instructions ([`trial`]; other sines than the sweep's,
//! [`sines`], too). On the board a `server` answers. No program that drives a motor needs any of this.
#![cfg_attr(not(test), no_std)]

pub mod play;
pub mod question;
pub mod sines;
pub mod trial;

mod words;

#[cfg(all(target_os = "none", feature = "emulated"))]
pub mod server;
