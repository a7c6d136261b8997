//! The over-current protection in hardware: a comparator at each shunt breaks TIM1's outputs (RM0440, chapter
//! of the comparators).

use embassy_stm32::pac;
use embassy_stm32::pac::comp::vals::{Inm, Polarity};
use embassy_stm32::pac::dac::vals::Mode;
use embassy_stm32::peripherals;
use embassy_stm32::rcc;

use crate::current::{CurrentLoop, PowerStage, TripCodes};

/// COMP1 at PA1, COMP2 at PA7 and COMP4 at PB0, with the channel of DAC3 at the inverting input of each:
/// COMP1 and COMP3 have the first, COMP2 and COMP4 the second (RM0440, table of the inverting inputs).
const COMPARATORS: [pac::comp::Comp; 3] = [pac::COMP1, pac::COMP2, pac::COMP4];

/// Sets up the comparators. Until [`set`] they trip at the end of their thresholds' range, which no current
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
    search(PowerStage::LARGEST_COUNT);
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

/// Sets all thresholds to a code, to find where the comparators trip.
pub fn search(threshold: u16) {
    write(0, threshold);
    write(1, threshold);
}

/// Whether the comparators of the phases U, V and W are tripped.
pub fn tripped() -> [bool; 3] {
    COMPARATORS.map(|comparator| comparator.csr().read().value())
}

/// Sets the thresholds above the codes at which the comparators trip without a current. The comparators of the
/// phases V and W have one threshold, so that of them which trips at a lower code trips at more current: by up
/// to 12 mV of offset, 7 A.
pub fn set(current_loop: &CurrentLoop, [u, v, w]: TripCodes) {
    write(0, current_loop.trip_threshold([u, u]));
    write(1, current_loop.trip_threshold([v, w]));
}

fn write(channel: usize, threshold: u16) {
    pac::DAC3.dhr12r(channel).write(|w| w.set_dhr(threshold));
}
