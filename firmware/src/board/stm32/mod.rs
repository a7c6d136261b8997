//! The common part of the STM32 boards: the registers of a tick, the start from reset to a running servo, and
//! the end after a panic or a fault.
//!
//! The torque outputs are in [`output`].
//!
//! A board's own file ([`wiring`]) has only its pins, clocks, timers and scales.

#[cfg(feature = "fast-memory")]
mod ccm_sram;
#[cfg(any(feature = "nucleo-g474re", feature = "b-g431b-esc1"))]
pub mod clock_170;
#[cfg(feature = "feather-stm32f405")]
mod f4;
#[cfg(any(feature = "nucleo-g474re", feature = "b-g431b-esc1"))]
mod g4;
#[cfg(feature = "magnetic")]
pub mod magnetic;
pub mod output;
pub mod quadrature;
pub mod registers;
mod reset;
pub mod serial;
mod start;
pub(super) mod stop;
mod sweep;

#[cfg(feature = "feather-stm32f405")]
use f4 as family;
#[cfg(any(feature = "nucleo-g474re", feature = "b-g431b-esc1"))]
use g4 as family;

#[cfg(feature = "b-g431b-esc1")]
pub use super::b_g431b_esc1 as wiring;
#[cfg(feature = "feather-stm32f405")]
pub use super::feather_stm32f405 as wiring;
#[cfg(feature = "nucleo-g474re")]
pub use super::nucleo_g474re as wiring;

#[cfg(all(feature = "bridge", not(feature = "b-g431b-esc1")))]
compile_error!("this board has no bridge: --output bridge is for the b-g431b-esc1");

#[cfg(all(
    feature = "magnetic",
    not(any(feature = "nucleo-g474re", all(feature = "b-g431b-esc1", feature = "bridge")))
))]
compile_error!(
    "this board reads no magnetic encoder with this output: a program with one is for the nucleo-g474re and its \
     DAC, or for the b-g431b-esc1 and its bridge"
);

// The logger that carries the bytes to a debug probe; it registers itself.
use defmt_rtt as _;
pub use start::{
    EncoderSetup, HostLink, LinkCell, ServoCell, Statics, Task, init_chip, registers, run, width,
    with_board_counter,
};
pub use sweep::{Setup, SweepCell, measure};
