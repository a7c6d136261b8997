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

/// What a file states of encoder and motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatedTransducers {
    /// Angle of one encoder count in rad.
    pub encoder_step: Option<f64>,
    /// Torque of the motor in N m at the DAC's largest code.
    pub full_scale: Option<f64>,
    /// The torque limit of the scene in N m, with the largest torques of a host and of what opposes cogging.
    pub torque_limit: Option<f64>,
    /// The supply of a bridge.
    pub supply: Option<FileSupply>,
}

impl StatedTransducers {
    /// The same with the defaults where nothing is stated.
    pub fn or_defaults(&self) -> Transducers {
        let counts = self.encoder_step.map(counts_per_turn_of);
        Transducers {
            counts_per_turn: counts.unwrap_or(COUNTS_PER_TURN),
            counter: CounterWidth::Bits32,
            full_scale_torque: self.full_scale.or(self.torque_limit).unwrap_or(FULL_SCALE),
            largest_speed: match self.supply {
                Some(
                    FileSupply::Stores { largest_speed, .. } | FileSupply::Sinks { largest_speed },
                ) => largest_speed,
                None => Transducers::NO_HAND_IS_FASTER,
            },
        }
    }

    /// The same for a board's program, which takes no defaults.
    ///
    /// # Errors
    /// A sentence about the keys that are missing.
    pub fn of_board(&self) -> Result<Transducers, String> {
        let needed =
            [(key::COUNTS_PER_TURN, self.encoder_step), (key::FULL_SCALE, self.full_scale)];
        let missing: Vec<_> = needed
            .iter()
            .filter(|(_, value)| value.is_none())
            .map(|(key, _)| format!("`{}` ({})", key.path, key.unit))
            .collect();
        if missing.is_empty() {
            return Ok(self.or_defaults());
        }
        Err(format!(
            "a board's program needs the encoder and the motor of the device: set {}",
            missing.join(" and ")
        ))
    }
}

impl SceneFile {
    /// The sensor and the motor of its servo: those given, or those of the file.
    pub fn transducers(
        &self,
        counts_per_turn: Option<f64>,
        full_scale: Option<f64>,
    ) -> Transducers {
        self.stated(counts_per_turn, full_scale).or_defaults()
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
        self.stated(counts_per_turn, full_scale).of_board()
    }

    /// What it states, with these in place of its own.
    pub(super) fn stated(
        &self,
        counts_per_turn: Option<f64>,
        full_scale: Option<f64>,
    ) -> StatedTransducers {
        let of_host = self.host.map_or(0.0, |host| host.torque);
        let beside = of_host + self.scene.environment.parts().against_cogging();
        StatedTransducers {
            encoder_step: counts_per_turn.map(|counts| TAU / counts).or(self.encoder_step),
            full_scale: full_scale.or(self.full_scale),
            torque_limit: self.scene.torque_limit.map(|limit| limit + beside),
            supply: self.supply,
        }
    }
}

/// Counts in a turn by the angle of one in rad: a whole number, if the angle was rounded from one.
pub(super) fn counts_per_turn_of(step: f64) -> f64 {
    const ROUNDED: f64 = 1e-12;
    let counts = TAU / step;
    let whole = counts.round();
    if (counts - whole).abs() <= ROUNDED * whole { whole } else { counts }
}
