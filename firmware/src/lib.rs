//! Haptic servo firmware for one axis whose scenes are certified passive.
//!
//! The modules are in the order of the data's path: counts come in at [`encoder`], leave at
//! [`dac`]; [`passivity`] and [`certificate`] judge what runs; [`scene`] and [`servo`] carry it.
//!
//! "Theory, section 4" and "equation 17" are those of `THEORY.md` beside this folder, "the paper" the
//! one that it names.
#![cfg_attr(not(test), no_std)]
#![deny(unsafe_code)]
// A rejection carries all its numbers, and there is no heap to put them on.
#![allow(clippy::result_large_err)]

pub mod encoder;

pub mod coupling;
pub mod environment;

pub mod energy;
pub mod torque;

pub mod dac;
pub mod power_reading;
pub mod torque_output;

// The current of a motor on a board's own power stage.
pub mod current;

// Numbers of sensor and motor, for a servo.
pub mod transducers;

// Measurement of a device, before certification.
pub mod excitation;

// What carries the servo on a board: one interrupt a period, from reset to fault.
pub mod boot;
pub mod fault;
pub mod reset;
pub mod servo_loop;
pub mod tuning;

pub mod certificate;
pub mod passivity;
pub mod scene;
pub mod servo;

// Shared by the modules above.
pub mod build_error;
pub mod latency;
pub mod matched;
pub mod number;
pub mod output_timing;
pub mod parameter;
pub mod period;
pub mod step;
pub mod text;

// The protocol between a board and its host.
#[cfg(feature = "wire")]
pub mod wire;

pub mod board;

/// What a program's macros name besides this crate, for programs of crates that depend on nothing else.
#[cfg(all(target_os = "none", any(feature = "board-qemu", feature = "stm32")))]
#[doc(hidden)]
pub mod __private {
    pub use cortex_m_rt;
    #[cfg(feature = "stm32")]
    pub use embassy_executor::{self, task};
    pub use static_cell;
}
