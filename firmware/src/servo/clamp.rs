//! The servo's clamp: shut, and opened or closed by one step per tick.

use super::Servo;
use crate::build_error::BuildError;
use crate::coupling_memory::CouplingMemory;
use crate::current::HeatStep;
use crate::environment::{Compensation, Law};
use crate::number::Number;
use crate::rendering::Rendering;
use crate::torque::Limiter;

impl<E: Rendering<N>, N: Number> Servo<E, N> {
    /// The same servo with a clamp that opens and closes within `ticks`; an error if the step of one tick rounds to zero
    /// in the servo's number format.
    pub(crate) fn fading(self, bound: f64, ticks: f64) -> Result<Self, BuildError> {
        let name = "clamp's step in the servo's number format";
        let step = BuildError::number::<N>(name, bound / ticks)?;
        BuildError::unless_positive(name, step.to_f64())?;
        Ok(Self { limiter: self.limiter.stepping(step), ..self })
    }

    pub(crate) fn clamp(&mut self) -> &mut Limiter<N> {
        &mut self.limiter
    }

    /// Moves the open clamp by a step, because of the heat of the torque output.
    pub(crate) fn step_by_heat(&mut self, step: HeatStep) {
        self.limiter.step_by_heat(step, self.anticogging.or_larger(self.torque));
    }

    /// Lowers the clamp to the held torque, so that the next step reduces the torque at once.
    pub(crate) fn clamp_to_held_torque(&mut self) {
        self.limiter.clamp_to_held_torque(self.anticogging.or_larger(self.torque));
    }

    /// Replaces the held torque, for tests with NaN, which no input causes.
    #[cfg(test)]
    pub(crate) fn poison(&mut self, torque: N) {
        self.torque = torque;
    }

    /// Resets the environment to rest at the device's present angle, without a held torque, and returns this
    /// angle in rad. The clamp must be shut.
    ///
    /// The state then corresponds to a possible motion, a device that has always been at rest here, so its
    /// only energy is that of its spring at this position. A state of zero with the device elsewhere would
    /// not correspond to a motion.
    pub(crate) fn rest_here(&mut self) -> N {
        let within = self.law.turn().and_then(|turn| {
            turn.start_at(self.position.count());
            turn.within(self.position.low())
        });
        let count = within.map_or(self.position.reading().count, |(count, _)| count);
        let (x, _) = N::angle(count, self.angle_scale);
        self.torque = N::ZERO;
        self.law.rest_at(x);
        self.anticogging.rest_at(self.position.count(), self.angle_scale);
        self.memory.rest();
        x
    }

    /// Copies another servo's position.
    pub(crate) fn take_position_from(&mut self, other: &Self) {
        self.position = other.position;
    }
}
