//! A torque profile over angle, with its steepest slopes and the slope that would still certify.

use std::f64::consts::TAU;
use std::ops::Range;

use haptic_servo::environment::{Ends, FULL_SCALE, Profile};
use haptic_servo::scene::Scene;

use crate::design::{DesignLimit, Quantity, Terms, largest};
use crate::felt;
use crate::snap_branches::{self, Branch, held, slope};

/// Points of a curve.
const POINTS: usize = 4000;
/// Largest range that is shown beyond an end stop, as a fraction of the range between the end stops.
const BEYOND: f64 = 0.08;
/// Torque of the end stops up to which they are shown, in torques of the profile: more would hide the
/// profile.
const PUSHED: f64 = 1.5;
/// Repetitions that are shown of a profile without end stops.
const REPETITIONS: f64 = 3.0;

/// A straight piece of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Slope in N m/rad: positive where the torque pushes back.
    pub slope: f64,
    /// Angle in rad in its middle.
    pub angle: f64,
    /// Torque in N m there.
    pub torque: f64,
    /// Width in rad.
    pub width: f64,
}

/// A torque profile over angle.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileCurve {
    /// Angle in rad, torque in N m and potential in J above its least value.
    pub points: Vec<[f64; 3]>,
    /// The piece that rises most.
    pub rise: Piece,
    /// The piece that falls most.
    pub fall: Piece,
    /// The steepest rise in N m/rad with which the scene certifies: all torques change in proportion, or only
    /// the end stops if they are steepest. `None` if there is none.
    pub certified: Option<f64>,
    /// Compliance in rad/(N m) of the coupling in front of it: see [`felt::compliance`].
    pub compliance: f64,
    /// The branches of a profile with a snap point, of which `points` has those of the nearest detents.
    pub branches: Vec<Branch>,
}

impl ProfileCurve {
    /// For a scene with a torque profile; `None` for any other.
    pub fn of(scene: &Scene) -> Option<Self> {
        Self::over(scene, &shown(scene.environment.profile()?))
    }

    /// The same over these angles in rad.
    pub fn over(scene: &Scene, shown: &Range<f64>) -> Option<Self> {
        let profile = scene.environment.profile()?;
        let torque = undelayed(scene, profile)?;
        let angle =
            |i: usize| shown.start + (shown.end - shown.start) * i as f64 / (POINTS - 1) as f64;
        let mut points: Vec<[f64; 3]> = Vec::with_capacity(POINTS);
        for i in 0..POINTS {
            let (x, f) = (angle(i), torque(angle(i)));
            let energy = points
                .last()
                .map_or(0.0, |[before, at, energy]| energy + 0.5 * (at + f) * (x - before));
            points.push([x, f, energy]);
        }
        let least = points.iter().map(|point| point[2]).fold(f64::INFINITY, f64::min);
        points.iter_mut().for_each(|point| point[2] -= least);
        let line = profile.snap.map_or(0.0, |snap| slope(&snap, profile));
        let mut table = *profile;
        table.snap = None;
        let table = undelayed(scene, &table)?;
        let mut pieces = steepest(profile, shown, &table);
        let certified =
            certified_rise(scene, profile, pieces[0].slope, line).map(|slope| slope + line);
        for piece in &mut pieces {
            // The line of a branch adds to all pieces; where the table is level there is only this line.
            if let (Some(snap), true) = (profile.snap, piece.slope == 0.0) {
                (piece.angle, piece.width) = snap_branches::next_to(piece.angle, &snap, profile);
            }
            *piece = Piece { slope: piece.slope + line, torque: torque(piece.angle), ..*piece };
        }
        let [rise, mut fall] = pieces;
        if fall.slope > 0.0 {
            (fall.slope, fall.width) = (0.0, 0.0);
        }
        let branches = snap_branches::of(scene, profile, shown);
        let compliance = felt::compliance(scene).unwrap_or(0.0);
        Some(Self { points, rise, fall, certified, compliance, branches })
    }

    /// The angle in rad of the handle where the profile is at an angle with a torque in N m.
    pub fn at_handle(&self, angle: f64, torque: f64) -> f64 {
        angle + self.compliance * torque
    }
}

/// The angles in rad to show: between end stops and a little beyond, a turn, or some repetitions.
fn shown(profile: &Profile) -> Range<f64> {
    match profile.ends {
        Some(Ends { from, to, stiffness }) => {
            let beyond = (PUSHED * profile.torque / stiffness).min(BEYOND * (to - from));
            from - beyond..to + beyond
        }
        None => {
            let width = TAU / profile.count * REPETITIONS.min(profile.count);
            profile.centre - 0.5 * width..profile.centre + 0.5 * width
        }
    }
}

/// The torque in N m at an angle in rad, in the nearest detent where there are several branches.
fn undelayed(scene: &Scene, profile: &Profile) -> Option<impl Fn(f64) -> f64 + use<>> {
    let torque = held(scene, profile)?;
    Some(move |angle: f64| torque(angle, angle))
}

/// The steepest pieces, up and down, next to the middle of the shown range.
fn steepest(profile: &Profile, shown: &Range<f64>, torque: impl Fn(f64) -> f64) -> [Piece; 2] {
    let (units, per_rad) = (profile.units(), profile.knots_per_rad());
    let width = 1.0 / per_rad;
    let unit = profile.torque / f64::from(FULL_SCALE) * per_rad;
    let within = profile
        .ends
        .map_or(shown.clone(), |ends| ends.from.max(shown.start)..ends.to.min(shown.end));
    let middle = 0.5 * (within.start + within.end);
    let cells = units.len() - usize::from(!profile.outline().wraps);
    let slope = |cell: usize| {
        let next = units[(cell + 1) % units.len()];
        f64::from(i32::from(next) - i32::from(units[cell])) * unit
    };
    let repeats = TAU / profile.count;
    let best = |sign: f64| {
        let steepest = (0..cells).map(|cell| sign * slope(cell)).fold(f64::NEG_INFINITY, f64::max);
        let angles = (0..cells).filter(|&cell| sign * slope(cell) == steepest).map(|cell| {
            let angle = profile.centre + (cell as f64 + 0.5) * width;
            // The same one in the repetition next to the middle.
            if profile.outline().wraps {
                angle - ((angle - middle) / repeats).round() * repeats
            } else {
                angle
            }
        });
        let angle = angles.min_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()));
        let angle = angle.unwrap_or(middle);
        // As far as the straight line continues, except for the rounding of knots to units.
        let is_same = |at: f64| {
            let rise = torque(at + 0.5 * width) - torque(at - 0.5 * width);
            (rise / width - sign * steepest).abs() <= 2.5 * unit
        };
        let go_on = |step: f64| {
            let cells = (1..units.len()).take_while(|&cell| is_same(angle + step * cell as f64));
            step * cells.count() as f64
        };
        let (down, up) = (go_on(-width), go_on(width));
        let angle = angle + 0.5 * (down + up);
        Piece { slope: sign * steepest, angle, torque: torque(angle), width: width + up - down }
    };
    let [mut rise, fall] = [best(1.0), best(-1.0)];
    if let Some(Ends { to, stiffness, .. }) = profile.ends
        && stiffness > rise.slope
        && shown.end > to
    {
        let width = shown.end - to;
        let angle = to + 0.5 * width;
        rise = Piece { slope: stiffness, angle, torque: torque(angle), width };
    }
    [rise, fall]
}

/// For the table and its end stops, beside the line to a snap point: this line grows with the torque, and
/// stays unchanged where the end stops grow.
fn certified_rise(scene: &Scene, profile: &Profile, rise: f64, line: f64) -> Option<f64> {
    let is_of_stops = profile.ends.is_some_and(|ends| ends.stiffness == rise);
    // With a wall beside the profile this quantity is the stiffness of the wall.
    if is_of_stops && scene.environment.wall().is_none() {
        return match largest(scene, Quantity::Stiffness, &Terms::KEPT) {
            DesignLimit::Limit(stiffness, _) => Some(stiffness),
            _ => None,
        };
    }
    match largest(scene, Quantity::Torque, &Terms::KEPT) {
        DesignLimit::Limit(torque, _) => Some((rise + line) * torque / profile.torque - line),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::file_on_paddle;

    const DETENTS: &str = "[coupling]\nstiffness = 44.0\n[environment]\ntype = \"profile\"\ndelay = 1\n\
        [[environment.shape]]\ntype = \"detents\"\ncount = 24\ntorque = 0.05\n";

    fn curve(text: &str) -> ProfileCurve {
        ProfileCurve::of(&file_on_paddle(text).scene).unwrap()
    }

    /// A wave of straight lines: slope `4 n F / (2 pi)`, and the area of a triangle between a place to
    /// rest at and the top beside it.
    #[test]
    fn detents_have_their_slope_and_their_height() {
        let curve = curve(DETENTS);
        let slope = 4.0 * 24.0 * 0.05 / TAU;
        assert!((curve.rise.slope / slope - 1.0).abs() < 1e-3, "{:?}", curve.rise);
        assert!((curve.fall.slope / slope + 1.0).abs() < 1e-3, "{:?}", curve.fall);
        assert!((curve.certified.unwrap() / 44.0 - 1.0).abs() < 1e-6, "{:?}", curve.certified);
        let end = curve.rise.torque + 0.5 * curve.rise.width * curve.rise.slope;
        assert!((curve.at_handle(0.1, end) - 0.1 - end / 44.0).abs() < 1e-12);
        assert!((curve.rise.width / (TAU / 48.0) - 1.0).abs() < 1e-3, "{:?}", curve.rise);
        let height = curve.points.iter().map(|point| point[2]).fold(0.0, f64::max);
        let triangle = 0.5 * (TAU / 48.0) * 0.05;
        assert!((height / triangle - 1.0).abs() < 1e-3, "{height} {triangle}");
        let torques = curve.points.iter().map(|point| point[1]);
        assert!((torques.fold(0.0, f64::max) / 0.05 - 1.0).abs() < 1e-2);
    }

    #[test]
    fn the_steepest_rise_may_be_that_of_the_end_stops() {
        let stops = "[[environment.shape]]\ntype = \"end_stops\"\nfrom = -1.0\nto = 1.0\n";
        let curve = curve(&format!("{DETENTS}{stops}stiffness = 15.0\n"));
        assert_eq!(curve.rise.slope, 15.0);
        assert!(curve.rise.angle > 1.0 && curve.fall.angle.abs() < 1.0);
        assert!((curve.certified.unwrap() / 44.0 - 1.0).abs() < 1e-6, "{:?}", curve.certified);
        let beyond = 1.5 * 0.05 / 15.0;
        assert!((curve.points[POINTS - 1][0] - 1.0 - beyond).abs() < 1e-6);
        assert!((curve.points[0][0] + 1.0 + beyond).abs() < 1e-6);
    }
}
