//! Verdicts on scenes that differ in two of their numbers: in stiffness and damping of a wall, in torque and
//! number of repetitions of a torque profile, or in any two numbers that the user chooses.

use std::borrow::Cow;
use std::ops::Range;

use haptic_servo::certificate::assess;
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::Scene;

use super::plant::SampledPlant;
use super::{Family, Kept, MapError, Region, judged, kept};
use crate::design::{DesignLimit, Quantity, Terms, largest};
use crate::file::SceneFile;
use crate::simulation::closed_loop::transfers;
use crate::simulation::plant::Plant;
use crate::simulation::{Experiment, Integration};

/// How far an axis goes beyond the scene's own number.
const BEYOND: f64 = 2.5;
/// Least period on an axis, as a fraction of the scene's own: a period of zero is invalid.
const SHORTEST: f64 = 0.05;

/// The numbers that may be an axis: those that the verdict rests on, except those of the device's chain and
/// those with few steps.
const CHOICE: [Parameter; 14] = [
    Parameter::Stiffness,
    Parameter::Damping,
    Parameter::Filter,
    Parameter::Residual,
    Parameter::Count,
    Parameter::ProfileTorque,
    Parameter::StatedIndex,
    Parameter::StatedGain,
    Parameter::CouplingStiffness,
    Parameter::Period,
    Parameter::OutputDelay,
    Parameter::ActuatorLag,
    Parameter::SensorLag,
    Parameter::TorqueLimit,
];

/// The scenes that differ from a file's in two numbers only.
#[derive(Clone, Debug)]
pub struct Plane {
    axes: [Parameter; 2],
    alone: Experiment,
    judge: Judge,
}

/// The way in which a member is judged.
#[derive(Clone, Debug)]
enum Judge {
    /// A wall of another stiffness and damping.
    Walls(Box<Family>),
    /// A scene on a device that no axis changes.
    OnePlant(SampledPlant),
    /// The vertical axis is a time of the loop: all members of a row are on the same device.
    PlantOfRow,
    /// The horizontal axis is a time of the loop.
    PlantOfMember,
    /// The environment has no transfer function: only its certificate judges it.
    Certificate,
}

impl Plane {
    /// The numbers of a scene that an axis may go along.
    pub fn choice(scene: &Scene) -> Vec<Parameter> {
        let (profile, is_wall) = (scene.environment.profile(), is_family(scene));
        let has = |parameter: &Parameter| match parameter {
            Parameter::Stiffness | Parameter::Damping => is_wall,
            // A filter without damping filters nothing, and a sum's keys have other names.
            Parameter::Filter if profile.is_some() => false,
            Parameter::Count => profile.is_some_and(|p| p.outline().wraps),
            _ => scene.get(*parameter).is_some(),
        };
        CHOICE.into_iter().filter(has).collect()
    }

    /// The two that say most about a scene.
    pub fn usual_axes(scene: &Scene) -> [Parameter; 2] {
        const ORDER: [Parameter; 9] = [
            Parameter::Stiffness,
            Parameter::Damping,
            Parameter::Count,
            Parameter::ProfileTorque,
            Parameter::Residual,
            Parameter::StatedIndex,
            Parameter::Period,
            Parameter::CouplingStiffness,
            Parameter::OutputDelay,
        ];
        let choice = Self::choice(scene);
        let mut best = ORDER.into_iter().filter(|parameter| choice.contains(parameter));
        // Every scene has a period and an output delay.
        let first = best.next().unwrap_or(Parameter::Period);
        [first, best.next().unwrap_or(Parameter::OutputDelay)]
    }

    /// The scenes of a file along two axes, the horizontal one first.
    ///
    /// # Errors
    /// Where the scene has no such numbers, or the device's motion is beyond the range of numbers.
    pub fn of(file: &SceneFile, axes: [Parameter; 2]) -> Result<Self, MapError> {
        let choice = Self::choice(&file.scene);
        if let Some(&parameter) = axes.iter().find(|axis| !choice.contains(axis)) {
            let keys: Vec<_> = choice.iter().map(|parameter| parameter.key()).collect();
            let (scene, choice) = (file.name.clone(), keys.join(", "));
            return Err(MapError::NoSuchNumber { scene, parameter, choice });
        }
        if axes[0] == axes[1] {
            return Err(MapError::Twice { scene: file.name.clone(), parameter: axes[0] });
        }
        let alone = Experiment { plant: Plant::of(&file.chain), ..Experiment::at_rest(file) };
        let of_loop = |axis: &Parameter| {
            matches!(
                axis,
                Parameter::Period
                    | Parameter::OutputDelay
                    | Parameter::ActuatorLag
                    | Parameter::SensorLag
            )
        };
        let judge = if axes == [Parameter::Stiffness, Parameter::Damping] {
            Judge::Walls(Box::new(Family::of(file)?))
        } else if transfers(&file.scene).is_err() {
            Judge::Certificate
        } else if of_loop(&axes[0]) {
            Judge::PlantOfMember
        } else if of_loop(&axes[1]) {
            Judge::PlantOfRow
        } else {
            Judge::OnePlant(SampledPlant::new(&alone.tick(Integration::default())?))
        };
        Ok(Self { axes, alone, judge })
    }

    /// Its axes, the horizontal one first.
    pub fn axes(&self) -> [Parameter; 2] {
        self.axes
    }

    /// Whether a region states the stability of the scene without a hand, beside its certificate.
    pub fn says_stability(&self) -> bool {
        !matches!(self.judge, Judge::Certificate)
    }

    /// The scene's own two numbers.
    pub fn own(&self) -> [f64; 2] {
        self.axes.map(|axis| own_number(&self.alone.scene, axis))
    }

    /// The scene with other numbers along the axes; `None` where it can have no such numbers.
    pub fn member(&self, x: f64, y: f64) -> Option<Scene> {
        if let Judge::Walls(family) = &self.judge {
            return Some(family.member(x, y));
        }
        let [along, up] = self.axes;
        let [x, y] = [nearest(along, x), nearest(up, y)];
        if !along.range().admits(x) || !up.range().admits(y) {
            return None;
        }
        self.alone.scene.with(along, x)?.with(up, y)
    }

    /// The members with one number on the vertical axis.
    pub fn row(&self, y: f64) -> Row<'_> {
        let mut row = Row { plane: self, y, plant: None, kept: None };
        let scene = || self.alone.scene.with(self.axes[1], nearest(self.axes[1], y));
        match &self.judge {
            Judge::OnePlant(plant) => {
                row.plant = Some(Cow::Borrowed(plant));
                row.kept = scene().and_then(|scene| kept(&scene));
            }
            Judge::PlantOfRow => {
                row.plant = scene().and_then(|scene| self.plant_of(scene)).map(Cow::Owned);
                row.kept = scene().and_then(|scene| kept(&scene));
            }
            Judge::Walls(_) | Judge::PlantOfMember | Judge::Certificate => {}
        }
        row
    }

    /// The device over a tick of a scene; `None` where its motion is beyond the range of numbers.
    fn plant_of(&self, scene: Scene) -> Option<SampledPlant> {
        let experiment = Experiment { scene, ..self.alone.clone() };
        Some(SampledPlant::new(&experiment.tick(Integration::default()).ok()?))
    }

    /// Ranges of the two axes that show the borders around the scene.
    pub fn usual_ranges(&self) -> [Range<f64>; 2] {
        let usual = match &self.judge {
            Judge::Walls(family) => family.usual_ranges().into(),
            _ => self.axes.map(|axis| usual_range(&self.alone.scene, axis)),
        };
        let mut own = self.own().into_iter();
        usual.map(|range| with_room(range, own.next().unwrap_or(0.0)))
    }
}

/// The members with one number on the vertical axis, with the plant and the responses that they share.
#[derive(Clone, Debug)]
pub struct Row<'a> {
    plane: &'a Plane,
    y: f64,
    plant: Option<Cow<'a, SampledPlant>>,
    kept: Option<Kept>,
}

impl Row<'_> {
    /// The verdict on a member; an invalid member is rejected.
    pub fn region(&self, x: f64) -> Region {
        let plane = self.plane;
        if let Judge::Walls(family) = &plane.judge {
            return family.region(x, self.y);
        }
        let Some(scene) = plane.member(x, self.y) else { return Region::Rejected };
        let is_stable = match (&plane.judge, &self.plant) {
            (Judge::Certificate, _) => return by_certificate(&scene),
            (_, Some(plant)) => plant.comes_to_rest_under(&scene),
            (Judge::PlantOfMember, None) => match plane.plant_of(scene) {
                Some(plant) => plant.comes_to_rest_under(&scene),
                None => return Region::Rejected,
            },
            (_, None) => return Region::Rejected,
        };
        let (is_stable, may_be_wrong) = (is_stable.unwrap_or(false), plane.alone.latency > 0.0);
        judged(&scene, self.kept.as_ref(), is_stable, may_be_wrong)
    }
}

/// The certificate's verdict on a scene that may have no transfer function.
fn by_certificate(scene: &Scene) -> Region {
    let assessment = assess(scene);
    match assessment.outcome {
        Ok(()) if assessment.paper == haptic_servo::certificate::RuleAnswer::Pass => Region::Paper,
        Ok(()) => Region::Exact,
        Err(rejection) if rejection.is_undecided() => Region::Undecided,
        Err(_) => Region::Rejected,
    }
}

/// The nearest value that a number may have: a turn has a whole number of repetitions.
pub fn nearest(axis: Parameter, value: f64) -> f64 {
    if axis == Parameter::Count { value.round().max(1.0) } else { value }
}

/// Whether the scene is a wall of the family that differs in stiffness and damping.
fn is_family(scene: &Scene) -> bool {
    scene.environment.wall().is_some() && scene.environment.profile().is_none()
}

fn own_number(scene: &Scene, axis: Parameter) -> f64 {
    match (axis, scene.environment.wall().filter(|_| is_family(scene))) {
        (Parameter::Stiffness, Some(wall)) => wall.stiffness,
        (Parameter::Damping, Some(wall)) => wall.damping(),
        _ => scene.get(axis).unwrap_or(0.0),
    }
}

/// From 0 or a little more to a multiple of the scene's own number, or to a usual number if that is zero.
fn usual_range(scene: &Scene, axis: Parameter) -> Range<f64> {
    let own = own_number(scene, axis);
    let delta = assess(scene).delta.midpoint();
    let to = |usual: f64| if own > 0.0 { BEYOND * own } else { usual };
    match axis {
        Parameter::Period => SHORTEST * own..BEYOND * own,
        Parameter::Stiffness | Parameter::CouplingStiffness => {
            0.0..to(2.0 * delta / scene.timing.period)
        }
        Parameter::Damping => -0.6 * delta..1.25 * delta,
        Parameter::Residual => -0.25 * delta..1.5 * delta,
        Parameter::Filter => 0.0..1.0,
        Parameter::Count => 0.0..(BEYOND * own).max(8.0).ceil(),
        Parameter::ProfileTorque => match largest(scene, Quantity::Torque, &Terms::KEPT) {
            // About twice the certified torque.
            DesignLimit::Limit(torque, _) => 0.0..2.0 * torque.max(own),
            _ => 0.0..to(1.0),
        },
        Parameter::StatedIndex | Parameter::StatedGain => 0.0..to(2.0 * delta),
        Parameter::OutputDelay | Parameter::ActuatorLag | Parameter::SensorLag => {
            0.0..to(scene.timing.period)
        }
        _ => 0.0..to(1.0),
    }
}

/// A range that is extended until a value is well inside of it.
fn with_room(range: Range<f64>, value: f64) -> Range<f64> {
    /// Fraction of the range beyond the value.
    const ROOM: f64 = 0.15;
    if !value.is_finite() {
        return range;
    }
    let (mut start, mut end) = (range.start, range.end);
    if value >= end - 0.05 * (end - start) {
        end = value + ROOM * (value - start).abs().max(end - start);
    }
    if value < start {
        start = value - ROOM * (end - value);
    }
    start..end
}

/// The number of a key such as `environment.stiffness`; `None` where an axis cannot go along it.
pub fn parameter_of(key: &str) -> Option<Parameter> {
    CHOICE.into_iter().find(|parameter| parameter.key() == key)
}
