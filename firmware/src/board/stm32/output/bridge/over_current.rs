//! The over-current protection in hardware: a comparator at each shunt breaks TIM1's outputs (RM0440, chapter
//! of the comparators).

use embassy_stm32::pac;
use embassy_stm32::pac::comp::vals::{Inm, Polarity};
use embassy_stm32::pac::dac::vals::Mode;
use embassy_stm32::peripherals;
use embassy_stm32::rcc;

use crate::current::PowerStage;

/// Gain of the shunts' amplifiers; the comparators are at the inputs of the amplifiers.
const AMPLIFIER_GAIN: u16 = 16;

/// COMP1 at PA1, COMP2 at PA7 and COMP4 at PB0, with the channel of DAC3 at the inverting input of each:
/// COMP1 and COMP3 have the first, COMP2 and COMP4 the second (RM0440, table of the inverting inputs).
const COMPARATORS: [pac::comp::Comp; 3] = [pac::COMP1, pac::COMP2, pac::COMP4];

/// Ratio of the comparators' threshold to the current at which the current interrupt turns the gates off: a
/// sample in the middle of the low side's time has the mean of the ripple, and a comparator sees the peak.
const ABOVE: (u16, u16) = (6, 5);

/// The smallest threshold in counts of DAC3, so that noise and switching do not trip as a short circuit.
const LEAST: u16 = 2;

/// Sets up the comparators. Until [`set`] they trip at the amplifiers' largest output, which no amplifier
/// reaches.
pub fn prepare() {
    rcc::enable_and_reset::<peripherals::DAC3>();
    let dac = pac::DAC3;
    dac.mcr().write(|w| {
        // The interface's range of bus clocks, above 160 MHz.
        w.set_hfsel(0b10);
        for channel in 0..2 {
            w.set_mode(channel, Mode::NORMAL_INT_BUFDIS);
        }
    });
    for channel in 0..2 {
        write(channel, PowerStage::LARGEST_COUNT / AMPLIFIER_GAIN);
    }
    dac.cr().write(|w| {
        w.set_en(0, true);
        w.set_en(1, true);
    });
    for comparator in COMPARATORS {
        comparator.csr().write(|w| {
            w.set_inmsel(Inm::DACA);
            w.set_inpsel(false);
            w.set_polarity(Polarity::NOT_INVERTED);
            w.set_en(true);
        });
    }
}

/// Sets the trip level for an over-current of this many counts of the converters, above the counts of the
/// phases U and V without a current: [`ABOVE`] times as many. Phase W, whose amplifier no converter reads,
/// has the level of phase V.
///
/// The shunts' voltages are the amplifiers' outputs divided by the gain. The level is rounded down, but is at
/// least the smallest threshold.
pub fn set(zero: [u16; 2], counts: u16) {
    let above = (counts / ABOVE.1 * ABOVE.0).max(LEAST * AMPLIFIER_GAIN);
    for (channel, zero) in zero.into_iter().enumerate() {
        write(channel, (zero + above).min(PowerStage::LARGEST_COUNT) / AMPLIFIER_GAIN);
    }
}

fn write(channel: usize, threshold: u16) {
    pac::DAC3.dhr12r(channel).write(|w| w.set_dhr(threshold));
}
