//! All errors of a format in a scene's torque.

use haptic_servo::number::Arithmetic;
use serde::Serialize;

use super::{LimitCycle, Motion, at_rest};
use crate::studies::error::StudyError;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Losses {
    /// Largest difference in N m to the torques of `f64` on the same counts.
    pub error: f64,
    /// The same around 1 rad; `None` if the scene cannot be moved there.
    pub error_elsewhere: Option<f64>,
    pub alone: LimitCycle,
    /// The same with the encoder; `None` if its resolution is not stated.
    pub with_encoder: Option<LimitCycle>,
}

impl Losses {
    /// The errors of a format in a motion, and at rest.
    pub fn of(motion: &Motion, arithmetic: Arithmetic) -> Result<Self, StudyError> {
        let elsewhere = motion.around(1.0);
        Ok(Self {
            error: motion.error(arithmetic)?,
            error_elsewhere: elsewhere.map(|motion| motion.error(arithmetic)).transpose()?,
            alone: at_rest(motion.problem(), arithmetic, false)?,
            with_encoder: match motion.problem().steps.encoder {
                Some(_) => Some(at_rest(motion.problem(), arithmetic, true)?),
                None => None,
            },
        })
    }

    /// The errors; torque and angle of the limit cycle alone, and of that with the encoder.
    pub fn figures(&self) -> [Option<f64>; 6] {
        let &Self { error, error_elsewhere, alone, with_encoder } = self;
        let [torque, angle] =
            [with_encoder.map(|cycle| cycle.torque), with_encoder.map(|cycle| cycle.angle)];
        [Some(error), error_elsewhere, Some(alone.torque), Some(alone.angle), torque, angle]
    }
}
