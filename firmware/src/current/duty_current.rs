//! The current of a constant duty in a load of known resistance and inductance, for the test of a power stage
//! before it drives a motor (theory, section 15.9).

use super::current_loop::CurrentLoop;
use super::error::DriveError;
use super::modulation::Duties;
use super::motor::Drive;
use super::power_stage::PowerStage;
use crate::text::{Text, error_with_sentence, push};

/// Relative tolerance of the dead time: switching takes time, too.
const DEAD_TIME_TOLERANCE: f64 = 0.5;

/// Time constants after which a current counts as settled: the rest is below a count.
const SETTLING: f64 = 10.0;

/// The current that settles at a duty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DutyCurrent {
    /// The lower bound in A.
    pub least: f64,
    /// The upper bound in A.
    pub most: f64,
    /// Instants until it has settled.
    pub settling: u32,
}

/// The reason why there is no such current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DutyError {
    /// A number is zero, negative or not finite.
    Drive(DriveError),
    /// A load has two terminals.
    Brushless,
    /// The tolerance is not between 0 and 1.
    Tolerance(f64),
    /// The dead time takes all of the duty, or the low sides have no time.
    Duty {
        /// The duty.
        duty: f64,
        /// The lower bound of the duty.
        least: f64,
        /// The upper bound of the duty.
        most: f64,
    },
    /// The board does not tolerate the current.
    Current {
        /// The largest current in A at this duty.
        current: f64,
        /// The largest current in A that the board tolerates.
        largest: f64,
    },
}

impl Drive {
    /// The current in A at a duty, which is the part of the supply between the terminals U and V, with a
    /// winding at rest or a load in its place. `tolerance` is the relative tolerance of resistance and
    /// inductance.
    ///
    /// In each period of the modulation the dead time takes away twice its part of the supply. In the middle
    /// of the low sides' time the ripple is zero.
    ///
    /// # Errors
    /// If a number is NaN or out of its bounds.
    pub const fn current_at_duty(
        &self,
        stage: &PowerStage,
        instant: f64,
        duty: f64,
        tolerance: f64,
    ) -> Result<DutyCurrent, DutyError> {
        ok!(self.check_load(instant, tolerance));
        let dead = 2.0 * stage.dead_time / instant;
        let (least, most) =
            (dead * (1.0 + DEAD_TIME_TOLERANCE), 1.0 - 2.0 * stage.shortest_low / instant);
        // Written so that NaN is refused.
        let is_between = duty > least && duty <= most;
        if !is_between {
            return Err(DutyError::Duty { duty, least, most });
        }
        let (resistance, inductance) = (self.motor.resistance, self.motor.inductance);
        let (high, low) = (1.0 + tolerance, 1.0 - tolerance);
        let current = DutyCurrent {
            least: self.supply.lowest * (duty - least) / (resistance * high),
            most: self.supply.highest * (duty - dead * (1.0 - DEAD_TIME_TOLERANCE))
                / (resistance * low),
            // The cast rounds a positive number down.
            settling: (SETTLING * inductance * high / (resistance * low * instant)) as u32 + 1,
        };
        if current.most > stage.largest_current {
            let (current, largest) = (current.most, stage.largest_current);
            return Err(DutyError::Current { current, largest });
        }
        Ok(current)
    }

    const fn check_load(&self, instant: f64, tolerance: f64) -> Result<(), DutyError> {
        if self.motor.winding.is_brushless() {
            return Err(DutyError::Brushless);
        }
        let is_part = tolerance >= 0.0 && tolerance < 1.0;
        if !is_part {
            return Err(DutyError::Tolerance(tolerance));
        }
        let numbers = DriveError::unless_positive(&[
            ("load's resistance", self.motor.resistance),
            ("load's inductance", self.motor.inductance),
            ("lowest supply", self.supply.lowest),
            ("highest supply", self.supply.highest),
            ("period of the modulation", instant),
        ]);
        match numbers {
            Ok(()) => Ok(()),
            Err(error) => Err(DutyError::Drive(error)),
        }
    }

    /// The same for constants.
    ///
    /// # Panics
    /// If there is no such current; in a constant this is a compile error.
    #[track_caller]
    pub const fn checked_current_at_duty(
        &self,
        stage: &PowerStage,
        instant: f64,
        duty: f64,
        tolerance: f64,
    ) -> DutyCurrent {
        match self.current_at_duty(stage, instant, duty, tolerance) {
            Ok(current) => current,
            Err(error) => error.refuse(),
        }
    }
}

impl CurrentLoop {
    /// Compare values of a duty, which is the part of the supply from U to V, from -1 to 1: the nearest
    /// values that leave the low sides their time.
    pub const fn duties_at(&self, duty: f64) -> Duties {
        let span = self.output.span as f32;
        let difference = duty as f32 * self.timing.counts as f32;
        self.timing.between_two(difference.clamp(-span, span))
    }

    /// Current in A between U and V, from the difference of the two phases' counts above those without a
    /// current.
    pub const fn current_between_two(&self, difference: f32) -> f32 {
        self.law.between_two(difference)
    }
}

impl DutyError {
    /// The error as a sentence.
    pub const fn sentence(&self) -> Text<320> {
        let mut t = Text::new();
        match *self {
            Self::Drive(error) => return error.sentence(),
            Self::Brushless => {
                t.push("a load has two terminals: state it as the winding of a brushed motor")
            }
            Self::Tolerance(tolerance) => {
                push!(t, "the tolerance must be from 0 to below 1, and is " {tolerance});
            }
            Self::Duty { duty, least, most } => push!(t,
                "the duty must be above " {least} ", which the dead time may take, and at most " {most}
                ", which leaves the low sides their time, and is " {duty}),
            Self::Current { current, largest } => push!(t,
                "the load may take " {current} " A, and the power stage bears " {largest}
                " A: take a larger resistance, a lower supply or a smaller duty"),
        }
        t
    }
}

error_with_sentence!(DutyError);
