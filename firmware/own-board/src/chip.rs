//! Clocks, pins and timers of an STM32F405 with a 12 MHz crystal (RM0090), as on an Adafruit Feather
//! STM32F405 Express, in place of a HAL.
//!
//! | pin | what |
//! |---|---|
//! | PC6, PC7 | encoder, on TIM3 |
//! | PA4 | DAC |
//! | PC3 | amplifier, high is on; it floats during a reset |
//! | PB10, PB11 | serial port to the host, on USART3 |

use core::num::NonZeroU32;

use haptic_servo::board::BAUD;
use haptic_servo::board::input_filter::InputFilter;
use haptic_servo::dac::DacCode;
use stm32_metapac::flash::vals::Latency;
use stm32_metapac::gpio::vals::Moder;
use stm32_metapac::rcc::vals::{Pllm, Plln, Pllp, Pllsrc, Ppre, Sw};
use stm32_metapac::timer::vals::{CcmrInputCcs, FilterValue, Mms, Sms, Urs};
use stm32_metapac::{DAC1, FLASH, GPIOA, GPIOB, GPIOC, RCC, TIM3, TIM5, TIM6, USART3};

use crate::scene::PROGRAM;

/// The timers' clock in Hz.
pub const TIMER_CLOCK: f64 = 84e6;
/// The clock of the slow bus in Hz, which the port divides.
const SLOW_BUS: u32 = 42_000_000;
/// TIM6 has 16 bits, too few for the counts of a thousandth of a second.
const PRESCALER: u32 = 2;

/// The scene's period in counts of TIM5, a whole number of counts of TIM6.
pub const PERIOD: NonZeroU32 = {
    // Rounded down, except for the rounding of the product: not longer than certified.
    let seconds = PROGRAM.scene.timing.period;
    let counts = (seconds * TIMER_CLOCK / PRESCALER as f64 + 1e-6) as u32;
    assert!(counts > 0 && counts <= 0x10000, "TIM6 counts periods of up to 1.56 ms");
    NonZeroU32::new(PRESCALER * counts).unwrap()
};
/// If the encoder's edges can be too fast for this clock, this does not compile.
const FILTER: InputFilter = InputFilter::of_encoder(&PROGRAM.transducers, TIMER_CLOCK);

/// Sets everything up for the start of the servo: the amplifier is off, and the DAC at zero torque.
pub fn init() {
    pins();
    clocks();
    encoder();
    dac();
    serial();
}

/// 168 MHz. If the crystal stops later, the non-maskable interrupt is raised.
fn clocks() {
    RCC.cr().modify(|w| w.set_hseon(true));
    while !RCC.cr().read().hserdy() {}
    RCC.pllcfgr().modify(|w| {
        w.set_pllsrc(Pllsrc::HSE);
        w.set_pllm(Pllm::DIV6);
        w.set_plln(Plln::MUL168);
        w.set_pllp(Pllp::DIV2);
    });
    RCC.cr().modify(|w| w.set_pllon(true));
    RCC.cr().modify(|w| w.set_csson(true));
    while !RCC.cr().read().pllrdy() {}
    FLASH.acr().modify(|w| {
        w.set_latency(Latency::WS5);
        w.set_icen(true);
        w.set_dcen(true);
    });
    RCC.cfgr().modify(|w| {
        w.set_ppre1(Ppre::DIV4);
        w.set_ppre2(Ppre::DIV2);
        w.set_sw(Sw::PLL1_P);
    });
    while RCC.cfgr().read().sws() != Sw::PLL1_P {}
    RCC.apb1enr().modify(|w| {
        w.set_tim3en(true);
        w.set_tim5en(true);
        w.set_tim6en(true);
        w.set_dacen(true);
        w.set_usart3en(true);
    });
}

/// Switches the amplifier off first, and configures each pin.
fn pins() {
    RCC.ahb1enr().modify(|w| {
        w.set_gpioaen(true);
        w.set_gpioben(true);
        w.set_gpiocen(true);
    });
    GPIOC.moder().modify(|w| w.set_moder(3, Moder::OUTPUT));
    for pin in [6, 7] {
        GPIOC.afr(0).modify(|w| w.set_afr(pin, 2));
        GPIOC.moder().modify(|w| w.set_moder(pin, Moder::ALTERNATE));
    }
    for pin in [10, 11] {
        GPIOB.afr(1).modify(|w| w.set_afr(pin - 8, 7));
        GPIOB.moder().modify(|w| w.set_moder(pin, Moder::ALTERNATE));
    }
}

/// The encoder's counter: all four edges of the two channels count.
fn encoder() {
    TIM3.ccmr_input(0).modify(|w| {
        for channel in [0, 1] {
            w.set_ccs(channel, CcmrInputCcs::TI4);
            w.set_icf(channel, FilterValue::from_bits(FILTER.bits()));
        }
    });
    TIM3.smcr().modify(|w| w.set_sms(Sms::ENCODER_MODE_3));
    TIM3.arr().write(|w| w.set_arr(u16::MAX));
    TIM3.ccer().modify(|w| {
        w.set_cce(0, true);
        w.set_cce(1, true);
    });
    TIM3.cr1().modify(|w| w.set_cen(true));
}

/// The DAC drives its pin at zero torque. Its reset code is full torque.
fn dac() {
    DAC1.dhr12r(0).write(|w| w.set_dhr(DacCode::MID_SCALE.get()));
    DAC1.cr().modify(|w| w.set_en(0, true));
    GPIOA.moder().modify(|w| w.set_moder(4, Moder::ANALOG));
}

/// The port, with an interrupt for each received byte.
fn serial() {
    USART3.brr().write(|w| w.set_brr(((SLOW_BUS + BAUD / 2) / BAUD) as u16));
    USART3.cr1().write(|w| {
        w.set_ue(true);
        w.set_te(true);
        w.set_re(true);
        w.set_rxneie(true);
    });
}

/// Starts TIM6, which starts an interrupt and latches the DAC once per period, and the clock TIM5.
pub fn start() {
    TIM5.arr().write_value(u32::MAX);
    TIM6.psc().write_value((PRESCALER - 1) as u16);
    TIM6.arr().write(|w| w.set_arr((PERIOD.get() / PRESCALER - 1) as u16));
    TIM6.cr2().write(|w| w.set_mms(Mms::UPDATE));
    // Prescaler and period take effect at an update; this update must not cause a tick.
    TIM6.cr1().write(|w| w.set_urs(Urs::COUNTER_ONLY));
    TIM6.egr().write(|w| w.set_ug(true));
    TIM6.dier().write(|w| w.set_uie(true));
    DAC1.cr().modify(|w| {
        // TIM6 among the triggers.
        w.set_tsel(0, 0);
        w.set_ten(0, true);
    });
    TIM5.cr1().modify(|w| w.set_cen(true));
    TIM6.cr1().modify(|w| w.set_cen(true));
}
