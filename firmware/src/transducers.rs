//! The scales between the numbers of the servo and physical units.

use core::f64::consts::TAU;

use crate::build_error::BuildError;
use crate::dac::DacCode;
use crate::encoder::CounterWidth;
use crate::encoder_reading::EncoderReading;
use crate::environment::Anticogging;
use crate::number::Number;
use crate::scene::Timing;
use crate::torque::{LimitReason, Limiter};

/// The scales of encoder and motor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Transducers {
    /// Encoder counts per turn of the device's axis, after quadrature and gearing.
    pub counts_per_turn: f64,
    /// The width of the counter.
    pub counter: CounterWidth,
    /// Torque of the motor on the device's axis in N m at full scale, [`DacCode::CODES_TO_FULL_SCALE`] codes
    /// from mid-scale.
    pub full_scale_torque: f64,
    /// Largest possible speed of the device in any hand in rad/s: a count that needs a larger speed shows a
    /// broken encoder, and is a fault.
    pub largest_speed: f64,
}

impl Transducers {
    /// A speed in rad/s that no hand reaches at a paddle or a knob, 16 turns a second: for
    /// [`Transducers::largest_speed`] if nothing else is known about the device.
    pub const NO_HAND_IS_FASTER: f64 = 100.0;

    /// An encoder with a counter of 32 bits, at a device that no hand moves faster than
    /// [`Transducers::NO_HAND_IS_FASTER`], and a motor of this torque in N m at full scale.
    pub const fn of(counts_per_turn: f64, full_scale_torque: f64) -> Self {
        let (counter, largest_speed) = (CounterWidth::Bits32, Self::NO_HAND_IS_FASTER);
        Self { counts_per_turn, counter, full_scale_torque, largest_speed }
    }

    /// Checks that a servo can run with them, this timing, these readings and this torque limit.
    ///
    /// # Errors
    /// The invalid number and its bound.
    pub const fn check(
        &self,
        timing: Timing,
        reading: &EncoderReading,
        limit: Option<f64>,
    ) -> Result<(), BuildError> {
        ok!(self.codes_per_torque());
        ok!(self.bound(limit));
        // The counter must not wrap undetected before missed ticks become a fault.
        let worst = or!(timing.worst_period, timing.period);
        ok!(self.largest_step(worst, reading));
        Ok(())
    }

    pub(crate) const fn radians_per_count(&self) -> Result<f64, BuildError> {
        let counts = self.counts_per_turn;
        ok!(BuildError::unless_positive("counts per turn", counts));
        Ok(TAU / counts)
    }

    pub(crate) const fn codes_per_torque(&self) -> Result<f64, BuildError> {
        let full_scale = self.full_scale_torque;
        ok!(BuildError::unless_positive("full-scale torque", full_scale));
        Ok(DacCode::CODES_TO_FULL_SCALE as f64 / full_scale)
    }

    /// The largest number of counts between two readings in `time` s: the way of the device in that time, in which
    /// readings may be dropped and one may be younger than the other, by the slope of the INL, and the error of two
    /// readings at rest. An error if the counter could wrap undetected in that time.
    pub(crate) const fn largest_step(
        &self,
        time: f64,
        reading: &EncoderReading,
    ) -> Result<u32, BuildError> {
        let speed = self.largest_speed;
        ok!(BuildError::unless_positive("largest speed", speed));
        let step = ok!(self.radians_per_count());
        let turned = time * (1.0 + reading.dropped as f64) + 2.0 * reading.deviation_of_age();
        let counts = speed * turned * (1.0 + reading.linearity) / step + reading.steps();
        let half = 0.5 * self.counter.counts();
        // Written so that NaN is refused.
        if counts < half { Ok(counts as u32) } else { Err(BuildError::Speed { counts, half }) }
    }

    /// Energy in J of one count against one code: the unit of the energy monitor.
    pub fn energy_unit(&self) -> f64 {
        TAU / self.counts_per_turn * self.full_scale_torque
            / f64::from(DacCode::CODES_TO_FULL_SCALE)
    }

    /// The largest torque in N m of a scene with this limit: the limit, or otherwise full scale.
    const fn bound(&self, limit: Option<f64>) -> Result<f64, BuildError> {
        let full_scale = self.full_scale_torque;
        let bound = or!(limit, full_scale);
        ok!(BuildError::unless_positive("torque limit", bound));
        if bound > full_scale {
            return Err(BuildError::TorqueLimit { limit: bound, full_scale });
        }
        Ok(bound)
    }

    /// Checks that the anticogging beside a scene with this torque limit is within full scale: clipped by the DAC, the
    /// sum of both would have no certificate.
    pub(crate) const fn check_anticogging(
        &self,
        anticogging: &Anticogging,
        limit: Option<f64>,
    ) -> Result<(), BuildError> {
        let (torque, full_scale) = (anticogging.largest(), self.full_scale_torque);
        let limit = ok!(self.bound(limit));
        // Written so that NaN is refused.
        if torque + limit <= full_scale {
            return Ok(());
        }
        Err(BuildError::Anticogging { torque, limit, full_scale })
    }

    /// The limiter of a scene's torque limit, or otherwise of the DAC's range.
    pub(crate) fn limiter<N: Number>(&self, limit: Option<f64>) -> Result<Limiter<N>, BuildError> {
        let reason = if limit.is_some() { LimitReason::Torque } else { LimitReason::DacRange };
        let bound = N::bound_from_f64(self.bound(limit)?)
            .map_err(|reason| BuildError::Unrepresentable { name: "torque limit", reason })?;
        let name = "torque limit in the servo's number format";
        BuildError::unless_positive(name, bound.to_f64())?;
        Ok(Limiter::new(bound, reason))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time_range::TimeRange;

    /// By hand: at 40 kHz 100 rad/s are 6.52 counts of 16384 in a turn.
    #[test]
    fn a_step_has_room_for_the_errors_of_two_readings() {
        let transducers = Transducers::of(16384.0, 1.0);
        let step = |reading| transducers.largest_step(2.5e-5, &reading);
        let ideal = EncoderReading::IDEAL;
        let noisy = EncoderReading { noise: 2.0, hysteresis: 3.0, ..ideal };
        let aged = EncoderReading { age: TimeRange::between(1e-5, 3.5e-5), ..ideal };
        let dropping = EncoderReading { dropped: 2, linearity: 0.1, ..ideal };
        assert_eq!([ideal, noisy, aged, dropping].map(step), [Ok(7), Ok(14), Ok(14), Ok(22)]);
    }
}
