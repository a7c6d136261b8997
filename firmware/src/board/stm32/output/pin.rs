//! An output pin that is switched by one register access.

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
