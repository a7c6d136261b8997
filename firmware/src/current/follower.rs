//! One current and its model: feed-forward and feedback (theory, sections 15.1 and 15.2).

use super::current_loop::Law;

/// A current that follows its model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower {
    /// The model's current in A at this instant, and at the next instant, whose voltage is already set.
    model: f32,
    next: f32,
    /// The integral part of the feedback.
    held: f32,
}

/// The requested voltage, and the deviation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Voltage in V. It does not include the motor's back-EMF, which the feedback compensates (theory,
    /// section 15.8).
    pub volts: f32,
    /// The model's current less the measured one, in A.
    pub deviation: f32,
}

impl Follower {
    /// No current and no voltage.
    pub(super) const AT_REST: Self = Self { model: 0.0, next: 0.0, held: 0.0 };

    /// Advances the model by an instant, independently of the available voltage, because it is the certified
    /// model. The voltage moves the current to the model.
    #[inline(always)]
    pub(super) const fn follow(&mut self, law: &Law, reference: f32, current: f32) -> Wanted {
        let deviation = self.model - current;
        let after_next = self.next + law.model_gain * (reference - self.next);
        let forward = (after_next - law.decay * self.next) * law.volts;
        let feedback = law.proportional * deviation + (self.held + law.integral * deviation);
        (self.model, self.next) = (self.next, after_next);
        Wanted { volts: forward + feedback, deviation }
    }

    /// The voltage across the model's current for each rad that the current turns from an instant to the
    /// middle of the next voltage. Call it after [`follow`](Self::follow).
    #[inline(always)]
    pub(super) const fn volts_across(&self, law: &Law) -> f32 {
        (self.next + law.decay * self.model) * law.volts
    }

    /// Twice the model's mean current while the voltage acts. Call it after [`follow`](Self::follow). It has
    /// no noise, so its sign does not flicker like that of a measured current.
    #[inline(always)]
    pub(super) const fn twice_mean(&self) -> f32 {
        self.model + self.next
    }

    /// Updates the integral, unless the voltage is limited and the integral would wind up.
    #[inline(always)]
    pub(super) const fn integrate(&mut self, law: &Law, deviation: f32, is_limited: bool) {
        if !is_limited {
            self.held += law.integral * deviation;
        }
    }
}
