//! A pin that is switched by one register access.

use embassy_stm32::pac;

/// A pin of a port, for the servo's interrupt and for the panic handler, which have no time for a
/// driver or none left to own it.
///
/// 3.3 V is on, on every board: with a resistor to ground at its far end, a wire that is broken and
/// a board without power are off.
#[derive(Clone, Copy)]
pub struct OutputPin {
    /// Its port.
    pub port: pac::gpio::Gpio,
    /// Its number in the port, 0 to 15.
    pub pin: usize,
}

impl OutputPin {
    /// Switches; one write, which interrupts nothing and can be interrupted by anything.
    #[inline(always)]
    pub fn set(self, on: bool) {
        self.port
            .bsrr()
            .write(|w| if on { w.set_bs(self.pin, true) } else { w.set_br(self.pin, true) });
    }
}
