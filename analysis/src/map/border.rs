//! Where the formulas of theory, section 5, put the border of what the paper's rule certifies.

use firmware::certificate::assess;
use firmware::environment::{Environment, Wall};
use firmware::passivity::closed_form;
use firmware::passivity::interval::Interval;
use firmware::scene::{Coupling, Scene};

use super::{Family, Map};

/// Points along the border.
const POINTS: usize = 400;

/// Halvings of the stiffness range: to a millionth of a pixel.
const HALVINGS: usize = 40;

/// Stiffness (N m/rad) and damping (N m s/rad) along the border on which the closed form of the
/// environment's index reaches what the paper's rule leaves it; empty where there is no formula.
pub fn closed_form_border(family: &Family, map: &Map) -> Vec<(f64, f64)> {
    let limit = limit(family.scene());
    let at = |index: usize| {
        let part = index as f64 / (POINTS - 1) as f64;
        let damping = map.damping.start + part * (map.damping.end - map.damping.start);
        let spare =
            |stiffness: f64| Some(limit - index_of(&family.member(stiffness, damping))?.midpoint());
        let (mut low, mut high) = (map.stiffness.start.max(f64::MIN_POSITIVE), map.stiffness.end);
        if spare(low)? <= 0.0 || spare(high)? > 0.0 {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if spare(middle)? > 0.0 { low = middle } else { high = middle }
        }
        Some((low, damping))
    };
    (0..POINTS).filter_map(at).collect()
}

/// What the paper's rule leaves to the environment: `K_vc T / 2`, and no more than `delta`.
fn limit(scene: &Scene) -> f64 {
    let delta = assess(scene).delta.midpoint();
    match scene.coupling {
        Coupling::Spring { stiffness } => delta.min(0.5 * stiffness * scene.timing.period),
        Coupling::Rigid => delta,
    }
}

/// The index in N m s/rad where there is a formula for it.
fn index_of(scene: &Scene) -> Option<Interval> {
    let period = Interval::decimal(scene.timing.period);
    match scene.environment {
        Environment::DelayedSpring(wall) => wall_index(&wall, period),
        Environment::DamperWall(wall) => wall_index(&wall, period),
        Environment::FreeModeWall { residual, wall } => {
            let Coupling::Spring { stiffness } = scene.coupling else { return None };
            let cancelled = Interval::decimal(scene.device.damping - residual);
            let (k, b) = numbers(&wall);
            match (wall.delay, wall.filter) {
                (0, None) => Some(closed_form::free_mode_undelayed_wall(cancelled, k, b, period)),
                (1, None) if wall.damping >= 0.0 => {
                    let coupling = Interval::decimal(stiffness);
                    Some(closed_form::free_mode_delayed_wall(cancelled, coupling, k, b, period))
                }
                _ => None,
            }
        }
        Environment::FreeMode { .. } | Environment::Rational(_) => None,
    }
}

fn wall_index(wall: &Wall, period: Interval) -> Option<Interval> {
    let (k, b) = numbers(wall);
    match wall.filter {
        _ if wall.damping == 0.0 => Some(closed_form::delayed_spring(k, period, wall.delay)),
        None => closed_form::damper_wall(k, b, period, wall.delay),
        Some(pole) if wall.delay == 1 && wall.damping > 0.0 => {
            Some(closed_form::filtered_wall(k, b, Interval::decimal(pole), period))
        }
        Some(_) => None,
    }
}

fn numbers(wall: &Wall) -> (Interval, Interval) {
    (Interval::decimal(wall.stiffness), Interval::decimal(wall.damping))
}
