//! The scene file of a run, and its hand: the file's or the default.

use super::rebuild_with_scene;
use super::shared_arguments::warned;
use super::status::CommandError;
use crate::file::{self, SceneFile};
use crate::hand::HandTrajectory;

/// Whether a scene's name is that of a file, not of a program.
pub fn is_file(name: &str) -> bool {
    name.contains(['.', '/', '\\']) || name == "-" || std::path::Path::new(name).exists()
}

/// A scene file, or the error that there is neither such a file nor such a program.
pub fn scene_file(name: &str) -> Result<SceneFile, CommandError> {
    if !is_file(name) {
        return Err(CommandError::NoScene {
            name: name.to_owned(),
            programs: rebuild_with_scene::scenes(),
        });
    }
    Ok(warned(file::load(name)?))
}

/// The hand's trajectory for a scene file: the file's own, if it has one.
pub fn hand_trajectory(file: &SceneFile) -> HandTrajectory {
    let mut trajectory = HandTrajectory::push_and_let_go();
    trajectory.hand = file.hand.unwrap_or(trajectory.hand);
    trajectory
}
