//! An accepted scene in the loop's units, as a search needs it, and the energy that its certificate
//! allows.

use std::f64::consts::{PI, TAU};

use haptic_servo::certificate::{Assessment, QuantizationBound, Resolution, RuleAnswer};
use haptic_servo::dac::DacCode;
use haptic_servo::environment::Profile;
use haptic_servo::number::Format;
use haptic_servo::scene::{Scene, TimeRange};
use haptic_servo::servo::Simultaneous;
use haptic_servo::servo_loop::READ_WITHIN;
use rand::Rng;

use crate::device::Lags;
use crate::norm::{Errors, compliance, slope};
use crate::scenes::{Mode, RandomScene};
use crate::timing::LoopTiming;

/// An accepted scene as numbers, in the loop's units: see [`crate::device`].
#[derive(Clone, Copy, Debug)]
pub struct NormalizedScene {
    /// Damping of the simulated device.
    pub damping: f64,
    /// Updates that may be missed in a row.
    pub tolerated: u32,
    /// Whether a timer puts codes out: only then can one be late. A simultaneous one is there at its
    /// count, however long it took.
    pub latched: bool,
    /// When counts are read and codes put out.
    pub timing: LoopTiming,
    /// The latest part of a period at which a count may be read.
    pub latest: f64,
    /// Masses that a hand may have besides the device.
    pub segments: usize,
    /// Whether the servo runs without a board's loop.
    pub bare: bool,
    /// Whether its certificate excludes that a torque is limited.
    pub unlimited: bool,
    /// Whether that computes its codes a tick ahead.
    pub ahead: bool,
    /// Planted: late ticks of which the servo does not know.
    pub unreported: bool,
    /// Planted: codes that are put out although later ones have overtaken them.
    pub unordered: bool,
    /// Energy that the environment stores where the servo starts.
    pub stored: f64,
    /// How much positions are off, in rad.
    pub off: f64,
    /// Sides of zero on which an environment stores energy at once: a profile has two.
    pub sides: f64,
    /// Torque of one DAC code.
    pub torque_per_code: f64,
    /// The largest torque of any of its sets.
    pub bound: f64,
    /// The largest compliance of any of its couplings.
    pub compliance: f64,
    /// The farthest face of any of its walls, in rad.
    pub face: f64,
    /// Bound on the torque error of encoder and DAC.
    pub error: f64,
    /// The same of the numbers, within a turn of zero.
    pub numbers: f64,
    /// Encoder counts in a radian.
    pub counts_per_radian: f64,
    /// The fastest that the device may turn, in rad a period.
    pub fastest: f64,
    /// Angles, in rad, at which the runs are large.
    pub size: f64,
    /// The farthest place to arm at, in rad.
    pub reach: f64,
    /// Angles a sample at which the loop is likely at its worst.
    pub angles: [f64; 4],
    /// Injected damping in N m s/rad; zero without any.
    pub injection: f64,
    /// Sets that may be swapped in.
    pub sets: usize,
    /// Part of a period within which counts are read that are in time.
    pub in_time: f64,
    /// Largest slope of the encoder's error over the angle.
    pub linearity: f64,
    /// Peak of the encoder's noise in rad.
    pub noise: f64,
    /// Width of its hysteresis in rad.
    pub hysteresis: f64,
    /// Readings in a row that may be dropped, each of which is then the one before.
    pub dropped: u16,
}

/// Damping in N m s/rad that a device may lose, everything else as it runs, before the certificate
/// is void.
///
/// The margin of a board, which limits the torque of every scene; whether the scene is rendered in
/// the mode that is run is not asked here.
pub fn margin(assessment: &Assessment, scene: &Scene, injected: Option<f64>) -> f64 {
    let timed = scene.certify_in(assessment.format).ok().map(|scene| scene.time::<Simultaneous>());
    let timed = timed.and_then(Result::ok);
    timed.and_then(|timed| timed.margin_with(injected.unwrap_or(0.0))).unwrap_or(0.0)
}

/// The passivity that a scene declares.
pub fn declared(scene: &Scene) -> f64 {
    scene.device.passivity.unwrap_or(scene.device.damping)
}

/// Share of its margin that a device loses.
const TAKEN: f64 = 0.9;

/// An angle a sample below which nothing happens in the time that there is.
const SLOWEST: f64 = 0.1;

impl NormalizedScene {
    /// Of a drawn scene and its other one, which were both accepted. `None` without a bound on
    /// the torque error of encoder, numbers and DAC.
    pub fn of(drawn: &RandomScene, assessments: &[Assessment], format: Format) -> Option<Self> {
        let RandomScene { scene, transducers, .. } = drawn;
        let actual = &drawn.actual;
        let declared = actual.passivity.unwrap_or(declared(scene));
        let unit = declared / scene.timing.period;
        let steps = Resolution::of(transducers, None);
        let count = TAU / transducers.counts_per_turn;
        // With its noise and its hysteresis.
        let step = count * scene.latency.encoder.steps();
        // A rigid device has no more passivity than damping, whatever was declared.
        let has = declared.min(scene.device.damping);
        let (mut bound, mut soft, mut face) = (0.0_f64, 0.0_f64, 0.0_f64);
        let (mut error, mut numbers, mut damping) = (0.0_f64, 0.0_f64, 0.0_f64);
        let (mut off, mut stored) = (0.0_f64, 0.0_f64);
        let is_general = drawn.is_general();
        let scenes = std::iter::once((scene, drawn.judged_as.as_ref()))
            .chain(drawn.other.iter().map(|other| (other, None)));
        let mut sets = 0;
        for ((scene, judged_as), assessment) in scenes.zip(assessments) {
            sets += 1;
            let judged = judged_as.unwrap_or(scene);
            let largest = scene.torque_limit.unwrap_or(transducers.full_scale_torque);
            let errors = if is_general {
                let general = Errors::general(judged, format, largest)?;
                off = off.max(general.off + 0.5 * step);
                Errors { position: 0.0, numbers: general.numbers }
            } else {
                Self::accounted(judged, assessment, format, (largest, step), &steps)?
            };
            let converter =
                0.5 * transducers.full_scale_torque / f64::from(DacCode::CODES_TO_FULL_SCALE);
            let injected = drawn.rendering.injection.unwrap_or(0.0) / scene.timing.period;
            error = error.max(errors.position + converter + injected * step);
            numbers = numbers.max(errors.numbers);
            bound = bound.max(largest);
            soft = soft.max(compliance(scene));
            face = face.max(scene.environment.wall().map_or(0.0, |wall| wall.face().abs()));
            let lost = match actual.passivity {
                Some(_) => 0.0,
                None => TAKEN * margin(assessment, scene, drawn.rendering.injection),
            };
            damping = damping.max(drawn.damping.unwrap_or(has - lost));
            if drawn.mode == Mode::Bare {
                stored = stored.max(Self::stored_at_zero(scene));
            }
        }
        let latency = actual.latency.unwrap_or(scene.latency);
        // Torques that may come before their counts are computed ahead.
        let ahead = drawn.mode == Mode::Bare && latency.total_jitter() > latency.output_delay.least;
        let samples = drawn.mode.samples() + f64::from(u8::from(ahead));
        let mut timing = LoopTiming::of(&Scene { latency, ..*scene }, samples);
        if let Some(delay) = actual.delay {
            timing.delay = TimeRange::exactly(delay);
        }
        let filters = Lags { sensor: timing.sensor.most, ..Lags::default() };
        let half = 0.5 * transducers.counter.counts();
        let worst = scene.timing.worst_period.unwrap_or(scene.timing.period);
        let periods = worst / scene.timing.period;
        let cos = |c: f64| c.clamp(-1.0, 1.0).acos();
        let theta = assessments.first().and_then(|a| a.cos_theta);
        let theta = theta.map_or(1.0, |c| cos(c.midpoint())).clamp(0.02, PI);
        Some(Self {
            damping: (damping / declared).max(0.0),
            tolerated: ((periods + 1e-9) as u32).saturating_sub(1),
            latched: matches!(drawn.mode, Mode::Latched | Mode::AtPhase(_)),
            timing,
            latest: match drawn.mode {
                Mode::AtPhase(_) => timing.delay.least,
                _ => 0.55,
            },
            segments: filters.segments(),
            bare: drawn.mode == Mode::Bare,
            unlimited: drawn.mode == Mode::Bare && scene.torque_limit.is_none(),
            ahead,
            unreported: actual.unreported,
            unordered: actual.unordered,
            stored: stored / unit,
            off,
            sides: if scene.environment.profile().is_some() { 2.0 } else { 1.0 },
            in_time: READ_WITHIN.max(match drawn.mode {
                Mode::AtPhase(_) => scene.latency.deviation_of_counts(),
                _ => 0.0,
            }) / scene.timing.period,
            torque_per_code: transducers.full_scale_torque
                / f64::from(DacCode::CODES_TO_FULL_SCALE)
                / unit,
            bound: bound / unit,
            compliance: soft * unit,
            face,
            error: error / unit,
            numbers: numbers / unit,
            counts_per_radian: transducers.counts_per_turn / TAU,
            // So that the counter does not wrap unseen in the longest gap that a run has.
            fastest: 0.9 * half * count / 8.0,
            size: drawn.size,
            reach: drawn.reach,
            angles: if timing.jitters[0] > 0.0 {
                // A pattern of two to four ticks resonates with the motions that it folds onto each other.
                [theta, 0.97 * PI, PI / 2.0, PI / 3.0]
            } else if theta < SLOWEST {
                // As bad nearly up to there, and many times as fast.
                [0.1, 0.2, 0.35, 0.6]
            } else if periods > 1.0 {
                [theta, theta / periods, PI / periods, 2.0 * PI / (periods + 1.0)]
            } else {
                [theta; 4]
            },
            injection: drawn.rendering.injection.unwrap_or(0.0),
            sets,
            linearity: latency.encoder.linearity,
            noise: latency.encoder.noise * count,
            hysteresis: latency.encoder.hysteresis * count,
            dropped: latency.encoder.dropped,
        })
    }

    /// The errors of a scene without latency: the least of the known bounds.
    fn accounted(
        scene: &Scene,
        assessment: &Assessment,
        format: Format,
        (largest, step): (f64, f64),
        steps: &Resolution,
    ) -> Option<Errors> {
        let whole = QuantizationBound::of(scene, format, steps)
            .map(|rest| Errors { position: rest.encoder.unwrap_or(0.0), numbers: rest.numbers })
            .filter(|errors| errors.sum().is_finite());
        let through = Errors::through(scene, format, largest).map(|e| e.over(0.5 * step));
        // Where the rule allows any coupling that is as soft, no error has to come out through
        // the coupling to be accounted for.
        let alone = (assessment.paper == RuleAnswer::Pass)
            .then(|| Errors::alone(scene, format, largest))
            .flatten()
            .map(|errors| errors.over(0.5 * step));
        let off = [whole, through, alone].into_iter().flatten();
        off.min_by(|a, b| a.sum().total_cmp(&b.sum()))
    }

    /// The energy in N m rad that a servo's environment may release that is at rest at the servo's zero.
    fn stored_at_zero(scene: &Scene) -> f64 {
        let environment = &scene.environment;
        let wall = environment.wall().map_or(0.0, |w| w.stiffness.abs() * w.face() * w.face());
        let of = |profile: &Profile| {
            let steepest = slope(profile);
            let away = match profile.ends {
                Some(ends) => ends.from.abs().max(ends.to.abs()),
                None => TAU / profile.count,
            };
            profile.torque.abs() * away + steepest * away * away
        };
        wall + environment.profile().map_or(0.0, of)
    }

    /// Whether the error of the encoder's angle comes through a filter.
    pub fn filters_errors(&self) -> bool {
        self.linearity > 0.0 && self.timing.sensor.most > 0.0
    }

    /// A place for the board's zero, in rad.
    pub fn place(&self, rng: &mut impl Rng) -> f64 {
        match rng.random_range(0..4) {
            0 => 0.0,
            1 => self.size * rng.random_range(-1.0..1.0),
            // So far from the board's zero, on either side.
            2 => self.reach + self.size * rng.random_range(-2.0..2.0),
            _ => -self.reach + self.size * rng.random_range(-2.0..2.0),
        }
    }
}
