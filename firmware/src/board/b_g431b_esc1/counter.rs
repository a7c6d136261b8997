//! The wiring with an incremental encoder at A+ and B+ of J8, and the serial port at the board's debug probe.

use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::peripherals::USART2;
use embassy_stm32::timer::qei::Qei;
use embassy_stm32::usart::BufferedInterruptHandler;
use embassy_stm32::{Peripherals, bind_interrupts};

#[cfg(feature = "bridge")]
use crate::board::stm32::output::bridge::encoder::quadrature::IndexPin;
use crate::board::stm32::quadrature;
use crate::board::stm32::serial::{self, Serial};

/// The encoder's index: TIM4_CH3 on PB8, which is the pad Z+ of J8 (alternate function by DS12589). The board
/// pulls it up like A+ and B+.
#[cfg(feature = "bridge")]
pub const INDEX: IndexPin = IndexPin { port: embassy_stm32::pac::GPIOB, pin: 8, function: 2 };

bind_interrupts!(struct Interrupts {
    USART2 => BufferedInterruptHandler<USART2>;
});

/// Connects the amplifier, which is off, the encoder, and the port to the host.
pub(super) fn connect(chip: Peripherals) -> Serial {
    core::mem::forget((
        Output::new(chip.PA15, Level::Low, Speed::Low),
        Qei::new(chip.TIM4, chip.PB6, chip.PB7, quadrature::config()),
    ));
    // The board uses PA4 to sense the back-EMF of its phase 1, so there is no pad: the wire to the amplifier is
    // soldered to the pin's side of that divider, and nothing is connected to the board's motor output 1. Channel
    // 2's pin PA5 is in the middle of a current sense amplifier.
    #[cfg(not(feature = "bridge"))]
    crate::board::stm32::output::dac::connect(chip.DAC1, chip.PA4);
    // The virtual serial port of the board's debug probe; without the probe, the pads TX and RX of J3.
    serial::open(chip.USART2, chip.PB4, chip.PB3, Interrupts)
}
