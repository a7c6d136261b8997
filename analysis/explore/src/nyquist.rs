//! The Nyquist plot of a scene, as in `haptic chart nyquist`.

use haptic_model::nyquist::{Curve, NyquistScene, usual_window, words};
use serde_json::{Value, json};

use crate::PageResult;
use crate::scene_text::read;

/// The curves of a scene, their critical lines, and the part of the plane that shows both. The numbers are
/// the angle in rad, the real and the imaginary part in N m s/rad of each point, branch after branch; the
/// answer has the number of points of each branch.
pub fn nyquist(text: &str, numbers: &mut Vec<f64>) -> PageResult {
    let file = read(text).map_err(|error| error.to_string())?;
    let scene = NyquistScene::of(&file.name, &file.scene).map_err(|error| error.to_string())?;
    let scenes = [scene];
    let (x, y) = usual_window(&scenes, None, None);
    let [scene] = &scenes;
    let curves: Vec<_> = scene.curves.iter().map(|curve| of(scene, curve)).collect();
    for (theta, (re, im)) in scene.curves.iter().flat_map(Curve::points) {
        numbers.extend([theta, re, im]);
    }
    Ok(json!({
        "x": [x.start, x.end],
        "y": [y.start, y.end],
        "period": scene.period,
        "limit": scene.limit,
        "limit_name": scene.limit_name,
        "bound": scene.bound,
        "bound_words": words::bound("", scene),
        "halves": words::HALVES,
        "curves": curves,
    })
    .to_string())
}

fn of(scene: &NyquistScene, curve: &Curve) -> Value {
    json!({
        "role": curve.role.as_str(),
        "judged": curve.role.is_judged(),
        "alpha": curve.alpha,
        "minimum": curve.minimum,
        "asymptote": curve.asymptote,
        "branches": curve.branches.iter().map(|branch| branch.values.len()).collect::<Vec<_>>(),
        "phase_margin": scene.phase_margin(curve).map(|(_, _, value)| value),
        "words": words::curve("", scene, curve, true),
    })
}

#[cfg(test)]
mod tests {
    use haptic_model::response::Response;
    use haptic_servo::certificate::{LoopTransfers, assess};

    use super::*;
    use crate::test_scenes::{PROFILE, WALL};

    #[test]
    fn the_curve_has_the_values_of_the_transfer_function() {
        let mut numbers = Vec::new();
        let answer: Value = serde_json::from_str(&nyquist(WALL, &mut numbers).unwrap()).unwrap();
        let scene = read(WALL).unwrap().scene;
        let environment = Response::new(LoopTransfers::of(&scene).unwrap().environment);
        for point in numbers.chunks_exact(3) {
            let (theta, re, im) = (point[0], point[1], point[2]);
            // T z / (z - 1) in front of it, by hand: T / 2 (1 - i cot(theta / 2)).
            let half = 0.5 * scene.timing.period;
            let cot = (0.5 * theta).cos() / (0.5 * theta).sin();
            let value = environment.at_angle(theta);
            let expected = (half * (value.re + cot * value.im), half * (value.im - cot * value.re));
            let near = 1e-9 * expected.0.hypot(expected.1);
            assert!((re - expected.0).abs() <= near && (im - expected.1).abs() <= near, "{theta}");
        }
        let alpha = answer["curves"][0]["alpha"].as_f64().unwrap();
        assert!((alpha - assess(&scene).alpha.unwrap().midpoint()).abs() < 1e-15);
        assert_eq!(answer["limit"], 0.022);
        let points: u64 = answer["curves"][0]["branches"]
            .as_array()
            .unwrap()
            .iter()
            .map(|count| count.as_u64().unwrap())
            .sum();
        assert_eq!(3 * points as usize, numbers.len());
    }

    #[test]
    fn a_scene_without_a_transfer_function_is_refused_in_a_sentence() {
        let refusal = nyquist(PROFILE, &mut Vec::new()).unwrap_err();
        assert!(refusal.contains("torque profile"), "{refusal}");
        assert!(nyquist("{}", &mut Vec::new()).unwrap_err().contains("name"));
    }
}
