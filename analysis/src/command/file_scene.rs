//! Sensor, motor and hand of a scene file's run: those of the file or the defaults.

use firmware::encoder::CounterWidth;
use firmware::servo::Transducers;

use super::rebuild_with_scene;
use super::status::CommandError;
use crate::file::{self, SceneFile};
use crate::hand::HandTrajectory;

/// Torque in N m at full scale for a scene file that has no limit of its own.
const FULL_SCALE: f64 = 5.0;

/// Counts a turn for a scene file that does not say its encoder's step.
const COUNTS_PER_TURN: f64 = 65_536.0;

/// A scene file, or the sentence that there is neither such a file nor such a program.
pub fn scene_file(name: &str) -> Result<SceneFile, CommandError> {
    if !name.contains(['.', '/', '\\']) && name != "-" && !std::path::Path::new(name).exists() {
        return Err(CommandError::NoScene {
            name: name.to_owned(),
            programs: rebuild_with_scene::scenes(),
        });
    }
    Ok(file::load(name)?)
}

/// The sensor and the motor of a scene file: those of the file or those given.
pub fn transducers_of(
    file: &SceneFile,
    counts_per_turn: Option<f64>,
    full_scale: Option<f64>,
) -> Transducers {
    let from_step = file.encoder_step.map(|step| std::f64::consts::TAU / step);
    Transducers {
        counts_per_turn: counts_per_turn.or(from_step).unwrap_or(COUNTS_PER_TURN),
        counter: CounterWidth::Bits32,
        full_scale_torque: full_scale
            .or(file.full_scale)
            .or(file.scene.torque_limit)
            .unwrap_or(FULL_SCALE),
        largest_speed: Transducers::NO_HAND_IS_FASTER,
    }
}

/// What a hand does to show a scene file: the file's own hand, if it has one.
pub fn hand_trajectory(file: &SceneFile) -> HandTrajectory {
    let mut trajectory = HandTrajectory::push_and_let_go();
    trajectory.hand = file.hand.unwrap_or(trajectory.hand);
    trajectory
}
