//! The shunts' amplifiers, the converters that sample them, bus voltage and temperature (RM0440, chapters of
//! the OPAMP and of the ADC).
//!
//! | converter | at TIM1's update | between the updates |
//! |---|---|---|
//! | ADC1 | phase U, by OPAMP1 | the temperature of the board |
//! | ADC2 | phase V, by OPAMP2 | the voltage of the supply |
//!
//! Phases U and V are sampled at the same instant; the current of W makes the sum zero.

use embassy_stm32::pac;
use embassy_stm32::pac::adc::Adc;
use embassy_stm32::pac::adc::vals::{Exten, SampleTime};
use embassy_stm32::pac::adccommon::vals::Ckmode;
use embassy_stm32::pac::opamp::vals::{PgaGain, VmSel, VpSel};
use embassy_stm32::peripherals;
use embassy_stm32::rcc;

/// TIM1's trigger output among the injected triggers of ADC1 and ADC2 (RM0440, table of their external
/// triggers).
const TIM1_TRGO: u8 = 0;

/// A converter, with its channels at the update and between the updates.
struct Converter {
    registers: Adc,
    current: u8,
    slow: u8,
}

/// OPAMP1's output PA2 and the thermistor at PB14.
const FIRST: Converter = Converter { registers: pac::ADC1, current: 3, slow: 5 };
/// OPAMP2's output PA6 and the divider of the supply at PA0.
const SECOND: Converter = Converter { registers: pac::ADC2, current: 3, slow: 1 };

/// Sets up amplifiers and converters. From TIM1's first update on the converters sample, and ADC1's interrupt
/// comes after both have finished.
pub fn prepare() {
    for amplifier in [pac::OPAMP1, pac::OPAMP2, pac::OPAMP3] {
        amplifier.csr().write(|w| {
            w.set_vp_sel(VpSel::VINP0);
            w.set_vm_sel(VmSel::PGA);
            // The foot of the gain's resistors is at the pin of the inverting input, which the board connects
            // to the shunt's ground (schematic of MB1419, from memory): the gain is 16, and what lifts a
            // current of zero to 2.057 V is at the non-inverting input.
            w.set_pga_gain(PgaGain::GAIN16_INPUT_VINM0);
            w.set_opahsm(true);
        });
        amplifier.csr().modify(|w| w.set_opampen(true));
    }
    rcc::enable_and_reset::<peripherals::ADC1>();
    // 42.5 MHz, synchronous with the core and TIM1; the maximum is 60 MHz (DS12589).
    pac::ADC12_COMMON.ccr().write(|w| w.set_ckmode(Ckmode::SYNC_DIV4));
    FIRST.prepare();
    SECOND.prepare();
    FIRST.registers.ier().write(|w| w.set_jeosie(true));
}

impl Converter {
    fn prepare(&self) {
        let adc = self.registers;
        adc.cr().write(|_| {});
        adc.cr().write(|w| w.set_advregen(true));
        // The regulator's start-up, 20 us (DS12589).
        cortex_m::asm::delay(20 * 170);
        adc.cr().modify(|w| w.set_adcal(true));
        while adc.cr().read().adcal() {}
        // Four clocks of the converter between calibration and ADEN (RM0440, ADEN).
        cortex_m::asm::delay(4 * 4);
        adc.isr().write(|w| w.set_adrdy(true));
        adc.cr().modify(|w| w.set_aden(true));
        while !adc.isr().read().adrdy() {}
        // With the queue disabled the injected sequence is the last one written.
        adc.cfgr().write(|w| w.set_jqdis(true));
        adc.smpr().write(|w| {
            // 0.15 us: the amplifier drives the converter without a series resistor.
            w.set_smp(self.current.into(), SampleTime::CYCLES6_5);
            w.set_smp(self.slow.into(), SampleTime::CYCLES47_5);
        });
        adc.sqr1().write(|w| w.set_sq(0, self.slow));
        adc.jsqr().write(|w| {
            w.set_jextsel(TIM1_TRGO);
            w.set_jexten(Exten::RISING_EDGE);
            w.set_jsq(0, self.current);
        });
        adc.cr().modify(|w| w.set_jadstart(true));
    }
}

/// Whether the currents of an instant are ready to be read.
#[cfg(feature = "on-target")]
pub fn is_converted() -> bool {
    FIRST.registers.isr().read().jeos()
}

/// The currents of the phases U and V at this instant, in counts of the converters. Acknowledges ADC1's
/// interrupt.
#[inline(always)]
pub fn currents() -> [u16; 2] {
    FIRST.registers.isr().write(|w| w.set_jeos(true));
    [FIRST.registers.jdr(0).read().jdata(), SECOND.registers.jdr(0).read().jdata()]
}

/// Voltage of the supply and temperature, in counts of the converters in the previous period; starts their
/// next conversion.
#[inline(always)]
pub fn bus_and_temperature() -> (u16, u16) {
    let read = (SECOND.registers.dr().read().rdata(), FIRST.registers.dr().read().rdata());
    for converter in [FIRST, SECOND] {
        converter.registers.cr().modify(|w| w.set_adstart(true));
    }
    read
}
