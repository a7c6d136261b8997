//! The design procedure of theory, section 6, in its three directions: what may be rendered on a
//! device, what device a class of environments needs, and how long the period may be.
//!
//! The certificate itself is asked, and the answer is the last value that it passes: the value's
//! neighbour among the numbers of `f64` is refused. So every answer is exact and comes as scenes
//! that certify.

use firmware::certificate::Posed;
use firmware::environment::{Environment, MAX_DELAY, Wall};
use firmware::scene::{Coupling, Scene};

/// What a design takes for granted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// Part of the device's passivity that is counted on, greater than 0 and at most 1.
    pub safety: f64,
    /// What couples device and environment.
    pub coupling: Choice,
}

impl Default for Terms {
    fn default() -> Self {
        Self { safety: 1.0, coupling: Choice::Standard }
    }
}

/// The coupling of a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The standard one, `2 delta / T` with the longest period.
    Standard,
    /// Whatever the scene has.
    Kept,
}

/// A number of the environment that a design can take as far as it goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Quantity {
    /// Stiffness in N m/rad.
    Stiffness,
    /// Damping in N m s/rad.
    Damping,
    /// Delay in samples.
    Delay,
    /// Cancellation: the damping in N m s/rad that free mode takes away.
    Cancellation,
}

impl Quantity {
    /// Name and unit.
    pub fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::Stiffness => ("stiffness", "N m/rad"),
            Self::Damping => ("damping", "N m s/rad"),
            Self::Delay => ("delay", "samples"),
            Self::Cancellation => ("cancellation", "N m s/rad"),
        }
    }

    /// The scene with this much of it; `None` where its environment has no such number.
    fn set(self, scene: &Scene, value: f64) -> Option<Scene> {
        let mut changed = *scene;
        match (self, &mut changed.environment) {
            (Self::Cancellation, Environment::FreeMode { residual, .. })
            | (Self::Cancellation, Environment::FreeModeWall { residual, .. }) => {
                *residual = scene.device.damping - value;
            }
            (Self::Delay, Environment::FreeMode { delay, .. }) => *delay = value as usize,
            (Self::Delay, Environment::Rational(rational)) => rational.delay = value as usize,
            (_, environment) => self.set_wall(wall_of(environment)?, value)?,
        }
        Some(changed)
    }

    fn set_wall(self, wall: &mut Wall, value: f64) -> Option<()> {
        match self {
            Self::Stiffness => wall.stiffness = value,
            Self::Damping => wall.damping = value,
            Self::Delay => wall.delay = value as usize,
            Self::Cancellation => return None,
        }
        Some(())
    }
}

fn wall_of(environment: &mut Environment) -> Option<&mut Wall> {
    match environment {
        Environment::DelayedSpring(wall)
        | Environment::DamperWall(wall)
        | Environment::FreeModeWall { wall, .. } => Some(wall),
        Environment::FreeMode { .. } | Environment::Rational(_) => None,
    }
}

/// How far a number goes.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer<T> {
    /// To this value and no further; with it the scene, or the scenes, that certify.
    Limit(f64, T),
    /// As far as one likes.
    Unlimited,
    /// No value passes.
    Nothing,
    /// The environment has no such number.
    NoSuchNumber,
}

/// The scene as it is judged: with the part of its passivity that is counted on and its coupling.
pub fn prepared(scene: &Scene, terms: &Terms) -> Scene {
    let mut scene = *scene;
    let delta = terms.safety * scene.device.passivity.unwrap_or(scene.device.damping);
    if terms.safety != 1.0 {
        scene.device.passivity = Some(delta);
    }
    if terms.coupling == Choice::Standard {
        let longest = scene.timing.worst_period.unwrap_or(scene.timing.period);
        scene.coupling = Coupling::Spring { stiffness: 2.0 * delta / longest };
    }
    scene
}

fn passes(scene: &Scene) -> bool {
    Posed::of(scene).is_ok_and(|posed| posed.is_certified())
}

/// The most of a quantity that may be rendered, everything else as in the scene.
pub fn largest(scene: &Scene, quantity: Quantity, terms: &Terms) -> Answer<Scene> {
    let scene = prepared(scene, terms);
    if quantity.set(&scene, 0.0).is_none() {
        return Answer::NoSuchNumber;
    }
    let at = |value: f64| quantity.set(&scene, value).unwrap_or(scene);
    if quantity == Quantity::Delay {
        let longest = (0..=MAX_DELAY).rev().map(|delay| delay as f64).find(|&d| passes(&at(d)));
        return longest.map_or(Answer::Nothing, |delay| Answer::Limit(delay, at(delay)));
    }
    let damping = scene.device.damping.max(f64::MIN_POSITIVE);
    let start = match quantity {
        Quantity::Stiffness => damping / scene.timing.period,
        _ => damping,
    };
    match edge(|value| passes(&at(value)), start, 2.0) {
        Edge::At(value) => Answer::Limit(value, at(value)),
        Edge::Always => Answer::Unlimited,
        Edge::Never if passes(&at(0.0)) => Answer::Limit(0.0, at(0.0)),
        Edge::Never => Answer::Nothing,
    }
}

/// The border of what may be rendered of two quantities at once: the most of the second at evenly
/// spaced values of the first, from none of it to the most. Empty where there is no border.
pub fn border(
    scene: &Scene,
    [first, second]: [Quantity; 2],
    points: usize,
    terms: &Terms,
) -> Vec<(f64, f64)> {
    let prepared = prepared(scene, terms);
    let kept = Terms { safety: 1.0, coupling: Choice::Kept };
    let without = second.set(&prepared, 0.0).unwrap_or(prepared);
    let Answer::Limit(most, _) = largest(&without, first, &kept) else { return Vec::new() };
    let value = |index: usize| match first {
        Quantity::Delay => index as f64,
        _ => most * index as f64 / points.saturating_sub(1).max(1) as f64,
    };
    let count = if first == Quantity::Delay { most as usize + 1 } else { points };
    let point = |value: f64| {
        let scene = first.set(&prepared, value)?;
        match largest(&scene, second, &kept) {
            Answer::Limit(limit, _) => Some((value, limit)),
            _ => None,
        }
    };
    (0..count).filter_map(|index| point(value(index))).collect()
}

/// The least damping in N m s/rad that a device needs for all of these environments, with the
/// standard coupling that goes with it. What a free mode cancels grows with the damping.
pub fn device(scenes: &[Scene], terms: &Terms) -> Answer<Vec<Scene>> {
    let terms = Terms { coupling: Choice::Standard, ..*terms };
    let at = |damping: f64| -> Vec<Scene> {
        let with = |scene: &Scene| {
            let mut scene = *scene;
            (scene.device.damping, scene.device.passivity) = (damping, None);
            prepared(&scene, &terms)
        };
        scenes.iter().map(with).collect()
    };
    let start = scenes.iter().map(|scene| scene.device.damping).fold(f64::MIN_POSITIVE, f64::max);
    answer(edge(|damping| at(damping).iter().all(passes), start, 0.5), at)
}

/// The longest period in s with which all of these environments may be rendered on their devices;
/// a longest period that is tolerated grows with it. The law of each is as its scene has it, so a
/// rational one keeps its coefficients whatever the period.
pub fn period(scenes: &[Scene], terms: &Terms) -> Answer<Vec<Scene>> {
    let at = |period: f64| -> Vec<Scene> {
        let with = |scene: &Scene| {
            let mut scene = *scene;
            let worst = scene.timing.worst_period.map(|worst| worst / scene.timing.period);
            scene.timing.period = period;
            scene.timing.worst_period = worst.map(|ratio| ratio * period);
            prepared(&scene, terms)
        };
        scenes.iter().map(with).collect()
    };
    let start = scenes.iter().map(|scene| scene.timing.period).fold(f64::INFINITY, f64::min);
    answer(edge(|period| at(period).iter().all(passes), start, 2.0), at)
}

fn answer(edge: Edge, at: impl Fn(f64) -> Vec<Scene>) -> Answer<Vec<Scene>> {
    match edge {
        Edge::At(value) => Answer::Limit(value, at(value)),
        Edge::Always => Answer::Unlimited,
        Edge::Never => Answer::Nothing,
    }
}

/// Where something ceases to pass.
enum Edge {
    At(f64),
    Always,
    Never,
}

/// Looks for the last value that passes in the direction of `outward`, a factor; values the other
/// way pass all the more.
fn edge(passes: impl Fn(f64) -> bool, start: f64, outward: f64) -> Edge {
    /// Octaves in each direction: more than any two numbers of one machine are apart.
    const OCTAVES: usize = 60;
    let (mut inside, mut outside) = (start, start);
    let mut octaves = 0;
    while !passes(inside) {
        (outside, inside) = (inside, inside / outward);
        octaves += 1;
        if octaves > OCTAVES {
            return Edge::Never;
        }
    }
    octaves = 0;
    while inside == outside || passes(outside) {
        (inside, outside) = (outside, outside * outward);
        octaves += 1;
        if octaves > OCTAVES {
            return Edge::Always;
        }
    }
    loop {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            return Edge::At(inside);
        }
        if passes(middle) { inside = middle } else { outside = middle }
    }
}

#[cfg(test)]
mod tests;
