//! The torque output of a program: the DAC with an external amplifier, or, with the feature `bridge`, the
//! board's own bridge.
//!
//! Each of the two has the same names for the rest of the board: [`Output`] and its [`Setup`], the [`Pace`]
//! of the servo's interrupt, [`power_reading`] for the host, and [`off`] and [`stop`] for a program that
//! ends.

#[cfg(feature = "bridge")]
pub mod bridge;
#[cfg(not(feature = "bridge"))]
pub mod dac;
#[cfg(feature = "bridge")]
pub mod gates;
mod pace;
#[cfg(not(feature = "bridge"))]
mod tick_timer;

#[cfg(feature = "bridge")]
pub use bridge::encoder::{count, period_began};
#[cfg(feature = "bridge")]
pub use bridge::{Output, Setup, off, power_reading, stop};
#[cfg(not(feature = "bridge"))]
pub use dac::{Output, Setup, off, power_reading, stop};
pub use pace::Pace;

#[cfg(all(feature = "magnetic", not(feature = "bridge")))]
pub use super::magnetic::count;
#[cfg(not(any(feature = "bridge", feature = "magnetic")))]
pub use tick_timer::count;
#[cfg(not(feature = "bridge"))]
pub use tick_timer::period_began;

use embassy_stm32::pac;

/// A pin of a port, for the servo's interrupt, which has no time for a driver, and for the panic handler,
/// which cannot own a driver.
///
/// On every board 3.3 V means on. With a resistor to ground at the amplifier, a broken wire and a board
/// without power mean off.
#[derive(Clone, Copy)]
pub struct OutputPin {
    /// Its port.
    pub port: pac::gpio::Gpio,
    /// Its number in the port, 0 to 15.
    pub pin: usize,
}

impl OutputPin {
    /// Switches the pin with one write, which needs no critical section.
    #[inline(always)]
    pub fn set(self, on: bool) {
        self.port
            .bsrr()
            .write(|w| if on { w.set_bs(self.pin, true) } else { w.set_br(self.pin, true) });
    }
}
