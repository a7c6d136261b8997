//! The swap of a parameter set while a hand may hold the device: its steps, and how long the torque is
//! away.
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
//!    from the torque           device is; Applied is told   |
//!    that is held                                           SETTLING ticks later the
//!                                                           clamp opens
//! ```
//!
//! The hand feels the torque fall away and come back, each along a ramp of at most a tenth of
//! [`RenderingOptions::fade`]; [`longest_gap`] is the sum.
//!
//! No part of this is safe because of the time that it takes. A limit that moves, however
//! fast, is in the certificate of either set ([`certificate::timed`](crate::certificate::TimingChecked)): one
//! that falls takes energy away, and one that rises puts in, once, what the environment stores at its
//! depth. In between there is no torque, and the new set remembers nothing but a device that stood where
//! it is, which is a motion that it could have seen.
//!
//! So the gap is as short as its edges may be felt. Without a wall a hand that leans on it falls on, and
//! the deeper it is when the clamp opens, the more that puts in: long ramps are the worse ones. But a
//! torque that comes within a tick is a blow. Hence a tenth of the time in which an armed clamp opens,
//! which has no wall to keep up and may take its time: a swap while it opens, or that ends in being
//! disarmed, goes at that speed.

use super::*;
use crate::environment::MAX_DELAY;
use crate::servo::RenderingOptions;

/// Steps of the clamp a tick where it opens after arming, or closes for good.
pub(super) const ARMING: u32 = 1;
/// Steps of the clamp a tick for a swap.
const SWAPPING: u32 = 10;

/// Ticks that a new set runs without torque before its clamp opens. It starts at rest where the device
/// is, whatever it remembers for however long; after these ticks its delay, and the velocity that is
/// delayed with it, are of how the device moves now.
const SETTLING: u32 = MAX_DELAY as u32 + 2;

/// The longest time in s for which a swap keeps a running servo, whose `period` is in s, from giving the
/// torque that its scene asks for.
pub fn longest_gap(options: &RenderingOptions, period: f64) -> f64 {
    let ramp = options.fade / period / f64::from(SWAPPING);
    // A ramp ends with a part of a step, the number format's rounding adds one, and the tick in which
    // it begins and the one in which it is seen to be shut are no part of it. The cast rounds down.
    let ticks = 2 * (ramp as u32).saturating_add(2);
    f64::from(ticks.saturating_add(SETTLING + 2)) * period
}

impl<E: Discretize<N>, N: Number, M: OutputMode> ServoLoop<E, N, M> {
    /// Begins to close the clamp of a running servo, if a set waits.
    pub(super) fn begin_swap(&mut self, inbox: &Inbox<'_, PreparedServo<E, N, M>>) {
        if inbox.has_set() {
            self.ramp = SWAPPING;
            self.begin_fading_out(AfterFade::Render);
        }
    }

    /// Puts the set that waits in the place of the running one, between two ticks and whole. To be
    /// called with the clamp shut: the new set's is, too.
    pub(super) fn swap(&mut self, inbox: &mut Inbox<'_, PreparedServo<E, N, M>>) -> bool {
        let Some(mut set) = inbox.set() else { return false };
        set.servo_mut().take_position_from(self.rendering.servo());
        set.rest_here();
        self.rendering = set;
        inbox.notify(Notice::Applied);
        true
    }

    /// Keeps the clamp shut until the new set has seen how the device moves.
    pub(super) fn begin_settling(&mut self) {
        self.settling = SETTLING;
        self.state = State::Settling;
    }

    /// A tick of that: another set may come meanwhile.
    pub(super) fn settle(&mut self, inbox: &mut Inbox<'_, PreparedServo<E, N, M>>) {
        if self.swap(inbox) {
            self.settling = SETTLING;
        }
        self.settling = self.settling.saturating_sub(1);
        if self.settling == 0 {
            self.state = State::FadingIn;
        }
    }
}
