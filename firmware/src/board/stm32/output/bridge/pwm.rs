//! TIM1: the six gates of the bridge, and the time of everything in it (RM0440, advanced-control timers).
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
//! The low sides conduct around each update, which is where their shunts are sampled. The repetition counter
//! of 1, written before the counter starts, leaves the updates at zero and takes away those at the top.

use embassy_stm32::pac;
use embassy_stm32::pac::timer::regs::BdtrAdv;
use embassy_stm32::pac::timer::vals::{Bkinp, Bkp, Cms, FilterValue, Mms, Ocm, Ossi, Ossr, Urs};
use embassy_stm32::peripherals;
use embassy_stm32::rcc;

use crate::board::stm32::wiring::POWER_STAGE;
use crate::current::{CurrentLoop, Duties};

/// The timer.
const TIMER: pac::timer::TimAdv = pac::TIM1;

/// The comparators of the three phases, as TIM1_AF1 counts them: COMP1, COMP2 and COMP4.
const COMPARATORS: [usize; 3] = [0, 1, 3];

/// Sets the timer up with all gates off, and leaves it standing.
pub fn prepare(current_loop: &CurrentLoop) {
    let (reload, phases) = (current_loop.timer_counts(), current_loop.phases());
    rcc::enable_and_reset::<peripherals::TIM1>();
    // The comparators alone break, and a core that is locked up; no pin does. Before the break is enabled: out of
    // reset it is the pin's.
    TIMER.af1().write(|w| {
        w.set_bkine(false);
        for comparator in COMPARATORS {
            w.set_bkcmpe(comparator, true);
            w.set_bkcmpp(comparator, Bkinp::NOT_INVERTED);
        }
    });
    pac::SYSCFG.cfgr2().modify(|w| w.set_cll(true));
    // With the main output off, each gate that the timer is given is low.
    off();
    TIMER.cr1().write(|w| {
        w.set_cms(Cms::CENTER_ALIGNED1);
        // The update that is made below is not the counter's.
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
        // At the reload value: the low side alone.
        TIMER.ccr(phase).write(|w| w.set_ccr(reload));
    }
    TIMER.ccer().write(|w| {
        for phase in 0..phases {
            w.set_cce(phase, true);
            w.set_ccne(phase, true);
        }
    });
    TIMER.egr().write(|w| w.set_ug(true));
    TIMER.sr().write(|w| w.0 = 0);
}

/// Starts the counter.
pub fn start() {
    TIMER.cr1().modify(|w| w.set_cen(true));
}

/// TIM1_BDTR with the gates on or off. Each write of it is a whole one, so that none of it can be lost
/// between a read and a write.
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

/// Lets the timer drive the gates, from the next instant at which it switches one. A past break is cleared;
/// an active break turns the gates off again at once.
pub fn on() {
    TIMER.sr().write(|w| {
        w.0 = u32::MAX;
        w.set_bif(0, false);
    });
    TIMER.bdtr().write_value(gates(true));
}

/// All gates low, now: one write, which needs nothing but the timer's clock.
#[inline(always)]
pub fn off() {
    TIMER.bdtr().write_value(gates(false));
}

/// Whether a comparator has taken the gates away.
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

/// Duties for the next update.
#[inline(always)]
pub fn set(current_loop: &CurrentLoop, duties: Duties) {
    for (phase, duty) in duties.0.into_iter().enumerate() {
        TIMER.ccr(phase).write(|w| w.set_ccr(current_loop.timer_counts().wrapping_sub(duty)));
    }
}
