//! The wiring with the chip of a magnetic encoder at the pads TX, RX and PWM of J3, without the board's resistors R23 and
//! R24, and with the serial port at A+ and B+ of J8. The bridge leaves the amplifier's pad free.

use embassy_stm32::peripherals::USART1;
use embassy_stm32::usart::BufferedInterruptHandler;
use embassy_stm32::{Peripherals, bind_interrupts, pac};

use crate::board::stm32::magnetic::{Bus, BusPin};
use crate::board::stm32::serial::{self, Serial};

/// The bus of a magnetic encoder: SPI3 on the pins of the board's serial port and of the pad PWM (alternate functions
/// by DS12589, requests of the DMA by RM0440's table of the multiplexer). MOSI's pin switches the dividers of the
/// back-EMF, which the bridge does not use.
pub const BUS: Bus = Bus {
    spi: pac::SPI3,
    select: BusPin { port: pac::GPIOA, pin: 15, function: 6 },
    clock: BusPin { port: pac::GPIOB, pin: 3, function: 6 },
    input: BusPin { port: pac::GPIOB, pin: 4, function: 6 },
    output: BusPin { port: pac::GPIOB, pin: 5, function: 6 },
    received: 14,
    wants: 15,
    // TIM1's channel 4.
    begins: 45,
    enable: || pac::RCC.apb1enr1().modify(|w| w.set_spi3en(true)),
    reset: || {
        pac::RCC.apb1rstr1().modify(|w| w.set_spi3rst(true));
        pac::RCC.apb1rstr1().modify(|w| w.set_spi3rst(false));
    },
};

bind_interrupts!(struct Interrupts {
    USART1 => BufferedInterruptHandler<USART1>;
});

/// Connects the port to the host; the encoder's own set-up connects its bus.
pub(super) fn connect(chip: Peripherals) -> Serial {
    serial::open(chip.USART1, chip.PB7, chip.PB6, Interrupts)
}
