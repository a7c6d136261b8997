//! Sensor and motor of a scene file's servo: those of the file or the defaults.

use std::f64::consts::TAU;

use haptic_servo::encoder::CounterWidth;
use haptic_servo::servo::Transducers;

use super::SceneFile;

/// Torque in N m at full scale for a scene file that has no limit of its own.
const FULL_SCALE: f64 = 5.0;

/// Counts a turn for a scene file that does not state its encoder's step.
const COUNTS_PER_TURN: f64 = 65_536.0;

impl SceneFile {
    /// The sensor and the motor of its servo: those given, or those of the file.
    pub fn transducers(
        &self,
        counts_per_turn: Option<f64>,
        full_scale: Option<f64>,
    ) -> Transducers {
        let from_step = self.encoder_step.map(|step| TAU / step);
        Transducers {
            counts_per_turn: counts_per_turn.or(from_step).unwrap_or(COUNTS_PER_TURN),
            counter: CounterWidth::Bits32,
            full_scale_torque: full_scale
                .or(self.full_scale)
                .or(self.scene.torque_limit)
                .unwrap_or(FULL_SCALE),
            largest_speed: Transducers::NO_HAND_IS_FASTER,
        }
    }
}
