//! Requests of tests and measurements to the [`haptic_servo`] on the emulated board, and the servers there.
//!
//! A host sends a scene to the board as words: to certify it ([`scene_codec`]), to run its servo
//! ([`loop_request`]), or to measure the instructions of its torques ([`bench_request`]) and of sines
//! ([`sines`]). On the board a `server` answers. No program that drives a motor needs any of this.
#![cfg_attr(not(test), no_std)]

pub mod bench_request;
pub mod currents;
pub mod loop_request;
pub mod rotations;
pub mod scene_codec;
pub mod sines;
pub mod tables;

mod transducer_codec;

#[cfg(all(target_os = "none", feature = "emulated"))]
pub mod server;
