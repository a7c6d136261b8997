//! The pins of a bridge's gates.

use embassy_stm32::pac;
use embassy_stm32::pac::gpio::vals::{Moder, Ospeedr};

/// A gate: its pin, and the alternate function that connects it to a timer.
#[derive(Clone, Copy)]
pub struct Gate {
    port: pac::gpio::Gpio,
    pin: usize,
    function: u8,
}

/// The high side and the low side of each phase, U, V and W.
#[derive(Clone, Copy)]
pub struct Gates(pub [[Gate; 2]; 3]);

impl Gate {
    /// A gate at a pin.
    pub const fn new(port: pac::gpio::Gpio, pin: usize, function: u8) -> Self {
        Self { port, pin, function }
    }

    /// Whether the pin is low, regardless of its driver.
    #[cfg(feature = "on-target")]
    pub fn is_low(&self) -> bool {
        self.port.idr().read().idr(self.pin) == pac::gpio::vals::Idr::LOW
    }

    /// Makes the pin an output with this level, instead of the timer's.
    #[cfg(feature = "on-target")]
    pub fn drive(&self, is_high: bool) {
        self.port.bsrr().write(|w| match is_high {
            true => w.set_bs(self.pin, true),
            false => w.set_br(self.pin, true),
        });
        self.port.moder().modify(|w| w.set_moder(self.pin, Moder::OUTPUT));
    }

    /// Connects the pin to the timer. Before, it was a low output.
    fn connect(self) {
        self.port.afr(self.pin / 8).modify(|w| w.set_afr(self.pin % 8, self.function));
        self.port.ospeedr().modify(|w| w.set_ospeedr(self.pin, Ospeedr::MEDIUM_SPEED));
        self.port.moder().modify(|w| w.set_moder(self.pin, Moder::ALTERNATE));
    }
}

impl Gates {
    /// Connects the first phases to the timer, whose main output is off. The pins of an unused phase stay low
    /// outputs.
    pub fn connect(self, phases: usize) {
        for gate in self.0.into_iter().take(phases).flatten() {
            gate.connect();
        }
    }
}
