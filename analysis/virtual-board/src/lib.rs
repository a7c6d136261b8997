//! A board that is a simulation down to the registers, with a program that does not know it.
//!
//! What `haptic flash` would write to an STM32G474RE, an STM32G431CB or an STM32F405RG runs here
//! unmodified: the drivers set clocks up and wait for them, the pacing timer interrupts, the encoder's
//! counter is turned by a simulated device, and the converter's output drives that device.
//!
//! - [`machine`]: the board with its power on.
//! - [`board`]: the units, and the world that is wired to them.
//! - [`chip`]: the chips: where what is, and which pins it uses.
//! - [`peripheral`], [`core`]: the units, and what the core has besides its instructions.
//! - [`device`]: what is wired to the board.
//! - [`meter`]: instructions of a tick.
//! - [`processor`]: the instructions, which a library executes; `hooks`: what it asks meanwhile.
//! - [`trouble`]: why a board cannot go on.
//! - [`semihosting`]: a debugger that answers a program's calls.
//!
//! Time is counted in instructions, each of which takes one clock of the core; so it is the right
//! order of everything that is shown here, and nothing is said of its duration on a chip.

pub mod board;
pub mod chip;
mod conditional;
pub mod core;
pub mod device;
mod frame;
mod hooks;
pub mod image;
pub mod machine;
pub mod meter;
mod names;
pub mod peripheral;
pub mod processor;
mod rtt;
pub mod semihosting;
pub mod trouble;
