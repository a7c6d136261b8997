//! The over-current protection, which needs no program: a comparator at each shunt breaks TIM1's outputs
//! (RM0440, chapter of the comparators).

use embassy_stm32::pac;
use embassy_stm32::pac::comp::vals::{Inm, Polarity};
use embassy_stm32::pac::dac::vals::Mode;
use embassy_stm32::peripherals;
use embassy_stm32::rcc;

use crate::board::stm32::wiring::POWER_STAGE;
use crate::current::PowerStage;

/// Gain of the shunts' amplifiers, whose inputs the comparators are at.
const AMPLIFIER_GAIN: u16 = 16;

/// COMP1 at PA1, COMP2 at PA7 and COMP4 at PB0, with the channel of DAC3 that each compares with: COMP1 and
/// COMP3 have the first, COMP2 and COMP4 the second (RM0440, table of the inverting inputs).
const COMPARATORS: [pac::comp::Comp; 3] = [pac::COMP1, pac::COMP2, pac::COMP4];

/// How much above the current at which the current interrupt takes the gates away the comparators do: what
/// is sampled in the middle of the low side has the ripple's mean, and a comparator sees its peak.
const ABOVE: (u16, u16) = (6, 5);

/// Sets the comparators up, for an over-current of this many counts of the converters.
pub fn prepare(counts: u16) {
    rcc::enable_and_reset::<peripherals::DAC3>();
    let dac = pac::DAC3;
    dac.mcr().write(|w| {
        // The interface's range of bus clocks, above 160 MHz.
        w.set_hfsel(0b10);
        for channel in 0..2 {
            w.set_mode(channel, Mode::NORMAL_INT_BUFDIS);
        }
    });
    // The shunts' voltages are those behind their amplifiers, by the gain. Rounded down: never later than
    // it says.
    let counts = POWER_STAGE.no_current() + counts / ABOVE.1 * ABOVE.0;
    let threshold = counts.min(PowerStage::LARGEST_COUNT) / AMPLIFIER_GAIN;
    for channel in 0..2 {
        dac.dhr12r(channel).write(|w| w.set_dhr(threshold));
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
