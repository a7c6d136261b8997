//! Host side of the haptic servo.
//!
//! The modules are in the order in which a question passes through them: a [`file`] says what is
//! asked, [`verdict`] what is answered; [`command`] is the program in front of both.

pub mod batch;
pub mod bench;
pub mod chart;
pub mod command;
pub mod controller;
pub mod device;
pub mod emulator;
pub mod file;
pub mod hand;
pub mod minimum;
pub mod program;
pub mod progress;
pub mod quantity;
pub mod replay;
pub mod response;
pub mod rig;
pub mod scenario;
pub mod toolchain;
pub mod unchecked;
pub mod verdict;
