//! One current and its model: feed-forward and feedback (theory, sections 15.1 and 15.2).

use super::current_loop::Law;

/// A current that follows its model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower {
    /// The model's current in A at this instant, and at the next one, for which voltages have been given.
    model: f32,
    next: f32,
    /// The part of the feedback that stays.
    held: f32,
}

/// What a current needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Voltage in V: that of the motor's motion is left to the feedback (theory, section 15.8).
    pub volts: f32,
    /// The model's current less the measured one, in A.
    pub deviation: f32,
}

impl Follower {
    /// No current and no voltage.
    pub(super) const AT_REST: Self = Self { model: 0.0, next: 0.0, held: 0.0 };

    /// The model goes on by an instant, whatever voltages there are: it is the certified model. The voltage
    /// brings it there, and the current to it.
    #[inline(always)]
    pub(super) const fn follow(&mut self, law: &Law, reference: f32, current: f32) -> Wanted {
        let deviation = self.model - current;
        let after_next = self.next + law.model_gain * (reference - self.next);
        let forward = (after_next - law.decay * self.next) * law.volts;
        let feedback = law.proportional * deviation + (self.held + law.integral * deviation);
        (self.model, self.next) = (self.next, after_next);
        Wanted { volts: forward + feedback, deviation }
    }

    /// What the voltage across the model's current has to be for each rad that the current turns from an instant
    /// to the middle of the next voltage, after [`follow`](Self::follow).
    #[inline(always)]
    pub(super) const fn volts_across(&self, law: &Law) -> f32 {
        (self.next + law.decay * self.model) * law.volts
    }

    /// Twice the model's mean current while the voltage acts, after [`follow`](Self::follow). It has no noise, so
    /// that its sign does not flicker as a measured one's would.
    #[inline(always)]
    pub(super) const fn twice_mean(&self) -> f32 {
        self.model + self.next
    }

    /// Goes on with the integral, unless a limit of the voltage would make it grow for nothing.
    #[inline(always)]
    pub(super) const fn integrate(&mut self, law: &Law, deviation: f32, is_limited: bool) {
        if !is_limited {
            self.held += law.integral * deviation;
        }
    }
}
