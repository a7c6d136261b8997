//! The torque of a scene over the angle, at rest: a torque profile as in `haptic chart profile`, or a wall's
//! line.

use haptic_model::felt;
use haptic_model::profile_curve::{Piece, ProfileCurve};
use haptic_model::quantity::significant;
use haptic_servo::environment::Wall;
use serde_json::{Value, json};

use crate::PageResult;
use crate::scene_text::read;

/// Points of the line of a wall.
const POINTS: usize = 201;
/// Visible range of a wall from its face in rad, without a torque limit.
const REACH: f64 = 0.1;

/// Angle in rad and torque in N m of each point as numbers; the steepest pieces, and the notes.
pub fn profile(text: &str, numbers: &mut Vec<f64>) -> PageResult {
    let file = read(text).map_err(|error| error.to_string())?;
    let scene = &file.scene;
    let limit = scene.torque_limit;
    let compliance = felt::compliance(scene).unwrap_or(0.0);
    let felt = felt::stiffness(scene).filter(|_| compliance > 0.0);
    if let Some(curve) = ProfileCurve::of(scene) {
        numbers.extend(curve.points.iter().flat_map(|[angle, torque, _]| [*angle, *torque]));
        let branches: Vec<_> = curve
            .branches
            .iter()
            .map(|branch| json!({ "points": branch.points, "snaps": branch.snaps }))
            .collect();
        return Ok(json!({
            "kind": "profile",
            "rise": piece(&curve.rise),
            "fall": piece(&curve.fall),
            "certified": curve.certified,
            "branches": branches,
            "limit": limit,
            "compliance": compliance,
            "felt": felt,
        })
        .to_string());
    }
    let Some(wall) = scene.environment.wall() else {
        let words = "no torque over the angle: at rest this environment has none, or none that \
                     depends on the angle alone";
        return Err(format!("{}: {words}", file.name));
    };
    numbers.extend(line(wall, limit));
    Ok(json!({
        "kind": "wall",
        "limit": limit,
        "words": wall_words(wall),
        "compliance": compliance,
        "felt": felt,
    })
    .to_string())
}

fn piece(piece: &Piece) -> Value {
    json!({
        "slope": piece.slope,
        "angle": piece.angle,
        "torque": piece.torque,
        "width": piece.width,
    })
}

/// Angles and torques of a wall around its face.
fn line(wall: &Wall, limit: Option<f64>) -> impl Iterator<Item = f64> {
    let reach = limit
        .map(|limit| 1.5 * limit / wall.stiffness.abs())
        .filter(|reach| *reach > 0.0 && reach.is_finite())
        .unwrap_or(REACH);
    let (stiffness, face, one_sided) = (wall.stiffness, wall.face(), wall.is_one_sided());
    (0..POINTS).flat_map(move |i| {
        let into = reach * (2.0 * i as f64 / (POINTS - 1) as f64 - 1.0);
        let torque = if one_sided && into < 0.0 { 0.0 } else { stiffness * into };
        [face + into, torque]
    })
}

fn wall_words(wall: &Wall) -> String {
    let stiffness = significant(wall.stiffness, 4);
    let face = significant(wall.face(), 4);
    match wall.is_one_sided() {
        true => format!("at rest, {stiffness} N m/rad beyond the face at {face} rad"),
        false => format!("at rest, {stiffness} N m/rad around {face} rad"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::{FREE_MODE, PROFILE, WALL};

    #[test]
    fn a_profile_is_that_of_the_chart() {
        let mut numbers = Vec::new();
        let answer: Value = serde_json::from_str(&profile(PROFILE, &mut numbers).unwrap()).unwrap();
        let curve = ProfileCurve::of(&read(PROFILE).unwrap().scene).unwrap();
        assert_eq!(numbers.len(), 2 * curve.points.len());
        for (pair, point) in numbers.chunks_exact(2).zip(&curve.points) {
            assert_eq!(pair, &point[..2]);
        }
        assert_eq!(answer["certified"].as_f64(), curve.certified);
        // 24 detents of 0.05 N m: a slope of 4 n F / (2 pi).
        let slope = answer["rise"]["slope"].as_f64().unwrap();
        assert!((slope / (4.0 * 24.0 * 0.05 / std::f64::consts::TAU) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_wall_is_a_line_and_free_mode_nothing() {
        let mut numbers = Vec::new();
        let answer: Value = serde_json::from_str(&profile(WALL, &mut numbers).unwrap()).unwrap();
        assert_eq!(answer["felt"].is_null(), answer["compliance"] == 0.0);
        for pair in numbers.chunks_exact(2) {
            assert!((pair[1] - 22.0 * pair[0]).abs() < 1e-12);
        }
        assert!(profile(FREE_MODE, &mut Vec::new()).unwrap_err().contains("no torque"));
    }
}
