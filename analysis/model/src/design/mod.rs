//! The design procedure of theory, section 6, in its three directions: the environments that a device can
//! render, the device that a class of environments needs, and the longest period.
//!
//! The certificate itself judges each value, of a board or of the scene alone. The answer is the last value
//! that passes, exactly or in three digits on the side that passes, and comes with scenes that certify.

mod detents;
mod edge;
mod judge;
mod quantity;
pub mod stiffest;

use haptic_servo::environment::MAX_DELAY;
use haptic_servo::scene::{Coupling, Scene, TimeRange};

use crate::chain::Chain;
use crate::chip_on_board::{ChipOnBoard, with_age};
use crate::file::SceneFile;

pub use detents::NoDetents;
pub use judge::{Judge, board_refusal};
pub use quantity::{Quantity, SAMPLES};

use edge::{Edge, edge, inward};

/// The conditions of a design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// Fraction of the device's passivity that is used, greater than 0 and at most 1.
    pub safety: f64,
    /// The coupling of device and environment.
    pub coupling: Choice,
    /// The judge of each value.
    pub judge: Judge,
    /// Whether the answer and the standard coupling have all their digits, or three, on the side that passes.
    pub exact: bool,
    /// Torque in N m of the DAC's full scale, which no torque exceeds.
    pub full_scale: Option<f64>,
}

impl Terms {
    /// The certificate alone, of the scene's own coupling.
    pub const KEPT: Self = Self {
        safety: 1.0,
        coupling: Choice::Kept,
        judge: Judge::Certificate,
        exact: true,
        full_scale: None,
    };
}

impl Default for Terms {
    fn default() -> Self {
        Self { coupling: Choice::Standard, ..Self::KEPT }
    }
}

/// The coupling of a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The standard coupling, `2 delta / T` with the longest period. Where torques lag there is no standard
    /// spring, and the scene's coupling is kept. A matched coupling is kept, too.
    Standard,
    /// The coupling of the scene.
    Kept,
}

/// The limit of a number.
#[derive(Clone, Debug, PartialEq)]
pub enum DesignLimit<T> {
    /// The last value that passes, and the scene, or the scenes, with it, which certify.
    Limit(f64, T),
    /// There is no limit. The scene, or the scenes, are unchanged if they certify.
    Unlimited(T),
    /// No value passes.
    Nothing,
    /// The environment has no such number.
    NoSuchNumber,
}

impl<T> DesignLimit<T> {
    /// The limit if there is one, and the scene or the scenes if they certify.
    pub const fn value_and_result(&self) -> (Option<f64>, Option<&T>) {
        match self {
            Self::Limit(value, found) => (Some(*value), Some(found)),
            Self::Unlimited(found) => (None, Some(found)),
            Self::Nothing | Self::NoSuchNumber => (None, None),
        }
    }

    /// The same limit with another form of its scenes.
    pub fn map<U>(self, form: impl FnOnce(T) -> U) -> DesignLimit<U> {
        match self {
            Self::Limit(value, found) => DesignLimit::Limit(value, form(found)),
            Self::Unlimited(found) => DesignLimit::Unlimited(form(found)),
            Self::Nothing => DesignLimit::Nothing,
            Self::NoSuchNumber => DesignLimit::NoSuchNumber,
        }
    }
}

/// The scene as it is judged: with the used fraction of its passivity, and with the coupling of the design.
pub fn prepared(scene: &Scene, terms: &Terms) -> Scene {
    let mut scene = *scene;
    let delta = terms.safety * scene.device.passivity.unwrap_or(scene.device.damping);
    if terms.safety != 1.0 {
        scene.device.passivity = Some(delta);
    }
    let is_prompt = scene.latency.is_none() && scene.latency.encoder.is_ideal();
    let has_standard = is_prompt && scene.coupling != Coupling::Matched;
    if terms.coupling == Choice::Standard && has_standard {
        let longest = scene.timing.worst_period.unwrap_or(scene.timing.period);
        let stiffness = 2.0 * delta / longest;
        let rounded = if terms.exact { None } else { inward(stiffness, 2.0).next() };
        scene.coupling = Coupling::Spring { stiffness: rounded.unwrap_or(stiffness) };
    }
    scene
}

impl Terms {
    fn all_pass(&self, files: &[SceneFile]) -> bool {
        files.iter().all(|file| self.judge.passes(&file.scene))
    }

    /// The limit at an edge, with all that goes with it as `at` gives it: the exact one, or the nearest of
    /// three digits with which that passes.
    fn rounded<T>(
        &self,
        edge: f64,
        outward: f64,
        at: impl Fn(f64) -> T,
        passes: impl Fn(&T) -> bool,
    ) -> DesignLimit<T> {
        let short = if self.exact { None } else { Some(inward(edge, outward)) };
        let found = short.into_iter().flatten().map(|value| (value, at(value)));
        let passing = found.into_iter().find(|(_, found)| passes(found));
        let (value, found) = passing.unwrap_or_else(|| (edge, at(edge)));
        DesignLimit::Limit(value, found)
    }
}

/// The largest value of a quantity that certifies, everything else as in the scene.
pub fn largest(scene: &Scene, quantity: Quantity, terms: &Terms) -> DesignLimit<Scene> {
    let scene = prepared(scene, terms);
    if quantity.set(&scene, 0.0).is_none() {
        return DesignLimit::NoSuchNumber;
    }
    let possible = |value| terms.judge.possible(quantity, value);
    let at = |value: f64| quantity.set(&scene, possible(value)).unwrap_or(scene);
    let passes = |scene: &Scene| terms.judge.passes(scene);
    if quantity == Quantity::Delay {
        let longest = (0..=MAX_DELAY).rev().map(|delay| delay as f64).find(|&d| passes(&at(d)));
        return longest.map_or(DesignLimit::Nothing, |delay| DesignLimit::Limit(delay, at(delay)));
    }
    if quantity == Quantity::Count {
        return most_repetitions(|count| passes(&at(f64::from(count))))
            .map_or(DesignLimit::Nothing, |count| {
                DesignLimit::Limit(f64::from(count), at(f64::from(count)))
            });
    }
    let largest = quantity.largest(scene.timing.period, terms.full_scale);
    if let Some(largest) = largest.filter(|&largest| passes(&at(largest))) {
        return DesignLimit::Limit(largest, at(largest));
    }
    let damping = scene.device.damping.max(f64::MIN_POSITIVE);
    let start = match quantity {
        Quantity::Stiffness => damping / scene.timing.period,
        Quantity::ActuatorLag | Quantity::OutputDelay => scene.timing.period,
        _ => damping,
    };
    match edge(|value| passes(&at(value)), start, 2.0, 0.0) {
        Edge::At(value) => match terms.rounded(value, 2.0, at, passes) {
            DesignLimit::Limit(value, found) => {
                DesignLimit::Limit(quantity.reached(&found, possible(value)), found)
            }
            other => other,
        },
        Edge::Always if passes(&scene) => DesignLimit::Unlimited(scene),
        Edge::Always => DesignLimit::Unlimited(at(start)),
        Edge::Never if passes(&at(0.0)) => DesignLimit::Limit(0.0, at(0.0)),
        Edge::Never => DesignLimit::Nothing,
    }
}

/// The largest number of repetitions in a turn that passes: with fewer of them a profile is less steep.
fn most_repetitions(passes: impl Fn(u32) -> bool) -> Option<u32> {
    let (mut inside, mut outside) = (1, 2);
    if !passes(inside) {
        return None;
    }
    // A table has so many cells in a turn that this ends long before.
    while passes(outside) && outside < 1 << 30 {
        (inside, outside) = (outside, 2 * outside);
    }
    while outside - inside > 1 {
        let middle = inside + (outside - inside) / 2;
        if passes(middle) { inside = middle } else { outside = middle }
    }
    Some(inside)
}

/// The border of the certified region of two quantities: the largest value of the second at evenly spaced
/// values of the first, from its least to its largest. Empty where there is no border.
pub fn border(
    scene: &Scene,
    [first, second]: [Quantity; 2],
    points: usize,
    terms: &Terms,
) -> Vec<(f64, f64)> {
    let prepared = prepared(scene, terms);
    let kept = Terms { safety: 1.0, coupling: Choice::Kept, ..*terms };
    let without = second.set(&prepared, second.least()).unwrap_or(prepared);
    let DesignLimit::Limit(most, _) = largest(&without, first, &kept) else { return Vec::new() };
    let least = first.least();
    let value = |index: usize| match first {
        Quantity::Delay => index as f64,
        _ => least + (most - least) * index as f64 / points.saturating_sub(1).max(1) as f64,
    };
    // A range may have fewer whole numbers than points.
    let value = |index: usize| if first.is_whole() { value(index).round() } else { value(index) };
    let count = if first == Quantity::Delay { most as usize + 1 } else { points };
    let point = |value: f64| {
        let scene = first.set(&prepared, value)?;
        match largest(&scene, second, &kept) {
            DesignLimit::Limit(limit, _) => Some((value, limit)),
            _ => None,
        }
    };
    let mut values: Vec<f64> = (0..count).map(value).collect();
    values.dedup();
    values.into_iter().filter_map(point).collect()
}

/// The least damping in N m s/rad of the motor's mass with which all of these environments certify, with the
/// standard coupling of that device. The rest of a chain stays unchanged; a rigid device consists of its
/// motor's mass alone. The damping that a free mode cancels grows with that of the device. A declared
/// passivity is not used: it belongs to another device.
pub fn device(files: &[SceneFile], terms: &Terms) -> DesignLimit<Vec<SceneFile>> {
    let terms = Terms { coupling: Choice::Standard, ..*terms };
    let on = |file: &SceneFile, damping: f64| -> Option<(Chain, Scene)> {
        let chain = file.chain.clone().with_motor_damping(damping).ok()?;
        let device = chain.as_rigid().ok()?;
        Some((chain, prepared(&Scene { device, ..file.scene }, &terms)))
    };
    let fits = |damping: f64| {
        let passes = |(_, scene)| terms.judge.passes(&scene);
        files.iter().all(|file| on(file, damping).is_some_and(passes))
    };
    let at = |damping: f64| -> Vec<SceneFile> {
        let with = |file: &SceneFile| {
            let (chain, scene) = on(file, damping)?;
            Some(SceneFile { chain, scene, ..file.clone() })
        };
        files.iter().filter_map(with).collect()
    };
    let most = files.iter().map(|file| file.scene.device.damping).fold(0.0, f64::max);
    // No device states a damping: the search starts at 1 N m s/rad.
    let start = if most > 0.0 { most } else { 1.0 };
    match edge(fits, start, 0.5, 0.0) {
        Edge::At(value) => terms.rounded(value, 0.5, at, |found| terms.all_pass(found)),
        // The rest of the chain is enough.
        Edge::Always if fits(0.0) => DesignLimit::Limit(0.0, at(0.0)),
        Edge::Always => DesignLimit::Unlimited(at(start)),
        Edge::Never => DesignLimit::Nothing,
    }
}

/// The longest period in s with which all of these environments certify on their devices. A tolerated longest
/// period and a simulation's latency grow with it. Each law stays as its scene has it, so a rational law
/// keeps its coefficients at every period.
pub fn period(files: &[SceneFile], terms: &Terms) -> DesignLimit<Vec<SceneFile>> {
    let start = files.iter().map(|file| file.scene.timing.period).fold(f64::INFINITY, f64::min);
    timed(files, terms, start, 2.0, |period| period)
}

/// The lowest sample rate in Hz, the inverse of [`period`]. All of these scenes certify at this rate itself,
/// and not only at the period that it is rounded from.
pub fn rate(files: &[SceneFile], terms: &Terms) -> DesignLimit<Vec<SceneFile>> {
    let rates = files.iter().map(|file| file.scene.timing.period.recip());
    timed(files, terms, rates.fold(0.0, f64::max), 0.5, f64::recip)
}

/// The scene at another period in s, with the same number of missed updates, as many updates of the amplifier in a
/// period, and the age that the chip of its encoder has there.
fn at_period(of: &Scene, chip: Option<ChipOnBoard>, period: f64) -> Scene {
    let (mut scene, before) = (*of, of.timing.period);
    let worst = scene.timing.worst_period.map(|worst| worst / before);
    scene.timing.period = period;
    scene.timing.worst_period = worst.map(|ratio| (ratio * period).max(period));
    if scene.latency.actuator_updates > 0 {
        let update = scene.latency.nearest_update(before);
        let delay = scene.latency.delay_at_update(update, period);
        let age = scene.latency.encoder.age.middle();
        scene.latency.output_delay = TimeRange::exactly(delay + age);
    }
    if let Some(chip) = chip {
        scene.latency = with_age(&scene.latency, chip.age_in(of, &scene));
    }
    scene
}

/// The last number, outward from `start` by factors, whose period certifies all of these scenes.
fn timed(
    files: &[SceneFile],
    terms: &Terms,
    start: f64,
    outward: f64,
    period_of: fn(f64) -> f64,
) -> DesignLimit<Vec<SceneFile>> {
    let with = |file: &SceneFile, period: f64| {
        prepared(&at_period(&file.scene, file.chip_on_board(), period), terms)
    };
    let passes = |scene: &Scene| terms.judge.passes(scene);
    let fits = |number: f64| files.iter().all(|file| passes(&with(file, period_of(number))));
    let at = |number: f64| -> Vec<SceneFile> {
        let period = period_of(number);
        let timed = |file: &SceneFile| {
            let mut timed = SceneFile { scene: with(file, period), ..file.clone() };
            if let Some(simulation) = &mut timed.simulation {
                simulation.latency *= period / file.scene.timing.period;
            }
            timed
        };
        files.iter().map(timed).collect()
    };
    let as_they_were = || -> Vec<SceneFile> {
        let kept =
            |file: &SceneFile| SceneFile { scene: prepared(&file.scene, terms), ..file.clone() };
        files.iter().map(kept).collect()
    };
    match edge(fits, start, outward, 0.0) {
        Edge::At(value) => terms.rounded(value, outward, at, |found| terms.all_pass(found)),
        Edge::Always if terms.all_pass(&as_they_were()) => DesignLimit::Unlimited(as_they_were()),
        Edge::Always => DesignLimit::Unlimited(at(start)),
        Edge::Never => DesignLimit::Nothing,
    }
}

#[cfg(test)]
mod tests;
