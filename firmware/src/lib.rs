//! Haptic servo for one axis whose scenes are certified passive.
//!
//! A scene is a constant of numbers in SI units: the device, the timing, the virtual coupling, the environment.
//! Its certificate is a proof, computed in `const fn`, that no passive hand can make the rendering oscillate. A
//! scene without a certificate does not compile:
//!
//! ```
//! use haptic_servo::certificate::Certified;
//! use haptic_servo::environment::Wall;
//! use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
//!
//! const SPRING: Certified<Scene> = Scene {
//!     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
//!     timing: Timing { period: 0.001, worst_period: None },
//!     coupling: Coupling::Spring { stiffness: 44.0 },
//!     environment: Wall::spring(22.0, 1).alone(), // with 220.0 this does not compile
//!     latency: Latency::NONE,
//!     torque_limit: None,
//! }
//! .certified();
//!
//! assert!(SPRING.assessment().alpha_coupled.unwrap().hi() < 0.0111); // K T / 2
//! ```
//!
//! # How much of it to use
//!
//! | what | begin with |
//! |---|---|
//! | the certificate alone, for a control loop of your own | [`certificate`], `examples/verify_only.rs` |
//! | the servo, from a count to a code, also on the host | [`servo::Servo`], `examples/servo_on_host.rs` |
//! | the interrupt, on a board of your own | [`servo_loop::Hardware`], [`boot::Startup`] |
//! | the same with the host's link | `wire`, with the feature of that name |
//! | an environment of your own | [`environment::StatedEnvironment`] |
//! | a board of this package | [`scene_program!`], with the board's feature; `memory.x` for the linker |
//!
//! The modules are in the order of the data's path: counts come in at [`encoder`], leave at [`dac`];
//! [`passivity`] and [`certificate`] certify it; [`scene`] and [`servo`] are the data and the loop.
//!
//! # Features
//!
//! No feature is on by default. The features of boards are for the bare-metal target `thumbv7em-none-eabihf`,
//! and a program has exactly one of them.
//! | feature | purpose |
//! |---|---|
//! | `wire` | parameters and telemetry over a serial line: messages, frames, the board's end |
//! | `fixed-point` | programs compute in their scene's fixed-point format instead of `f32` |
//! | `nucleo-g474re` | board: NUCLEO-G474RE, with an external current amplifier |
//! | `b-g431b-esc1` | board: B-G431B-ESC1 |
//! | `feather-stm32f405` | board: Adafruit Feather STM32F405 Express |
//! | `bridge` | the board's own bridge drives the motor: B-G431B-ESC1 |
//! | `magnetic` | a magnetic absolute encoder on SPI: NUCLEO-G474RE |
//! | `board-qemu` | the emulated board |
//! | `log` | measurements and their log, on the emulated board |
//! | `on-target` | tests that run on a board |
//! | `stm32`, `fast-memory` | parts of the boards' features; of no use alone |
//! # Stability
//!
//! Versions follow semantic versioning. Before 1.0 a minor version may break the interface, and a patch does
//! not. A certificate may become less conservative in any version. If a certificate turns out to be wrong, a
//! patch refuses scenes that were accepted before. Exempt are the texts of errors and reports, items hidden
//! from this documentation, and everything in [`board`] except [`scene_program!`] and [`sweep_program!`]. The
//! messages of `wire` have their own version, which board and host compare.
//!
//! The minimum supported Rust version is 1.95. A minor version may raise it.
//!
//! # Where to read on
//!
//! `THEORY.md` in the package has definitions and proofs: "theory, section 4" and "equation 17" refer to it,
//! and "the paper" is its source. `PROTOCOL.md` describes the wire, `boards.md` the boards,
//! `TROUBLESHOOTING.md` the faults. In the repository, `firmware/own-board` is a board of another crate,
//! `firmware/own-environment` an environment.
#![cfg_attr(not(test), no_std)]
#![deny(unsafe_code)]
// A rejection contains all its numbers, and there is no heap for them.
#![allow(clippy::result_large_err)]

/// The value of a result, or a return with its error: `?` in a `const fn`.
macro_rules! ok {
    ($result:expr) => {
        match $result {
            Ok(value) => value,
            Err(error) => return Err(error),
        }
    };
}

/// The value of an option, or a return with `None`: `?` in a `const fn`.
macro_rules! some {
    ($option:expr) => {
        match $option {
            Some(value) => value,
            None => return None,
        }
    };
}

/// The value of an option, or another value: `unwrap_or` in a `const fn`.
macro_rules! or {
    ($option:expr, $otherwise:expr) => {
        match $option {
            Some(value) => value,
            None => $otherwise,
        }
    };
}

/// A loop over a range of numbers: `for` in a `const fn`.
macro_rules! each {
    ($number:ident in $from:tt..=$to:expr => $body:block) => {
        each!($number in $from..$to + 1 => $body)
    };
    ($number:ident in $from:tt..$to:expr => $body:block) => {{
        let (mut next, end) = ($from, $to);
        while next < end {
            let $number = next;
            next += 1;
            $body
        }
    }};
}

pub mod encoder;
pub mod encoder_reading;
pub mod magnetic;

pub mod coupling;
pub mod coupling_memory;
pub mod environment;

pub mod energy;
pub mod torque;

pub mod dac;
pub mod power_reading;

// The current of a motor on a board's own power stage.
pub mod current;

// Numbers of sensor and motor, for a servo.
pub mod transducers;

// Measurement of a device, before certification.
pub mod excitation;

// A torque from a host beside the scene.
pub mod host;

// The servo on a board: one interrupt per period, from reset to fault.
pub mod boot;
pub mod fault;
pub mod rendering;
pub mod reset;
pub mod servo_loop;
pub mod tuning;

pub mod certificate;
pub mod passivity;
pub mod scene;
pub mod scene_type;
pub mod servo;

// Shared by the modules above.
pub mod build_error;
pub mod latency;
pub mod matched;
pub mod number;
pub mod output_timing;
pub mod parameter;
pub mod period;
mod response_window;
pub mod step;
pub mod text;
pub mod time_range;

// The protocol between a board and its host.
#[cfg(feature = "wire")]
pub mod wire;

pub mod board;

#[cfg(test)]
mod test_scene;

/// The package's page, so that its example is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

/// Crates that the macros use, for programs of crates without further dependencies.
#[cfg(all(target_os = "none", any(feature = "board-qemu", feature = "stm32")))]
#[doc(hidden)]
pub mod __private {
    pub use cortex_m_rt;
    #[cfg(feature = "stm32")]
    pub use embassy_executor::{self, task};
    pub use static_cell;
}
