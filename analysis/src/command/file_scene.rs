//! The scene file of a run, and its hand: that of the file or the default.

use super::rebuild_with_scene;
use super::status::CommandError;
use crate::file::{self, SceneFile};
use crate::hand::HandTrajectory;

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

/// What a hand does to show a scene file: the file's own hand, if it has one.
pub fn hand_trajectory(file: &SceneFile) -> HandTrajectory {
    let mut trajectory = HandTrajectory::push_and_let_go();
    trajectory.hand = file.hand.unwrap_or(trajectory.hand);
    trajectory
}
