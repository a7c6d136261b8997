//! The swap of a parameter set while a hand may hold the device: its steps, and the duration of the gap in
//! the torque.
//!
//! ```text
//! torque of the old set                                  torque of the new set
//! ------------.                                                    .------------
//!              \                                                  /
//!               \                                                /
//!                `-----------------------------------------------'
//! state    Running | FadingOut |          Settling          | FadingIn | Running
//!                  ^           ^                            ^          ^
//!    a set waits:  |           shut: swapped between two    |          open: the new
//!    the clamp closes          ticks, at rest where the     |          set is felt
//!    from the torque           device is; then published    |
//!    that is held                                           SETTLING ticks later the
//!                                                           clamp opens
//! ```
//!
//! The hand feels the torque fall away and come back, each along a ramp of at most a tenth of
//! [`RenderingOptions::fade`]; [`longest_gap`] is the sum.
//!
//! No duration here affects safety. The certificate of each set covers a torque limit that changes at any
//! rate ([`certificate::timed`](crate::certificate::TimingChecked)): a falling limit removes energy, and a
//! rising one adds, once, the energy that the environment stores at its depth. In between there is no torque,
//! and the new set starts in the state of a device at rest at this position, which is a possible motion.
//!
//! A long gap is a disadvantage: a hand that pressed on the wall falls further, and a deeper hand gets more
//! energy when the clamp opens. But a torque that rises within a tick is a blow. Therefore the ramp takes a
//! tenth of the time in which the clamp opens after arming, when no hand presses on a wall. A swap during
//! that opening, or before disarming, has the slower speed.

use super::*;
use crate::environment::MAX_DELAY;
use crate::servo::RenderingOptions;

/// Steps of the clamp per tick after arming and before disarming.
pub(super) const ARMING: u32 = 1;
/// Steps of the clamp per tick for a swap.
const SWAPPING: u32 = 10;

/// Ticks that a new set runs without torque before its clamp opens. It starts at rest at the device's
/// position; after these ticks its delay line, and the velocity that is delayed with it, hold the present
/// motion of the device.
pub(super) const SETTLING: u32 = MAX_DELAY as u32 + 2;

/// The longest time in s for which a swap reduces the torque of a running servo. `period` in s.
pub fn longest_gap(options: &RenderingOptions, period: f64) -> f64 {
    let ramp = options.fade / period / f64::from(SWAPPING);
    // A ramp ends with a part of a step, and the number format's rounding adds one step. The ticks in which
    // the ramp begins and in which the clamp is found shut are not part of it. The cast rounds down.
    let ticks = 2 * (ramp as u32).saturating_add(2);
    f64::from(ticks.saturating_add(SETTLING + 2)) * period
}

impl<E: Rendering<N>, N: Number, M: OutputMode> ServoLoop<E, N, M> {
    /// Begins to close the clamp of a running servo if a set is waiting.
    pub(super) fn begin_swap(&mut self, inbox: &Incoming<'_, E, N, M>) {
        if inbox.has_set() {
            self.ramp = SWAPPING;
            self.begin_fading_out(AfterFade::Render);
        }
    }

    /// Replaces the running set by the waiting set, as a whole and between two ticks. The clamps of both sets
    /// are shut.
    pub(super) fn swap(&mut self, inbox: &mut Incoming<'_, E, N, M>) -> bool {
        if self.waits_for_host(inbox) {
            return false;
        }
        let Some(mut set) = inbox.set() else { return false };
        set.servo_mut().take_position_from(self.rendering.servo());
        set.host_mut().take_over(self.rendering.host());
        set.rest_here();
        self.rendering = set;
        inbox.swapped();
        true
    }

    /// Whether a waiting set has to wait until the amplifier has given more of a host's torque.
    pub(super) fn waits_for_host(&self, inbox: &Incoming<'_, E, N, M>) -> bool {
        let may_pass = |set: &PreparedServo<E, N, M>| self.rendering.host().may_pass_to(set.host());
        E::Host::IS_PRESENT && !inbox.waiting_set().is_none_or(may_pass)
    }

    /// Keeps the clamp shut for so many ticks: until a new set has samples of the device's motion, or a torque
    /// output that was switched on is ready.
    pub(super) fn begin_settling(&mut self, ticks: u32) {
        self.settling = ticks;
        self.state = if ticks == 0 { State::FadingIn } else { State::Settling };
    }

    /// A tick of settling; another set may arrive meanwhile.
    pub(super) fn settle(&mut self, inbox: &mut Incoming<'_, E, N, M>) {
        if self.swap(inbox) {
            self.settling = self.settling.max(SETTLING);
        }
        self.settling = self.settling.saturating_sub(1);
        if self.settling == 0 {
            self.state = State::FadingIn;
        }
    }
}
