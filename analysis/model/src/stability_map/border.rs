//! The certified border by the formulas of theory, section 5.

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::environment::{Parts, Wall};
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::{Coupling, Scene};

use super::{Family, Map};
use crate::closed_form;

/// Points along the border.
const POINTS: usize = 400;

/// Halvings of the stiffness range: to a millionth of a pixel.
const HALVINGS: usize = 40;

/// A border that a formula gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Border {
    /// Name of its region.
    pub name: &'static str,
    /// Stiffness (N m/rad) and damping (N m s/rad) along it.
    pub points: Vec<(f64, f64)>,
}

/// Which formula is compared with which limit.
#[derive(Clone, Copy)]
enum Formula {
    /// The index of the environment alone, against the limit of the paper's rule.
    Paper,
    /// The bound on the index of one-sided and limited scenes, against the same limit.
    Bound,
    /// For a rigid coupling: the index of the environment a sample later, against `delta` (theory, section 5:
    /// the standard coupling is worth one tick).
    SampleLater,
}

impl Formula {
    /// The formula for these scenes; `None` if there is none: with a rigid coupling, two indices count where
    /// updates may be missed, and torques that lag have no formula; behind a coupling stiffer than the
    /// standard one the paper's rule has no limit.
    fn of(scene: &Scene) -> Option<Self> {
        let posed = PassivityProblem::of(scene).ok()?;
        let misses = scene.timing.longer_period().is_some();
        match (scene.coupling, is_linear(scene)) {
            (Coupling::Rigid, true) if !misses && scene.latency.is_none() => {
                Some(Self::SampleLater)
            }
            (Coupling::Spring { .. }, true) => posed.paper_limit().map(|_| Self::Paper),
            (_, false) => posed.limit().map(|_| Self::Bound),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Paper => "closed form of the paper's border",
            Self::Bound => "closed form: the bound of one-sided or limited scenes",
            Self::SampleLater => "closed form: the exact rule with a rigid coupling",
        }
    }

    /// The limit minus the index; `None` where one of them does not exist.
    fn spare(self, scene: &Scene) -> Option<f64> {
        let posed = PassivityProblem::of(scene).ok()?;
        let (limit, index) = match self {
            Self::Paper => (posed.paper_limit(), index_of(scene, 0)),
            Self::Bound => (posed.limit(), posed.bound()),
            Self::SampleLater => (posed.limit(), index_of(scene, 1)),
        };
        Some(limit?.midpoint() - index?.midpoint())
    }
}

fn is_linear(scene: &Scene) -> bool {
    scene.torque_limit.is_none() && scene.environment.wall().is_none_or(|wall| !wall.is_one_sided())
}

/// The border on which a closed form reaches its limit: none of the points that it encloses is
/// rejected. `None` where there is no formula.
pub fn closed_form_border(family: &Family, map: &Map) -> Option<Border> {
    let formula = Formula::of(family.scene())?;
    let at = |index: usize| {
        let part = index as f64 / (POINTS - 1) as f64;
        let damping = map.y.start + part * (map.y.end - map.y.start);
        let spare = |stiffness: f64| formula.spare(&family.member(stiffness, damping));
        let (mut low, mut high) = (map.x.start.max(f64::MIN_POSITIVE), map.x.end);
        if spare(low)? <= 0.0 || spare(high)? > 0.0 {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if spare(middle)? > 0.0 { low = middle } else { high = middle }
        }
        Some((low, damping))
    };
    let points: Vec<_> = (0..POINTS).filter_map(at).collect();
    (points.len() > 1).then(|| Border { name: formula.name(), points })
}

/// The index in N m s/rad of an environment with a delay that is `later` samples longer, where there is a
/// formula for it.
fn index_of(scene: &Scene, later: usize) -> Option<Interval> {
    let period = Interval::decimal(scene.timing.period);
    let parts = scene.environment.parts();
    let &Parts { canceller, wall: Some(wall), profile: None, .. } = parts else { return None };
    if parts.others() > 0 {
        return None;
    }
    let Some(canceller) = canceller else {
        return wall_index(&Wall { delay: wall.delay + later, ..wall }, period);
    };
    let Coupling::Spring { stiffness } = scene.coupling else { return None };
    let cancelled = Interval::decimal(scene.device.damping - canceller.residual);
    let (k, b) = numbers(&wall);
    match (wall.delay, wall.filter()) {
        _ if later > 0 => None,
        (0, None) => Some(closed_form::free_mode_undelayed_wall(cancelled, k, b, period)),
        (1, None) if wall.damping() >= 0.0 => {
            let coupling = Interval::decimal(stiffness);
            Some(closed_form::free_mode_delayed_wall(cancelled, coupling, k, b, period))
        }
        _ => None,
    }
}

fn wall_index(wall: &Wall, period: Interval) -> Option<Interval> {
    let (k, b) = numbers(wall);
    match wall.filter() {
        _ if wall.damping() == 0.0 => Some(closed_form::delayed_spring(k, period, wall.delay)),
        None => closed_form::damper_wall(k, b, period, wall.delay),
        Some(pole) if wall.delay == 1 && wall.damping() > 0.0 => {
            Some(closed_form::filtered_wall(k, b, Interval::decimal(pole), period))
        }
        Some(_) => None,
    }
}

fn numbers(wall: &Wall) -> (Interval, Interval) {
    (Interval::decimal(wall.stiffness), Interval::decimal(wall.damping()))
}
