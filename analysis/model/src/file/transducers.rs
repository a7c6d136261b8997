//! Sensor and motor of a scene file's servo: those of the file or the defaults.

use std::f64::consts::TAU;

use haptic_servo::encoder::CounterWidth;
use haptic_servo::servo::Transducers;

use super::SceneFile;
use super::key;
use super::supply::FileSupply;

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
        let from_step = self.encoder_step.map(counts_per_turn_of);
        Transducers {
            counts_per_turn: counts_per_turn.or(from_step).unwrap_or(COUNTS_PER_TURN),
            counter: CounterWidth::Bits32,
            full_scale_torque: full_scale
                .or(self.full_scale)
                .or(self.scene.torque_limit)
                .unwrap_or(FULL_SCALE),
            largest_speed: match self.supply {
                Some(FileSupply::Stores { largest_speed, .. }) => largest_speed,
                _ => Transducers::NO_HAND_IS_FASTER,
            },
        }
    }

    /// The same for a board's program, which takes no defaults.
    ///
    /// # Errors
    /// A sentence about the keys that are missing.
    pub fn board_transducers(
        &self,
        counts_per_turn: Option<f64>,
        full_scale: Option<f64>,
    ) -> Result<Transducers, String> {
        let needed = [
            (key::ENCODER_STEP, counts_per_turn.or(self.encoder_step)),
            (key::FULL_SCALE, full_scale.or(self.full_scale)),
        ];
        let missing: Vec<_> = needed
            .iter()
            .filter(|(_, value)| value.is_none())
            .map(|(key, _)| format!("`{}` ({})", key.path, key.unit))
            .collect();
        if missing.is_empty() {
            return Ok(self.transducers(counts_per_turn, full_scale));
        }
        Err(format!(
            "a board's program needs the encoder and the motor of the device: set {}",
            missing.join(" and ")
        ))
    }
}

/// Counts in a turn by the angle of one in rad: a whole number, if the angle was rounded from one.
fn counts_per_turn_of(step: f64) -> f64 {
    const ROUNDED: f64 = 1e-12;
    let counts = TAU / step;
    let whole = counts.round();
    if (counts - whole).abs() <= ROUNDED * whole { whole } else { counts }
}
