//! A pin that is switched by one register access.

use embassy_stm32::pac;

/// The level of a pin that means "on".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Active {
    /// 3.3 V is on.
    High,
    /// 0 V is on: for a pin that is pulled up while the chip is in reset.
    Low,
}

/// A pin of a port, for the servo's interrupt and for the panic handler, which have no time for a
/// driver or none left to own it.
#[derive(Clone, Copy)]
pub struct Line {
    /// Its port.
    pub port: pac::gpio::Gpio,
    /// Its number in the port, 0 to 15.
    pub pin: usize,
    /// What level is on.
    pub active: Active,
}

impl Line {
    /// Switches; one write, which interrupts nothing and can be interrupted by anything.
    #[inline(always)]
    pub fn set(self, on: bool) {
        let high = on == matches!(self.active, Active::High);
        self.port
            .bsrr()
            .write(|w| if high { w.set_bs(self.pin, true) } else { w.set_br(self.pin, true) });
    }

    /// The pin's level while the line is off.
    pub const fn off(self) -> embassy_stm32::gpio::Level {
        match self.active {
            Active::High => embassy_stm32::gpio::Level::Low,
            Active::Low => embassy_stm32::gpio::Level::High,
        }
    }
}
