//! Random scenes of every kind, each taken to just inside acceptance.

use std::f64::consts::{PI, TAU};

use haptic_servo::certificate::{PassivityProblem, TimingError, assess_in};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::{Coefficients, Environment, Rational, Wall};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{Latched, RenderingOptions, Transducers};
use rand::Rng;
use tests::scenes::log_uniform;

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
}

impl Kind {
    /// All values.
    pub const ALL: [Self; 7] = [
        Self::Wall,
        Self::FreeMode,
        Self::FreeModeWall,
        Self::Rational,
        Self::Unstable,
        Self::Hidden,
        Self::Overstated,
    ];
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Debug::fmt(self, f)
    }
}

/// What a search may draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// One kind only.
    pub kind: Option<Kind>,
    /// Whether all, none or some scenes have a worst period.
    pub worst_period: Option<bool>,
    /// The same of a torque limit.
    pub limited: Option<bool>,
    /// The same of being latched.
    pub latched: Option<bool>,
    /// Whether the DAC may reach its full scale where a scene has no torque limit.
    pub saturates: bool,
    /// The same of injected damping.
    pub injected: Option<bool>,
    /// Part of a period by which late ticks outlast their own.
    pub overrun: f64,
    /// Share of the margin that the device loses.
    pub taken: f64,
    /// Whether the margin is not what the assessment states, but how much less damping would still
    /// be certified.
    pub bisected: bool,
    /// The damping of the device, over the least with which the scene's controller as it is would
    /// be certified; only linear scenes are drawn then.
    pub weakened: Option<f64>,
}

impl Choice {
    /// Anything.
    pub const ANY: Self = Self {
        kind: None,
        worst_period: None,
        limited: None,
        latched: None,
        saturates: true,
        injected: None,
        overrun: 0.0,
        taken: 0.9,
        bisected: false,
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
    /// Whether codes are latched.
    pub latched: bool,
    /// Angles in rad at which the runs are large.
    pub size: f64,
    /// The farthest place to arm at, in rad.
    pub reach: f64,
    /// Share of the margin that the device loses.
    pub taken: f64,
    /// The damping of the device in N m s/rad where it is another.
    pub damping: Option<f64>,
    /// Part of a period by which late ticks outlast their own.
    pub overrun: f64,
    /// Injected damping over the room that there is for it.
    pub injected: Option<f64>,
}

impl RandomScene {
    /// A scene with sensor and motor so fine that they hardly matter, at angles of about `size` rad.
    pub fn of(kind: Kind, scene: Scene, format: Numbers, latched: bool, size: f64) -> Self {
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
            rendering: RenderingOptions { fade: 50.0 * scene.timing.period, injection: None },
            format,
            latched,
            size,
            reach: size,
            taken: 0.9,
            damping: None,
            overrun: 0.0,
            injected: None,
        }
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

/// Draws a scene and takes it to the line; `None` where it has none near.
pub fn draw(rng: &mut impl Rng, choice: &Choice) -> Option<RandomScene> {
    let kind = choice.kind.unwrap_or_else(|| match rng.random_range(0..20) {
        0..=7 => Kind::Wall,
        8..=9 => Kind::FreeMode,
        10..=11 => Kind::FreeModeWall,
        12..=15 => Kind::Rational,
        16..=17 => Kind::Unstable,
        18 => Kind::Hidden,
        _ => Kind::Overstated,
    });
    let format = match rng.random_range(0..10) {
        0..=4 => Numbers::F32,
        5 => Numbers::F64,
        6..=7 => Numbers::Q24,
        _ => Numbers::Q20,
    };
    // The canceller in front of a wall is undelayed, and so is never latched.
    let latched = sometimes(rng, choice.latched, 0.6) && kind != Kind::FreeModeWall;
    let period = log_uniform(rng, 1e-4, 4e-3);
    let delta = log_uniform(rng, 2e-3, 0.5);
    let unit = delta / period;
    let worst = if sometimes(rng, choice.worst_period, 0.25) {
        [1.5, 2.0, 2.0, 3.0, 4.0][rng.random_range(0..5)]
    } else {
        1.0
    };
    let standard = 2.0 * unit / worst;
    let coupling = match rng.random_range(0..10) {
        0 => Coupling::Rigid,
        1..=4 => Coupling::Spring { stiffness: standard },
        5..=7 => Coupling::Spring { stiffness: standard * log_uniform(rng, 0.05, 1.0) },
        _ => Coupling::Spring { stiffness: standard * log_uniform(rng, 1.0, 10.0) },
    };
    let size = log_uniform(rng, 1e-3, 1.0);
    let full_scale = (unit * size * log_uniform(rng, 0.1, 10.0)).min(100.0);
    let rational = matches!(kind, Kind::Rational | Kind::Unstable | Kind::Hidden);
    let limited = sometimes(rng, choice.limited, if rational { 0.1 } else { 0.5 });
    let full_scale = if limited || choice.saturates { full_scale } else { 10.0 * unit * size };
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
        environment: Environment::FreeMode { residual: 0.0, delay: 0 },
        latency: Latency::NONE,
        torque_limit: limited.then(|| full_scale * log_uniform(rng, 0.05, 0.999)),
    };
    let mut face = 0.0;
    let reach = match rng.random_range(0..12) {
        0 => format.reach(),
        1..=3 => 5.0 * size,
        _ => size,
    };
    let least = usize::from(latched);
    let mut judged_as = None;
    let knob = match kind {
        Kind::Wall | Kind::Overstated => {
            let delay = if rng.random_bool(0.7) { least } else { rng.random_range(least..=3) };
            let wall = wall(rng, unit, delta, delay, reach);
            face = wall.face;
            if wall.damping == 0.0 && rng.random_bool(0.5) {
                scene.environment = Environment::DelayedSpring(wall);
            } else {
                scene.environment = Environment::DamperWall(wall);
            }
            if wall.damping != 0.0 && rng.random_bool(0.5) { Knob::Damping } else { Knob::Gain }
        }
        Kind::FreeMode => {
            let residual = damping * rng.random_range(-0.1..1.0);
            let delay = rng.random_range(least..=2);
            scene.environment = Environment::FreeMode { residual, delay };
            Knob::Residual
        }
        Kind::FreeModeWall => {
            let residual = damping * rng.random_range(0.0..1.0);
            let delay = rng.random_range(0..=2);
            let wall = wall(rng, unit, delta, delay, reach);
            face = wall.face;
            scene.environment = Environment::FreeModeWall { residual, wall };
            if rng.random_bool(0.3) { Knob::Residual } else { Knob::Gain }
        }
        Kind::Rational | Kind::Unstable => {
            let least = if rng.random_bool(0.6) { least } else { rng.random_range(least..=3) };
            scene.environment = rational_with(rng, unit, least, kind == Kind::Unstable);
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
    let knob = match scene.coupling {
        Coupling::Spring { .. } if rng.random_bool(0.15) => Knob::Coupling,
        _ => knob,
    };
    if kind == Kind::Unstable && matches!(scene.coupling, Coupling::Spring { .. }) {
        // Only a soft coupling makes a stable controller of it.
        let stiffness = standard * log_uniform(rng, 0.01, 0.7);
        scene.coupling = Coupling::Spring { stiffness };
    }
    let exponent = rng.random_range(16..=22);
    let exponent = if rng.random_bool(0.1) { rng.random_range(12..=22) } else { exponent };
    let (counter, half, exponent) = if reach <= 5.0 * size && rng.random_bool(0.25) {
        // Coarse enough for so few bits to follow it.
        let most = (4e3 / size).log2().max(10.0) as u32;
        (CounterWidth::Bits16, f64::from(1_u32 << 15), exponent.min(most))
    } else {
        (CounterWidth::Bits32, f64::from(1_u32 << 31), exponent)
    };
    let counts_per_turn = f64::from(1_u32 << exponent);
    // A device that its program takes for slower than it is stops for what it takes for a jump.
    let largest_speed = if rng.random_bool(0.1) {
        size / period * log_uniform(rng, 0.1, 3.0)
    } else {
        0.9 * half * TAU / counts_per_turn / (8.0 * period)
    };
    let transducers =
        Transducers { counts_per_turn, counter, full_scale_torque: full_scale, largest_speed };
    let fade = period * log_uniform(rng, 1.0, 200.0);
    if choice.weakened.is_some() {
        scene.torque_limit = None;
        if let Environment::DelayedSpring(w)
        | Environment::DamperWall(w)
        | Environment::FreeModeWall { wall: w, .. } = &mut scene.environment
        {
            w.one_sided = false;
        }
    }
    let scale = taken_to_the_line(&scene, knob, format.format(), latched)?;
    let scene = scaled(&scene, knob, scale);
    let judged_as = judged_as.map(|environment| Scene { environment, ..scene });
    let other = rng.random_bool(0.3).then(|| another(rng, &scene, size, format)).flatten();
    let damping = if choice.bisected || choice.weakened.is_some() {
        let least = |scene: &Scene| least_damping(scene, format.format());
        let least = least(&scene)?.max(other.as_ref().and_then(least).unwrap_or(0.0));
        let has = delta.min(damping);
        Some(match choice.weakened {
            Some(share) => share * least,
            None => has - choice.taken * (has - least),
        })
    } else {
        None
    };
    // The room is known only once the scene is certified.
    let injected = sometimes(rng, choice.injected, 0.15).then(|| 1.0 - log_uniform(rng, 1e-6, 0.9));
    Some(RandomScene {
        kind,
        scene,
        other,
        judged_as,
        transducers,
        rendering: RenderingOptions { fade, injection: None },
        format,
        latched,
        size,
        reach: reach.max(face.abs()),
        taken: choice.taken,
        damping,
        overrun: choice.overrun,
        injected,
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
    Wall { stiffness, damping, filter, delay, face, one_sided }
}

fn multiplied(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

fn coefficients(descending: &[f64]) -> Coefficients {
    Coefficients::new(descending).expect("at most eight poles are drawn")
}

fn rational_with(rng: &mut impl Rng, unit: f64, delay: usize, unstable: bool) -> Environment {
    let count = rng.random_range(1..=4);
    let mut denominator = vec![1.0];
    while denominator.len() <= count {
        let outside = unstable && denominator.len() == 1;
        let radius = if outside {
            1.0 + log_uniform(rng, 1e-3, 0.5)
        } else {
            1.0 - log_uniform(rng, 3e-3, 1.0)
        };
        let pair = denominator.len() < count && rng.random_bool(0.6);
        let factor = if pair {
            vec![1.0, -2.0 * radius * rng.random_range(0.0..PI).cos(), radius * radius]
        } else {
            vec![1.0, if rng.random_bool(0.3) { radius } else { -radius }]
        };
        denominator = multiplied(&denominator, &factor);
    }
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
        factor = multiplied(&factor, next);
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
    let damping = scene.device.damping;
    match &mut scene.environment {
        Environment::FreeModeWall { residual, .. } | Environment::FreeMode { residual, .. }
            if knob == Knob::Residual =>
        {
            // The cancelled damping is scaled.
            *residual = damping - (damping - *residual) * by;
        }
        Environment::FreeMode { .. } | Environment::Stated(_) | Environment::Composed(_) => {}
        Environment::DelayedSpring(wall)
        | Environment::DamperWall(wall)
        | Environment::FreeModeWall { wall, .. } => match knob {
            Knob::Damping => wall.damping *= by,
            _ => wall.stiffness *= by,
        },
        Environment::Rational(rational) => {
            let scaled: Vec<f64> = rational.numerator.as_slice().iter().map(|c| c * by).collect();
            rational.numerator = coefficients(&scaled);
        }
        Environment::Profile(profile) => match knob {
            Knob::Damping => profile.damping *= by,
            _ => profile.torque *= by,
        },
    }
    scene
}

/// Whether the certificate's own quick answer is yes.
fn passes(scene: &Scene, format: Format) -> bool {
    PassivityProblem::in_format(scene, format).is_ok_and(|posed| posed.is_certified())
}

/// Whether a board takes a scene that the certificate has passed: where its torques are latched, it may ask
/// for a little more. Scenes that no board takes are handled later.
fn accepted(scene: &Scene, format: Format, latched: bool) -> bool {
    passes(scene, format)
        && !(latched
            && matches!(
                assess_in(scene, format).renders_in::<Latched>(scene),
                Err(TimingError::ReadLate { .. })
            ))
}

/// The scale of a number at which a scene only just passes, to a millionth; any in a wide range
/// where it passes throughout.
fn taken_to_the_line(scene: &Scene, knob: Knob, format: Format, latched: bool) -> Option<f64> {
    let passes = |by: f64| accepted(&scaled(scene, knob, by), format, latched);
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
        Environment::DelayedSpring(wall)
        | Environment::DamperWall(wall)
        | Environment::FreeModeWall { wall, .. } => {
            wall.stiffness *= log_uniform(rng, 0.1, 1.0);
            wall.damping *= log_uniform(rng, 0.3, 1.0);
            if let Some(pole) = &mut wall.filter {
                *pole *= rng.random_range(0.9..1.0);
            }
            if rng.random_bool(0.5) {
                wall.face += size * rng.random_range(-1.0..1.0);
            }
        }
        Environment::FreeMode { .. } => {
            other = scaled(&other, Knob::Residual, log_uniform(rng, 0.1, 1.0));
        }
        Environment::Rational(_) => other = scaled(&other, Knob::Gain, log_uniform(rng, 0.1, 1.0)),
        Environment::Profile(profile) => profile.torque *= log_uniform(rng, 0.1, 1.0),
        Environment::Stated(_) | Environment::Composed(_) => {}
    }
    passes(&other, format.format()).then_some(other)
}
