//! The branches of a torque profile with a snap point: each over the angles in which it holds the knob.

use std::ops::Range;

use haptic_servo::coupling::Response;
use haptic_servo::environment::{Discretize, Law, Profile, SnapPoint};
use haptic_servo::scene::Scene;

/// Points of a branch.
const POINTS: usize = 200;

/// A branch of a torque profile, up to its snap points.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Angle in rad and torque in N m.
    pub points: Vec<[f64; 2]>,
    /// Where it lets go of the knob: angle in rad, torque in N m before and after.
    pub snaps: Vec<[f64; 3]>,
}

/// The torque in N m of a profile at an angle in rad, while the detent next to another angle holds the knob:
/// by the law that runs, without delay and damping.
pub fn held(scene: &Scene, profile: &Profile) -> Option<impl Fn(f64, f64) -> f64 + use<>> {
    let mut still = *profile;
    (still.delay, still.damping) = (0, None);
    let law = Discretize::<f64>::law(&still.alone(), &scene.context()).ok()?;
    Some(move |held_at: f64, angle: f64| {
        let mut law = law.clone();
        law.rest_at(held_at);
        match law.evaluate(angle) {
            Response::Held(torque) => torque,
            _ => f64::NAN,
        }
    })
}

/// The branches whose centre is shown; none for a profile without a snap point.
pub fn of(scene: &Scene, profile: &Profile, shown: &Range<f64>) -> Vec<Branch> {
    let (Some(snap), Some(torque)) = (profile.snap, held(scene, profile)) else {
        return Vec::new();
    };
    let numbers = Numbers::of(&snap, profile);
    let last = numbers.last.min(((shown.end - numbers.first) / numbers.pitch).floor() as i32);
    let first = numbers.least.max(((shown.start - numbers.first) / numbers.pitch).ceil() as i32);
    (first..=last).map(|branch| numbers.branch(branch, shown, &torque)).collect()
}

struct Numbers {
    /// Centre of the branch 0, distance of two centres, and from a centre to its snap point, all in rad.
    first: f64,
    pitch: f64,
    reach: f64,
    least: i32,
    last: i32,
}

impl Numbers {
    fn of(snap: &SnapPoint, profile: &Profile) -> Self {
        let layout = profile.layout();
        let pitch = snap.pitch(&layout);
        let (least, last) = snap.branches(&layout);
        let first = snap.centre(&layout, 0);
        Self { first, pitch, reach: snap.snap() * pitch, least, last }
    }

    fn branch(&self, branch: i32, shown: &Range<f64>, torque: &impl Fn(f64, f64) -> f64) -> Branch {
        let centre = self.first + f64::from(branch) * self.pitch;
        let end = |side: f64, is_last: bool| {
            // The lowest and the highest branch continue beyond their end stop.
            let free = if side < 0.0 { shown.start } else { shown.end };
            if is_last { free } else { centre + side * self.reach }
        };
        let (is_lowest, is_highest) = (branch == self.least, branch == self.last);
        let (from, to) = (end(-1.0, is_lowest), end(1.0, is_highest));
        let points = (0..POINTS).map(|i| {
            let angle = from + (to - from) * i as f64 / (POINTS - 1) as f64;
            [angle, torque(centre, angle)]
        });
        let snaps = [(-1.0, is_lowest), (1.0, is_highest)].into_iter();
        let snaps = snaps.filter(|(_, is_last)| !is_last).map(|(side, is_last)| {
            let angle = end(side, is_last);
            let nearest = ((angle - self.first) / self.pitch).round() as i32;
            let next = self.first + f64::from(nearest.clamp(self.least, self.last)) * self.pitch;
            [angle, torque(centre, angle), torque(next, angle)]
        });
        Branch { points: points.collect(), snaps: snaps.collect() }
    }
}

/// Slope in N m/rad of the line of every branch.
pub fn slope(snap: &SnapPoint, profile: &Profile) -> f64 {
    let layout = profile.layout();
    snap.torque(&layout) / (snap.snap() * snap.pitch(&layout))
}

/// Centre of the detent next to an angle, and the width of its branch, both in rad.
pub fn next_to(angle: f64, snap: &SnapPoint, profile: &Profile) -> (f64, f64) {
    let numbers = Numbers::of(snap, profile);
    let nearest = ((angle - numbers.first) / numbers.pitch).round() as i32;
    let branch = nearest.clamp(numbers.least, numbers.last);
    (numbers.first + f64::from(branch) * numbers.pitch, 2.0 * numbers.reach)
}
