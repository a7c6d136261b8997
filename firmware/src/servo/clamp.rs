//! The servo's clamp from outside the tick: shut, opened and closed a step a tick.

use super::Servo;
use crate::build_error::BuildError;
use crate::environment::{Discretize, Law};
use crate::number::Number;

impl<E: Discretize<N>, N: Number> Servo<E, N> {
    /// The same servo, whose clamp opens and closes within `ticks`.
    ///
    /// # Errors
    /// Where the step of a tick is nothing in the servo's number format.
    pub(crate) fn fading(self, bound: f64, ticks: f64) -> Result<Self, BuildError> {
        let name = "clamp's step in the servo's number format";
        let step = BuildError::number::<N>(name, bound / ticks)?;
        BuildError::unless_positive(name, step.to_f64())?;
        Ok(Self { limiter: self.limiter.stepping(step), ..self })
    }

    /// Lets no torque through from the next tick on.
    pub(crate) fn shut(&mut self) {
        self.limiter.shut();
    }

    /// Whether no torque gets through.
    pub(crate) fn is_shut(&self) -> bool {
        self.limiter.is_shut()
    }

    /// Opens the clamp by a step; gives whether it is now open.
    pub(crate) fn open(&mut self) -> bool {
        self.limiter.open()
    }

    /// Closes the clamp by a step; gives whether it is now shut.
    pub(crate) fn close(&mut self) -> bool {
        self.limiter.close()
    }

    /// Closes the clamp to the torque that is held, so that closing it further acts at once.
    pub(crate) fn clamp_to_held_torque(&mut self) {
        self.limiter.clamp_to_held_torque(self.torque);
    }

    /// Replaces the held torque, for tests with NaN, which no input causes.
    #[cfg(test)]
    pub(crate) fn poison(&mut self, torque: N) {
        self.torque = torque;
    }

    /// Lets the environment start anew: no torque is held, and it is at rest where the device is,
    /// which is given in rad. The clamp has to be shut.
    ///
    /// What an environment remembers from before then is a motion that it could have seen, so that
    /// all energy in it is what its spring stores at this position; a state left at zero with the
    /// device elsewhere would be none.
    pub(crate) fn rest_here(&mut self) -> N {
        let within = self.law.turn().and_then(|turn| {
            turn.start_at(self.position.count());
            turn.within(self.position.low())
        });
        let count = within.map_or(self.position.reading().count, |(count, _)| count);
        let (x, _) = N::angle(count, self.angle_scale);
        self.torque = N::ZERO;
        self.law.rest_at(x);
        x
    }

    /// Copies another servo's position.
    pub(crate) fn take_position_from(&mut self, other: &Self) {
        self.position = other.position;
    }
}
