//! TIM1: the six gates of the bridge and the timing of the current loop (RM0440, advanced-control timers).
//!
//! ```text
//! counter   /\    /\    /\        centre-aligned, up to the reload value and back to zero
//!          /  \  /  \  /  \
//!         /    \/    \/    \
//!         ^     ^     ^           update: duties are taken over, the currents are sampled,
//!                                 the interrupt computes the next duties
//! high side  __    __    __
//!         __|  |__|  |__|  |__    on while the counter is at or above the compare value (PWM mode 2)
//! ```
//!
//! The low sides conduct around each update, where their shunts are sampled. A repetition counter of 1,
//! written before the counter starts, keeps the updates at zero and suppresses those at the top.

use embassy_stm32::pac;
use embassy_stm32::pac::timer::regs::BdtrAdv;
use embassy_stm32::pac::timer::vals::{Bkinp, Bkp, Cms, FilterValue, Mms, Ocm, Ossi, Ossr, Urs};
use embassy_stm32::peripherals;
use embassy_stm32::rcc;

use crate::board::stm32::wiring::POWER_STAGE;
use crate::current::{CurrentLoop, Duties};

const TIMER: pac::timer::TimAdv = pac::TIM1;

/// The comparators of the three phases, as TIM1_AF1 counts them: COMP1, COMP2 and COMP4.
const COMPARATORS: [usize; 3] = [0, 1, 3];

/// Sets up the timer with all gates off, and does not start it.
pub fn prepare(current_loop: &CurrentLoop) {
    let (reload, phases) = (current_loop.timer_counts(), current_loop.phases());
    rcc::enable_and_reset::<peripherals::TIM1>();
    // Only the comparators and a core lock-up cause a break, and no pin. Set before the break is enabled,
    // because after reset its source is the pin.
    TIMER.af1().write(|w| {
        w.set_bkine(false);
        for comparator in COMPARATORS {
            w.set_bkcmpe(comparator, true);
            w.set_bkcmpp(comparator, Bkinp::NOT_INVERTED);
        }
    });
    pac::SYSCFG.cfgr2().modify(|w| w.set_cll(true));
    // While a debugger halts the core the counter stops, and the outputs are off as without the main output
    // (RM0440, advanced-control timers, debug mode): a breakpoint leaves no duty on the bridge.
    pac::DBGMCU.apb2fzr().modify(|w| w.set_tim1(true));
    // With the main output off, each gate that the timer drives is low.
    off();
    TIMER.cr1().write(|w| {
        w.set_cms(Cms::CENTER_ALIGNED1);
        // The update generated below is not one of the counter.
        w.set_urs(Urs::COUNTER_ONLY);
    });
    TIMER.cr2().write(|w| w.set_mms(Mms::UPDATE));
    TIMER.psc().write_value(0);
    TIMER.arr().write(|w| w.set_arr(reload));
    TIMER.rcr().write(|w| w.set_rep(1));
    for phase in 0..phases {
        TIMER.ccmr_output(phase / 2).modify(|w| {
            w.set_ocm(phase % 2, Ocm::PWM_MODE2);
            w.set_ocpe(phase % 2, true);
        });
    }
    low_sides_only(current_loop);
    TIMER.ccer().write(|w| {
        for phase in 0..phases {
            w.set_cce(phase, true);
            w.set_ccne(phase, true);
        }
    });
    TIMER.egr().write(|w| w.set_ug(true));
    TIMER.sr().write(|w| w.0 = 0);
}

/// Has channel 4, which has no output, make a request of the DMA so many counts before each update: on the way down, as
/// centre-aligned mode 1 has it. Call it before the start.
#[cfg(feature = "magnetic")]
pub fn request_before_update(counts: u16) {
    TIMER.ccr(3).write(|w| w.set_ccr(counts));
    TIMER.dier().write(|w| w.set_ccde(3, true));
}

/// Starts the counter.
pub fn start() {
    TIMER.cr1().modify(|w| w.set_cen(true));
}

/// TIM1_BDTR with the gates on or off. Each write sets the whole register, so that no bit can be lost between
/// a read and a write.
#[inline(always)]
fn gates(on: bool) -> BdtrAdv {
    let mut register = BdtrAdv(0);
    register.set_dtg(POWER_STAGE.dead_time_counts());
    register.set_ossi(Ossi::IDLE_LEVEL);
    register.set_ossr(Ossr::IDLE_LEVEL);
    register.set_bke(0, true);
    register.set_bkp(0, Bkp::ACTIVE_HIGH);
    register.set_bkf(0, FilterValue::FCK_INT_N8);
    register.set_moe(on);
    register
}

/// Enables the timer's outputs to the gates, from the next switching instant on. A past break is cleared; an
/// active break turns the gates off again at once.
pub fn on() {
    TIMER.sr().write(|w| {
        w.0 = u32::MAX;
        w.set_bif(0, false);
    });
    TIMER.bdtr().write_value(gates(true));
}

/// Sets all gates low at once: one write, which only needs the timer's clock.
#[inline(always)]
pub fn off() {
    TIMER.bdtr().write_value(gates(false));
}

/// Whether a comparator has turned the gates off.
#[inline(always)]
pub fn broke() -> bool {
    TIMER.sr().read().bif(0)
}

/// Acknowledges the update of this instant.
#[inline(always)]
pub fn acknowledge() {
    TIMER.sr().write(|w| {
        w.0 = u32::MAX;
        w.set_uif(false);
    });
}

/// Whether another update has come since the last [`acknowledge`].
#[inline(always)]
pub fn updated() -> bool {
    TIMER.sr().read().uif()
}

/// Sets the duties from the next update on.
#[inline(always)]
pub fn set(current_loop: &CurrentLoop, duties: Duties) {
    for (phase, duty) in duties.0.into_iter().enumerate() {
        TIMER.ccr(phase).write(|w| w.set_ccr(current_loop.timer_counts().wrapping_sub(duty)));
    }
}

/// Has only the low sides conduct from the next update on: a compare value above the reload value is never
/// reached.
pub fn low_sides_only(current_loop: &CurrentLoop) {
    for phase in 0..current_loop.phases() {
        TIMER.ccr(phase).write(|w| w.set_ccr(u16::MAX));
    }
}
