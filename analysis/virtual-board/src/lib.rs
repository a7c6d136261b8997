//! A board that is simulated down to the registers and runs an unmodified program.
//!
//! The program that `haptic flash` writes to an STM32G474RE, an STM32G431CB or an STM32F405RG runs here
//! unmodified: the drivers set up clocks and wait for them, the pacing timer interrupts, the encoder's
//! counter is turned by a simulated device, and the DAC's output drives that device.
//!
//! - [`machine`]: the board with its power on.
//! - [`board`]: the units, and the connected device.
//! - [`chip`]: the chips: their memory maps, their kinds of peripherals, and the pins that the boards use.
//! - [`peripheral`], [`core`]: the units, and the core's parts other than its instructions.
//! - [`power_stage`]: TIM1 and the analogue units, with the circuit around them; [`motor`]: its currents.
//! - [`device`]: the device at the board; [`bridge_memory`]: the state of a program in its memory.
//!   [`encoder_index`]: the encoder's third output. [`magnetic_encoder`]: chips on an SPI.
//! - [`meter`]: instructions of a tick.
//! - [`processor`]: the instructions, which a library executes; `hooks`: its callbacks, and the reasons for its
//!   stops.
//! - [`error`]: the reasons why a board cannot boot or continue.
//!
//! Time is counted in instructions, each of which takes one clock of the core. So the order of all events is
//! right, but their duration on a chip is not modelled.

pub mod board;
pub mod bridge_memory;
pub mod chip;
pub mod core;
pub mod device;
pub mod encoder_index;
pub mod error;
mod frame;
mod hooks;
pub mod image;
mod it_block;
mod log;
pub mod machine;
pub mod magnetic_encoder;
pub mod meter;
pub mod motor;
pub mod peripheral;
pub mod power_stage;
pub mod processor;
mod rtt;
