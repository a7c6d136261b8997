//! Random scenes of every kind, each taken to just inside acceptance.

use std::f64::consts::TAU;

use haptic_servo::certificate::{PassivityProblem, TimingError, assess_in};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::{
    Canceller, Coefficients, Damper, Drag, Environment, Parts, Rational, Side, Wall,
};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{Latched, RenderingOptions, Transducers};
use rand::Rng;
use tests::scenes::{log_uniform, multiply, polynomial};

use crate::mode::{Actual, draw_latency, has_latency, plain, read};
use crate::planted::Planted;
use crate::profiles;

pub use crate::mode::Mode;

/// Number format of the servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// `f32`.
    F32,
    /// `f64`.
    F64,
    /// `I8F24`.
    Q24,
    /// `I12F20`.
    Q20,
}

impl Numbers {
    /// The same as the certificate has it.
    pub const fn format(self) -> Format {
        match self {
            Self::F32 => Format::F32,
            Self::F64 => Format::F64,
            Self::Q24 => Format::Fixed { fraction_bits: 24 },
            Self::Q20 => Format::Fixed { fraction_bits: 20 },
        }
    }

    /// Largest angle in rad, or a large angle for the scene.
    const fn reach(self) -> f64 {
        match self {
            Self::F32 | Self::F64 => 1e3,
            Self::Q24 => 128.0,
            Self::Q20 => 2048.0,
        }
    }
}

/// The drawn kind of scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A spring or a wall.
    Wall,
    /// Free mode.
    FreeMode,
    /// Free mode that ends at a wall.
    FreeModeWall,
    /// A rational environment with its poles inside of the circle.
    Rational,
    /// A rational environment that need not be stable by itself.
    Unstable,
    /// A rational environment whose numerator and denominator have factors on the circle in common.
    Hidden,
    /// A wall on a device whose passivity is declared to be more than its damping.
    Overstated,
    /// A torque profile: with ends and without, with snap points, a mode of a knob.
    Profile,
    /// A sum of a profile with a wall, a canceller, or both.
    Sum,
    /// What some rule is sharp for: a spring, a negative damper or a filter alone, and a delay alone with jitter.
    Sharp,
}

/// What a search may draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// One kind only.
    pub kind: Option<Kind>,
    /// Whether all, none or some scenes have a worst period.
    pub worst_period: Option<bool>,
    /// Whether all, none or some scenes have a latency.
    pub latency: Option<bool>,
    /// Whether all, none or some scenes run by the servo alone.
    pub bare: Option<bool>,
    /// A wrong rule that scenes are accepted by.
    pub planted: Option<Planted>,
    /// The damping of the device, over the least with which the scene's controller as it is would
    /// be certified; only linear scenes are drawn then.
    pub weakened: Option<f64>,
}

impl Choice {
    /// Anything.
    pub const ANY: Self = Self {
        kind: None,
        worst_period: None,
        latency: None,
        bare: None,
        planted: None,
        weakened: None,
    };
}

/// The number of a scene that is taken to the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Knob {
    Gain,
    Damping,
    Residual,
    Coupling,
    /// Its inverse, of the device's damping and the coupling.
    Device,
}

/// A scene with all that it runs with.
#[derive(Clone, Debug)]
pub struct RandomScene {
    /// What was drawn.
    pub kind: Kind,
    /// The scene.
    pub scene: Scene,
    /// Another set of it, to be swapped in.
    pub other: Option<Scene>,
    /// What the scene is to the certificate, where that cancels factors.
    pub judged_as: Option<Scene>,
    /// Sensor and motor.
    pub transducers: Transducers,
    /// How it is rendered.
    pub rendering: RenderingOptions,
    /// Number format.
    pub format: Numbers,
    /// What runs it.
    pub mode: Mode,
    /// How that differs from what the scene states.
    pub actual: Actual,
    /// Angles in rad at which the runs are large.
    pub size: f64,
    /// The farthest place to arm at, in rad.
    pub reach: f64,
    /// The damping of the device in N m s/rad where it is another.
    pub damping: Option<f64>,
    /// Injected damping over the room that there is for it.
    pub injected: Option<f64>,
}

impl RandomScene {
    /// A scene with sensor and motor so fine that they hardly matter, at angles of about `size` rad.
    pub fn of(kind: Kind, scene: Scene, format: Numbers, mode: Mode, size: f64) -> Self {
        let unit = scene.device.damping / scene.timing.period;
        let transducers = Transducers {
            counts_per_turn: f64::from(1_u32 << 22),
            counter: CounterWidth::Bits32,
            full_scale_torque: scene.torque_limit.unwrap_or(0.0).max(4.0 * unit * size),
            largest_speed: 100.0 * size / scene.timing.period,
        };
        Self {
            kind,
            scene,
            other: None,
            judged_as: None,
            transducers,
            rendering: RenderingOptions {
                fade: 50.0 * scene.timing.period,
                injection: None,
                ..RenderingOptions::DEFAULT
            },
            format,
            mode,
            actual: Actual::default(),
            size,
            reach: size,
            damping: None,
            injected: None,
        }
    }

    /// Whether it has more than the errors of scenes without latency are known for.
    pub fn is_general(&self) -> bool {
        let actual = self.actual.latency.is_some();
        let profile = self.scene.environment.profile().is_some();
        self.mode == Mode::Bare || has_latency(&self.scene) || actual || profile
    }
}

/// The least damping in N m s/rad with which a scene is certified, everything else as it runs;
/// `None` where it is not certified as it is.
pub fn least_damping(scene: &Scene, format: Format) -> Option<f64> {
    let with =
        |delta: f64| Scene { device: Device { passivity: Some(delta), ..scene.device }, ..*scene };
    let (mut fails, mut passing) = (0.0, scene.device.passivity.unwrap_or(scene.device.damping));
    if !passes(&with(passing), format) {
        return None;
    }
    while passing - fails > 1e-7 * passing {
        let middle = 0.5 * (fails + passing);
        *(if passes(&with(middle), format) { &mut passing } else { &mut fails }) = middle;
    }
    Some(passing)
}

fn sometimes(rng: &mut impl Rng, wanted: Option<bool>, probability: f64) -> bool {
    wanted.unwrap_or_else(|| rng.random_bool(probability))
}

/// The kind, the number format and the mode of a scene.
fn draw_kind(rng: &mut impl Rng, choice: &Choice) -> (Kind, Numbers, Mode, bool) {
    let kind = choice.kind.unwrap_or_else(|| match rng.random_range(0..34) {
        0..=7 => Kind::Wall,
        8..=9 => Kind::FreeMode,
        10..=11 => Kind::FreeModeWall,
        12..=15 => Kind::Rational,
        16..=17 => Kind::Unstable,
        18 => Kind::Hidden,
        19 => Kind::Overstated,
        20..=22 => Kind::Profile,
        23..=24 => Kind::Sum,
        _ => Kind::Sharp,
    });
    let format = match rng.random_range(0..10) {
        0..=4 => Numbers::F32,
        5 => Numbers::F64,
        6..=7 => Numbers::Q24,
        _ => Numbers::Q20,
    };
    let lags = !matches!(kind, Kind::Unstable | Kind::Hidden | Kind::Overstated)
        && sometimes(rng, choice.latency, if kind == Kind::Sharp { 0.9 } else { 0.5 });
    // No board renders an environment that is only certified without a torque limit.
    let rational = matches!(kind, Kind::Rational | Kind::Unstable | Kind::Hidden);
    let bare = match (rational, lags) {
        (true, _) => 0.9,
        (_, true) => {
            if kind == Kind::Sharp {
                0.9
            } else {
                0.5
            }
        }
        _ => 0.08,
    };
    if sometimes(rng, choice.bare, bare) {
        // The sums of a filter that no board renders have all of an angle times its coefficients, which a
        // fixed-point format ends at.
        let floats = matches!(format, Numbers::F32 | Numbers::F64);
        let format =
            if (rational || kind == Kind::Sharp) && !floats { Numbers::F64 } else { format };
        return (kind, format, Mode::Bare, lags);
    }
    // The canceller in front of a wall is undelayed, and so is never latched.
    let latched = rng.random_bool(0.6) && kind != Kind::FreeModeWall;
    if !lags {
        let mode = if latched { Mode::Latched } else { Mode::Simultaneous };
        return (kind, format, mode, false);
    }
    if latched && rng.random_bool(0.6) {
        return (kind, format, Mode::Latched, true);
    }
    // Boards with a phase are built in two number formats.
    let format = if rng.random_bool(0.7) { Numbers::F32 } else { Numbers::Q24 };
    let phase = Mode::PHASES[rng.random_range(0..Mode::PHASES.len())];
    (kind, format, Mode::AtPhase(phase), true)
}

/// A coupling of about the standard stiffness; behind a latency also the coupling which absorbs it.
fn draw_coupling(rng: &mut impl Rng, mode: Mode, lags: bool, standard: f64) -> Coupling {
    if lags && rng.random_bool(if mode == Mode::Bare { 0.35 } else { 0.75 }) {
        return Coupling::Matched;
    }
    if lags && mode != Mode::Bare {
        // No board renders a torque that lags behind a spring.
        return Coupling::Rigid;
    }
    let rigid = if mode == Mode::Bare { 3 } else { 2 };
    if rng.random_range(0..10) < rigid {
        return Coupling::Rigid;
    }
    if lags {
        // What a torque takes longer for has to be in the spring, too.
        let stiffness = standard / (1.0 + log_uniform(rng, 0.3, 10.0));
        return Coupling::Spring { stiffness };
    }
    Coupling::Spring {
        stiffness: match rng.random_range(1..10) {
            1..=4 => standard,
            5..=7 => standard * log_uniform(rng, 0.05, 1.0),
            _ => standard * log_uniform(rng, 1.0, 10.0),
        },
    }
}

/// Draws a scene and takes it to the line; `None` where it has none near.
pub fn draw(rng: &mut impl Rng, choice: &Choice) -> Option<RandomScene> {
    let (kind, format, mode, lags) = draw_kind(rng, choice);
    let latched = mode == Mode::Latched;
    let shortest = match mode {
        Mode::AtPhase(nanoseconds) => (f64::from(nanoseconds) / 0.9e9).max(1e-4),
        _ => 1e-4,
    };
    let period = log_uniform(rng, shortest, 4e-3);
    let delta = log_uniform(rng, 2e-3, 0.5);
    let unit = delta / period;
    let worst = if !lags && mode != Mode::Bare && sometimes(rng, choice.worst_period, 0.4) {
        [1.5, 2.0, 2.0, 3.0, 4.0][rng.random_range(0..5)]
    } else {
        1.0
    };
    let standard = 2.0 * unit / worst;
    let coupling = draw_coupling(rng, mode, lags, standard);
    let is_general = lags || mode == Mode::Bare || matches!(kind, Kind::Profile | Kind::Sum);
    let size = log_uniform(rng, if is_general { 2e-2 } else { 1e-3 }, 1.0);
    let full_scale = (unit * size * log_uniform(rng, 0.1, 10.0)).min(100.0);
    let rational = matches!(kind, Kind::Rational | Kind::Unstable | Kind::Hidden);
    let limited = rng.random_bool(match (rational, lags) {
        (true, _) => 0.1,
        (_, true) if kind != Kind::Sharp => 0.7,
        _ => 0.5,
    });
    // The servo alone is certified for torques that never saturate, or for its scene's limit.
    let unlimited = mode == Mode::Bare && !limited;
    let full_scale = match (unlimited, limited || choice.weakened.is_none()) {
        (true, _) => 40.0 * unit * size,
        (_, true) => full_scale,
        _ => 10.0 * unit * size,
    };
    let passivity = match kind {
        Kind::Overstated => Some(delta),
        _ => rng.random_bool(0.1).then_some(delta),
    };
    let damping = match (kind, passivity) {
        (Kind::Overstated, _) => delta / log_uniform(rng, 1.05, 20.0),
        (_, Some(_)) => delta * log_uniform(rng, 1.0, 3.0),
        _ => delta,
    };
    let mut scene = Scene {
        device: Device { inertia: delta * period, damping, passivity },
        timing: Timing { period, worst_period: (worst > 1.0).then_some(worst * period) },
        coupling,
        environment: Parts::NONE.sum(),
        latency: match lags {
            true if kind == Kind::Sharp && mode == Mode::Bare => {
                read(plain(rng, period), period, coupling)
            }
            true => read(draw_latency(rng, mode, period), period, coupling),
            false => Latency::NONE,
        },
        torque_limit: limited.then(|| full_scale * log_uniform(rng, 0.15, 0.999)),
    };
    let reach = match rng.random_range(0..12) {
        0 => format.reach(),
        1..=3 => 5.0 * size,
        _ => size,
    };
    let early = scene.latency.total_jitter() > scene.latency.output_delay.least;
    let least = usize::from(latched || early);
    let mut judged_as = None;
    let knob = match kind {
        Kind::Wall | Kind::Overstated => {
            let delay = if rng.random_bool(0.7) { least } else { rng.random_range(least..=3) };
            let mut wall = wall(rng, unit, delta, delay, reach);
            let is_spring = wall.damping() == 0.0;
            if is_spring && rng.random_bool(0.5) {
                wall.damper = None;
            }
            scene.environment = wall.alone();
            if !is_spring && rng.random_bool(0.5) { Knob::Damping } else { Knob::Gain }
        }
        Kind::Sharp => {
            scene.environment = sharp(rng, unit, delta, least);
            if mode == Mode::Bare && lags && scene.environment.rational().is_some() {
                scene.coupling = Coupling::Rigid;
            }
            let is_damped = scene.environment.wall().is_some_and(|wall| wall.damper.is_some());
            if is_damped { Knob::Damping } else { Knob::Gain }
        }
        Kind::FreeMode => {
            let residual = damping * rng.random_range(-0.1..1.0);
            let delay = rng.random_range(least..=2);
            scene.environment = Canceller { residual, delay }.alone();
            Knob::Residual
        }
        Kind::FreeModeWall => {
            let residual = damping * rng.random_range(0.0..1.0);
            let delay = rng.random_range(0..=2);
            let wall = Some(wall(rng, unit, delta, delay, reach));
            let canceller = Some(Canceller::to(residual));
            scene.environment = Parts { canceller, wall, ..Parts::NONE }.sum();
            if rng.random_bool(0.3) { Knob::Residual } else { Knob::Gain }
        }
        Kind::Rational | Kind::Unstable => {
            let delay = if rng.random_bool(0.6) { least } else { rng.random_range(least..=3) };
            scene.environment = rational_with(rng, unit, delay, kind == Kind::Unstable);
            Knob::Gain
        }
        Kind::Profile => {
            let delay = rng.random_range(least..=2);
            let profile = profiles::draw(rng, unit, delta, delay);
            scene.environment = profile.alone();
            if profile.modes.is_some() { Knob::Device } else { Knob::Gain }
        }
        Kind::Sum => {
            let delay = rng.random_range(1..=2);
            let profile = profiles::table(rng, 0.5 * unit, delta, delay);
            let which = if latched { 0 } else { rng.random_range(0..3) };
            let delay = rng.random_range(least..=2);
            let mut beside = wall(rng, 0.5 * unit, delta, delay, size);
            beside.damper = beside.damper.map(|damper| Damper { filter: None, ..damper });
            let residual = damping * rng.random_range(0.3..1.0);
            scene.environment = Parts {
                canceller: (which > 0).then_some(Canceller::to(residual)),
                wall: (which < 2).then_some(beside),
                profile: Some(profile),
                drag: None,
                ..Parts::NONE
            }
            .sum();
            Knob::Gain
        }
        Kind::Hidden => {
            let (hidden, plain) = hidden(rng, unit, least);
            scene.environment = hidden;
            judged_as = Some(plain);
            // Any other gain would not leave the factors exactly in common.
            Knob::Coupling
        }
    };
    if let Environment::Parts(parts) = &mut scene.environment
        && matches!(kind, Kind::Wall | Kind::FreeModeWall | Kind::Sum)
        && rng.random_bool(0.2)
    {
        let damping =
            delta * log_uniform(rng, 0.03, 0.6) * if rng.random_bool(0.7) { 1.0 } else { -1.0 };
        parts.drag = Some(Drag::of(damping, rng.random_range(least..=2)));
    }
    let knob = match scene.coupling {
        Coupling::Spring { .. } if rng.random_bool(0.15) => Knob::Coupling,
        _ => knob,
    };
    if kind == Kind::Unstable && matches!(scene.coupling, Coupling::Spring { .. }) {
        // Only a soft coupling makes a stable controller of it.
        let stiffness = standard * log_uniform(rng, 0.01, 0.7);
        scene.coupling = Coupling::Spring { stiffness };
    }
    if mode == Mode::Bare {
        // What it rests at is at rest.
        if let Some(wall) = scene.environment.wall_mut() {
            wall.side = match wall.side {
                Side::Face(face) => Side::Face(face.abs().min(0.5 * size)),
                Side::Centred | Side::Displaced(_) => Side::Centred,
            };
        }
    }
    let exponent = rng.random_range(16..=22);
    let exponent = if is_general { rng.random_range(23..=25) } else { exponent };
    let exponent =
        if !is_general && rng.random_bool(0.1) { rng.random_range(12..=22) } else { exponent };
    let (counter, half, exponent) = if !is_general && reach <= 5.0 * size && rng.random_bool(0.25) {
        // Coarse enough for so few bits to follow it.
        let most = (4e3 / size).log2().max(10.0) as u32;
        (CounterWidth::Bits16, f64::from(1_u32 << 15), exponent.min(most))
    } else {
        (CounterWidth::Bits32, f64::from(1_u32 << 31), exponent)
    };
    let counts_per_turn = f64::from(1_u32 << exponent);
    // A device that its program takes for slower than it is stops for what it takes for a jump.
    let largest_speed = if !is_general && rng.random_bool(0.1) {
        size / period * log_uniform(rng, 0.1, 3.0)
    } else {
        0.9 * half * TAU / counts_per_turn / (8.0 * period)
    };
    let transducers =
        Transducers { counts_per_turn, counter, full_scale_torque: full_scale, largest_speed };
    let fade = period * log_uniform(rng, 1.0, 200.0);
    if choice.weakened.is_some() {
        scene.torque_limit = None;
        if let Some(wall) = scene.environment.wall_mut() {
            wall.side = Side::Displaced(wall.face());
        }
    }
    let format_of = format.format();
    let taken_for = |scene: &Scene| {
        choice.planted.map_or(*scene, |planted| planted.taken_for(scene, format_of))
    };
    let accepted = |scene: &Scene| accepted(&taken_for(scene), format_of, mode);
    let scale = taken_to_the_line(&scene, knob, accepted)?;
    let actual_scene = scaled(&scene, knob, scale);
    let scene = taken_for(&actual_scene);
    let actual = choice
        .planted
        .map_or_else(Actual::default, |planted| planted.actual(&actual_scene, &scene));
    let judged_as = judged_as.map(|environment| Scene { environment, ..scene });
    let other = rng.random_bool(0.3).then(|| another(rng, &scene, size, format)).flatten();
    let damping = match choice.weakened {
        Some(share) => {
            let least = |scene: &Scene| least_damping(scene, format.format());
            Some(share * least(&scene)?.max(other.as_ref().and_then(least).unwrap_or(0.0)))
        }
        None => None,
    };
    // The room is known only once the scene is certified.
    let injected = rng.random_bool(0.15).then(|| 1.0 - log_uniform(rng, 1e-6, 0.9));
    Some(RandomScene {
        other,
        judged_as,
        transducers,
        rendering: RenderingOptions { fade, injection: None, ..RenderingOptions::DEFAULT },
        actual,
        reach,
        damping,
        injected,
        ..RandomScene::of(kind, scene, format, mode, size)
    })
}

fn wall(rng: &mut impl Rng, unit: f64, delta: f64, delay: usize, reach: f64) -> Wall {
    let stiffness = unit * log_uniform(rng, 0.01, 2.0);
    let damping = match rng.random_range(0..10) {
        0..=3 => 0.0,
        4 => -delta * log_uniform(rng, 0.01, 1.0),
        _ => delta * log_uniform(rng, 0.01, 1.0),
    };
    let filter = (damping != 0.0 && rng.random_bool(0.3)).then(|| match rng.random_range(0..4) {
        0 => 1.0 - log_uniform(rng, 1e-3, 0.1),
        _ => rng.random_range(0.0..0.95),
    });
    // The wall of a device that is far away is there, on the side that its number format has left.
    let face = match rng.random_range(0..3) {
        0 => 0.0,
        1 => 0.99 * reach * rng.random_range(-1.0..1.0),
        _ => 0.995 * reach.copysign(rng.random_range(-1.0..1.0)),
    };
    let one_sided = rng.random_bool(0.4);
    let face = if one_sided || rng.random_bool(0.5) { face } else { 0.0 };
    let side = if one_sided { Side::Face(face) } else { Side::Displaced(face) };
    Wall { stiffness, damper: Some(Damper { damping, filter }), side, delay }
}

fn coefficients(descending: &[f64]) -> Coefficients {
    Coefficients::new(descending).expect("at most eight poles are drawn")
}

fn rational_with(rng: &mut impl Rng, unit: f64, delay: usize, unstable: bool) -> Environment {
    let count = rng.random_range(1..=4);
    let denominator = polynomial(rng, count, 0.3, |rng, roots| match unstable && roots == 0 {
        true => 1.0 + log_uniform(rng, 1e-3, 0.5),
        false => 1.0 - log_uniform(rng, 3e-3, 1.0),
    });
    let count = denominator.len() - 1;
    let zeros = rng.random_range(0..=count);
    let mut numerator: Vec<f64> = (0..=zeros).map(|_| rng.random_range(-1.0..1.0)).collect();
    let sum = |c: &[f64]| c.iter().sum::<f64>();
    if unstable {
        numerator = (0..=count).map(|_| 0.3 * rng.random_range(-1.0..1.0)).collect();
        numerator[0] = 1.0;
    } else if sum(&numerator) * sum(&denominator) < 0.0 {
        numerator.iter_mut().for_each(|c| *c = -*c);
    }
    let size = numerator.iter().map(|c| c.abs()).sum::<f64>();
    numerator.iter_mut().for_each(|c| *c *= unit / size * 0.3);
    Environment::Rational(Rational {
        numerator: coefficients(&numerator),
        denominator: coefficients(&denominator),
        delay,
        unit_zeros: 0,
    })
}

/// A spring that is late by a sample, a damper below zero, or a filter.
fn sharp(rng: &mut impl Rng, unit: f64, delta: f64, least: usize) -> Environment {
    match rng.random_range(0..4) {
        0 | 1 => {
            let spring = Wall::spring(unit * log_uniform(rng, 0.1, 2.0), 1);
            if rng.random_bool(0.2) { spring.behind(0.0).alone() } else { spring.alone() }
        }
        2 => {
            let damping = -delta * log_uniform(rng, 0.1, 1.0);
            Wall::damped(0.01 * unit, damping, least).alone()
        }
        _ => crossing(rng, unit, least),
    }
}

/// A filter that cancels damping of slow motions and damps those at half of the sampling rate: where the length of
/// ticks alternates, these drive each other.
fn crossing(rng: &mut impl Rng, unit: f64, delay: usize) -> Environment {
    let (slow, fast) = (rng.random_range(0.5..0.75), 1.0 - log_uniform(rng, 0.01, 0.06));
    let damped = 0.5 * log_uniform(rng, 3.6, 5.4) * (1.0 - fast);
    let cancelled = 1.0 - slow;
    let numerator = [damped - cancelled, -damped * slow - cancelled * fast];
    let denominator = [1.0, fast - slow, -slow * fast];
    Environment::Rational(Rational {
        numerator: coefficients(&numerator.map(|c| c * unit)),
        denominator: coefficients(&denominator),
        delay,
        unit_zeros: 1,
    })
}

/// About this number, in so few bits that its products with small whole numbers are exact.
fn exactly(x: f64) -> f64 {
    let scale = 2.0_f64.powi(2 - x.log2().floor() as i32);
    (x * scale).round() / scale
}

/// A delayed spring with factors on the circle above and below, and the spring alone.
fn hidden(rng: &mut impl Rng, unit: f64, delay: usize) -> (Environment, Environment) {
    let gain = exactly(unit * log_uniform(rng, 0.05, 1.0));
    let mut factor = vec![1.0];
    let quadratic: [f64; 3] =
        [[1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0]][rng.random_range(0..3)];
    let count = rng.random_range(1..=8);
    let kind = rng.random_range(0..3);
    for _ in 0..count {
        let next: &[f64] = match kind {
            0 => &[1.0, 1.0],
            1 => &quadratic,
            _ => &[1.0, -1.0],
        };
        if factor.len() + next.len() > 10 {
            break;
        }
        factor = multiply(&factor, next);
    }
    let numerator: Vec<f64> = factor.iter().map(|c| c * gain).collect();
    let with = |numerator: &[f64], denominator: &[f64]| {
        Environment::Rational(Rational {
            numerator: coefficients(numerator),
            denominator: coefficients(denominator),
            delay,
            unit_zeros: 0,
        })
    };
    (with(&numerator, &factor), with(&[gain], &[1.0]))
}

/// The same scene with one number `by` times what it was.
fn scaled(scene: &Scene, knob: Knob, by: f64) -> Scene {
    let mut scene = *scene;
    if knob == Knob::Coupling {
        if let Coupling::Spring { stiffness } = &mut scene.coupling {
            *stiffness *= by;
        }
        return scene;
    }
    if knob == Knob::Device {
        let Device { damping, passivity, .. } = &mut scene.device;
        *damping /= by;
        *passivity = passivity.map(|passivity| passivity / by);
        if let Coupling::Spring { stiffness } = &mut scene.coupling {
            *stiffness /= by;
        }
        return scene;
    }
    let damping = scene.device.damping;
    match &mut scene.environment {
        Environment::Parts(Parts { canceller, .. }) if knob == Knob::Residual => {
            // The cancelled damping is scaled.
            if let Some(Canceller { residual, .. }) = canceller {
                *residual = damping - (damping - *residual) * by;
            }
        }
        Environment::Parts(Parts { wall, profile, .. }) => {
            if let Some(wall) = wall {
                if knob == Knob::Gain {
                    wall.stiffness *= by;
                }
                // Beside a profile all of the wall is scaled.
                if let Some(damper) = &mut wall.damper
                    && (knob == Knob::Damping || profile.is_some())
                {
                    damper.damping *= by;
                }
            }
            if let Some(profile) = profile {
                profiles::scaled(profile, by);
            }
        }
        Environment::Stated(_) => {}
        Environment::Rational(rational) => {
            let scaled: Vec<f64> = rational.numerator.as_slice().iter().map(|c| c * by).collect();
            rational.numerator = coefficients(&scaled);
        }
    }
    scene
}

/// Whether the certificate's own quick answer is yes: refused scenes are looked at for remedies, which takes a
/// while.
pub fn passes(scene: &Scene, format: Format) -> bool {
    PassivityProblem::in_format(scene, format).is_ok_and(|posed| posed.is_certified())
}

/// Whether a mode takes a scene that the certificate has passed: where its torques are latched, a board may
/// ask for a little more. Scenes without latency that no board takes are handled later.
fn accepted(scene: &Scene, format: Format, mode: Mode) -> bool {
    if !passes(scene, format) {
        return false;
    }
    match mode {
        Mode::Bare | Mode::Simultaneous => true,
        Mode::Latched if !has_latency(scene) => !matches!(
            assess_in(scene, format).renders_in::<Latched>(scene),
            Err(TimingError::ReadLate { .. })
        ),
        Mode::Latched | Mode::AtPhase(_) => {
            let assessment = assess_in(scene, format);
            mode.timing().is_some_and(|timing| assessment.renders_at(scene, timing).is_ok())
        }
    }
}

/// The scale of a number at which a scene only just passes, to a millionth; any in a wide range
/// where it passes throughout.
fn taken_to_the_line(scene: &Scene, knob: Knob, accepted: impl Fn(&Scene) -> bool) -> Option<f64> {
    let passes = |by: f64| accepted(&scaled(scene, knob, by));
    let (mut inside, mut outside);
    if passes(1.0) {
        (inside, outside) = (1.0, 4.0);
        while passes(outside) {
            inside = outside;
            outside *= 4.0;
            if outside > 300.0 {
                return Some(inside);
            }
        }
    } else if let Some(by) = [2.0, 4.0, 8.0, 16.0, 32.0].into_iter().find(|by| passes(*by)) {
        // It passes from somewhere on: a spring that pulls an unstable environment along.
        (inside, outside) = (by, 2.0 * by);
        while passes(outside) && outside < 300.0 {
            (inside, outside) = (outside, 2.0 * outside);
        }
    } else {
        (inside, outside) = (0.25, 1.0);
        while !passes(inside) {
            outside = inside;
            inside *= 0.25;
            if inside < 1e-3 {
                return None;
            }
        }
    }
    while outside / inside > 1.0 + 1e-6 {
        let middle = (inside * outside).sqrt();
        *(if passes(middle) { &mut inside } else { &mut outside }) = middle;
    }
    Some(inside)
}

/// Another set of a scene's parameters that passes, too.
fn another(rng: &mut impl Rng, scene: &Scene, size: f64, format: Numbers) -> Option<Scene> {
    let mut other = *scene;
    if let Some(limit) = &mut other.torque_limit
        && rng.random_bool(0.3)
    {
        *limit *= log_uniform(rng, 0.1, 1.0);
    }
    if rng.random_bool(0.3) {
        other = scaled(&other, Knob::Coupling, log_uniform(rng, 0.5, 1.0));
    }
    match &mut other.environment {
        Environment::Parts(Parts { wall: Some(wall), profile: None, .. }) => {
            wall.stiffness *= log_uniform(rng, 0.1, 1.0);
            let damping = log_uniform(rng, 0.3, 1.0);
            if let Some(damper) = &mut wall.damper {
                damper.damping *= damping;
                damper.filter = damper.filter.map(|pole| pole * rng.random_range(0.9..1.0));
            }
            if rng.random_bool(0.5) {
                wall.side = wall.side.at(wall.face() + size * rng.random_range(-1.0..1.0));
            }
        }
        Environment::Parts(Parts { profile: None, .. }) => {
            other = scaled(&other, Knob::Residual, log_uniform(rng, 0.1, 1.0));
        }
        Environment::Parts(Parts {
            canceller: None, wall: None, profile: Some(profile), ..
        }) => {
            let mode = f64::from(rng.random_range(1..11_u8));
            match profile.selecting(mode) {
                Some(selected) => *profile = selected,
                None => profiles::scaled(profile, log_uniform(rng, 0.1, 1.0)),
            }
        }
        _ => other = scaled(&other, Knob::Gain, log_uniform(rng, 0.1, 1.0)),
    }
    passes(&other, format.format()).then_some(other)
}
