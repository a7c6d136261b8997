//! The torque at rest around a knob, for its drawing.

use haptic_model::snap_branches::held;
use serde::{Deserialize, Serialize};

use super::parsed;
use crate::PageResult;
use crate::judge::json;
use crate::scene_text::read;

/// Points of a turn.
const POINTS: u32 = 721;

/// A turn of a scene.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Turn {
    /// Text of the scene.
    scene: String,
    /// Its angles in rad.
    from: f64,
    to: f64,
}

/// The limits of a knob's motion.
#[derive(Serialize)]
struct Rim {
    /// Angles in rad at which its end stops begin.
    ends: Option<[f64; 2]>,
}

/// The torque in N m at rest at evenly spaced angles; empty for a scene without a torque profile.
pub fn rim(question: &str, numbers: &mut Vec<f64>) -> PageResult {
    let Turn { scene, from, to } = parsed(question)?;
    let scene = read(&scene).map_err(|error| error.to_string())?.scene;
    let profile = scene.environment.profile();
    let torque = profile.and_then(|profile| held(&scene, profile));
    if let Some(torque) = torque {
        let angle = |point: u32| from + (to - from) * f64::from(point) / f64::from(POINTS - 1);
        numbers.extend((0..POINTS).map(angle).map(|angle| torque(angle, angle)));
    }
    let ends = profile.and_then(|profile| profile.ends).map(|ends| [ends.from, ends.to]);
    json(&Rim { ends })
}
