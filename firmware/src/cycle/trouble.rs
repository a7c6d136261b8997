//! What stops the servo, found in a tick. Kept out of line, like all that is rare.

use super::*;
use crate::environment::MAX_DELAY;
use crate::fault::Retained;

/// Ticks in a row without trouble before the servo may be armed.
const CALM: u32 = MAX_DELAY as u32 + 2;

/// What a tick may find besides its numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Whole periods since the last tick.
    pub passed: u32,
    /// Counts that the encoder moved.
    pub step: i32,
    /// Whether the torque was not a number.
    pub not_a_number: bool,
    /// Whether the converter wanted a code before there was one.
    pub underrun: bool,
}

/// Updates that were missed in a row.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Behind {
    updates: u32,
    /// The last tick that began late.
    began: u32,
    /// The last tick that ended late.
    ended: u32,
}

impl Behind {
    /// Tick number `tick` began `missed` periods late.
    fn begin(&mut self, tick: u32, missed: u32) -> u32 {
        let last = tick.wrapping_sub(missed).wrapping_sub(1);
        let before = if self.ended == last { self.updates } else { 0 };
        self.updates = before.saturating_add(missed);
        self.began = tick;
        self.updates
    }

    /// Tick number `tick` ended after the update that it was for.
    fn end(&mut self, tick: u32) -> u32 {
        let goes_on = self.began == tick || self.ended == tick.wrapping_sub(1);
        let before = if goes_on { self.updates } else { 0 };
        self.updates = before.saturating_add(1);
        self.ended = tick;
        self.updates
    }
}

impl<E: Renderable<N>, N: Number, M: OutputMode> Cycle<E, N, M> {
    /// A tick that came late, or moved too far, or whose torque or converter is in trouble.
    #[cold]
    #[inline(never)]
    pub(super) fn examine(
        &mut self,
        found: Found,
        hardware: &mut impl Hardware,
        inbox: &mut Inbox<'_, Rendering<E, N, M>>,
    ) {
        let Found { passed, step, .. } = found;
        if passed != 1 {
            self.energy.missed::<M>(step);
            let missed = passed.saturating_sub(1);
            self.missed = self.missed.wrapping_add(missed);
            let missed = self.behind.begin(self.tick, missed);
            self.unless_tolerated(missed, hardware, inbox);
        }
        let largest = self.rendering.pace().largest_step.saturating_mul(passed);
        let counts = step.unsigned_abs();
        if counts > largest {
            self.fail(Fault::EncoderJump { counts, largest }, hardware, inbox);
        }
        if found.not_a_number {
            self.fail(Fault::NotANumber, hardware, inbox);
        }
        if found.underrun {
            self.fail(Fault::Underrun, hardware, inbox);
        }
    }

    /// Less slack than ever, or none: then the code was late for the update that it was for.
    #[cold]
    #[inline(never)]
    pub(super) fn short(
        &mut self,
        slack: u32,
        hardware: &mut impl Hardware,
        inbox: &mut Inbox<'_, Rendering<E, N, M>>,
    ) {
        self.worst_slack = slack;
        if slack == 0 {
            self.missed = self.missed.wrapping_add(1);
            let missed = self.behind.end(self.tick);
            self.unless_tolerated(missed, hardware, inbox);
        }
    }

    fn unless_tolerated(
        &mut self,
        missed: u32,
        hardware: &mut impl Hardware,
        inbox: &mut Inbox<'_, Rendering<E, N, M>>,
    ) {
        let tolerated = self.rendering.pace().tolerated;
        if missed > tolerated {
            self.fail(Fault::MissedTick { missed, tolerated }, hardware, inbox);
        }
    }

    /// The host has just been silent for too long.
    #[cold]
    #[inline(never)]
    pub(super) fn lose_link(&mut self) {
        let lost = Fault::LinkLost { silent: self.link_timeout, allowed: self.link_timeout };
        if self.link == LinkPolicy::Release && self.state.is_armed() {
            self.begin_fading_out(Goal::Stop(lost));
        }
    }

    /// Notes trouble; where there is torque, it stops the servo.
    fn fail(
        &mut self,
        fault: Fault,
        hardware: &mut impl Hardware,
        inbox: &mut Inbox<'_, Rendering<E, N, M>>,
    ) {
        self.trouble = Some(fault);
        self.calm = 0;
        if self.state.is_armed() {
            self.stop(fault, hardware, inbox);
        }
    }

    /// Torque to zero and amplifier off, now, and a record of it.
    pub(super) fn stop(
        &mut self,
        fault: Fault,
        hardware: &mut impl Hardware,
        inbox: &mut Inbox<'_, Rendering<E, N, M>>,
    ) {
        hardware.write(DacCode::MID_SCALE);
        hardware.amplifier(false);
        self.rendering.servo_mut().shut();
        self.state = State::Faulted;
        self.fault = Some(fault);
        let count = self.rendering.servo().low_count();
        hardware.keep(&Retained { fault, tick: self.tick, count }.encode());
        inbox.tell(Notice::Stopped(fault));
    }

    /// What would stop the servo again at once.
    pub(super) fn persists(&self, silent: u32) -> Option<Fault> {
        let allowed = self.link_timeout;
        if self.link == LinkPolicy::Release && silent >= allowed {
            return Some(Fault::LinkLost { silent, allowed });
        }
        self.trouble.filter(|_| self.calm < CALM)
    }
}
