//! What a drawn scene runs on, and how that may differ from what the scene states.

use haptic_servo::latency::Latency;
use haptic_servo::output_timing::{OutputTiming, READ_WITHIN};
use haptic_servo::scene::{Coupling, EncoderReading, Scene, TimeRange};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::scenes::log_uniform;

/// What runs a scene's servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A board's loop whose codes are latched.
    Latched,
    /// A board's loop whose codes are there at their counts.
    Simultaneous,
    /// A board's loop whose codes are put out so many nanoseconds after their counts.
    AtPhase(u32),
    /// The servo alone, whose codes are put out after the scene's output delay: for scenes that no board
    /// renders.
    Bare,
}

impl Mode {
    /// The phases in nanoseconds of which there are boards.
    pub const PHASES: [u32; 3] = [10_000, 60_000, 250_000];

    /// The same as the certificate has it; `None` without a board.
    pub const fn timing(self) -> Option<OutputTiming> {
        match self {
            Self::Latched => Some(OutputTiming::Latched),
            Self::Simultaneous => Some(OutputTiming::Simultaneous),
            Self::AtPhase(nanoseconds) => Some(OutputTiming::AtPhase(nanoseconds)),
            Self::Bare => None,
        }
    }

    /// Whole periods from a count to its code beside the scene's output delay.
    pub const fn samples(self) -> f64 {
        if matches!(self, Self::Latched) { 1.0 } else { 0.0 }
    }
}

/// What differs from what the scene states: nothing, unless a fault is planted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Actual {
    /// The latency.
    pub latency: Option<Latency>,
    /// The time from a count to its code, in periods.
    pub delay: Option<f64>,
    /// Whether the servo does not know of late ticks, so that the motor keeps a stale code.
    pub unreported: bool,
    /// Whether the motor takes a code although a later one has overtaken it.
    pub unordered: bool,
    /// The passivity of the device in N m s/rad.
    pub passivity: Option<f64>,
}

/// Whether a scene's torques lag, or its coupling has memory.
pub fn has_latency(scene: &Scene) -> bool {
    !scene.latency.is_none() || scene.coupling == Coupling::Matched
}

/// A time that is exactly known, or now and then in a range.
fn about(rng: &mut impl Rng, time: f64) -> TimeRange {
    if rng.random_bool(0.2) {
        TimeRange::between(time, time * log_uniform(rng, 1.001, 1.4))
    } else {
        TimeRange::exactly(time)
    }
}

/// A part of the largest jitter, often most of it.
fn share(rng: &mut impl Rng) -> f64 {
    let least = if rng.random_bool(0.6) { 0.2 } else { 1e-3 };
    log_uniform(rng, least, 1.0)
}

/// Draws the latency of a scene with this period in s, for a mode.
pub fn draw_latency(rng: &mut impl Rng, mode: Mode, period: f64) -> Latency {
    match mode {
        Mode::AtPhase(nanoseconds) => at_phase(rng, f64::from(nanoseconds) / 1e9, period),
        Mode::Latched => latched(rng, period),
        Mode::Simultaneous | Mode::Bare => any(rng, period),
    }
}

/// The same with jitters of torques or counts, or of both at once, that are together this much at most.
fn jittering(rng: &mut impl Rng, latency: Latency, period: f64, most: f64) -> Latency {
    let total = most * share(rng);
    let bound = latency.bound_on_two_jitters(period).filter(|_| rng.random_bool(0.35));
    match bound {
        Some(bound) => {
            let total = total.min(0.999 * bound);
            let of_counts =
                total * if rng.random_bool(0.5) { 0.5 } else { rng.random_range(0.0..1.0) };
            Latency { output_jitter: total - of_counts, count_jitter: of_counts, ..latency }
        }
        None => Latency { output_jitter: total, ..latency },
    }
}

/// The same with counts that may be read as late as a board reads them.
fn read_late(mut latency: Latency) -> Latency {
    let counts = match latency.count_jitter {
        0.0 => &mut latency.output_jitter,
        _ => &mut latency.count_jitter,
    };
    *counts = counts.max(READ_WITHIN);
    latency
}

fn at_phase(rng: &mut impl Rng, phase: f64, period: f64) -> Latency {
    let mut latency = Latency::delayed(phase);
    if rng.random_bool(0.5) {
        let lag = period * log_uniform(rng, 0.01, 1.0);
        latency.actuator_lag = about(rng, lag);
    }
    if rng.random_bool(0.15) {
        latency.sensor_lag = TimeRange::exactly(period * log_uniform(rng, 0.02, 0.8));
    }
    read_late(jittering(rng, latency, period, phase))
}

fn latched(rng: &mut impl Rng, period: f64) -> Latency {
    let lag = period * log_uniform(rng, 0.02, 1.0);
    let mut latency = Latency::NONE;
    if rng.random_bool(0.25) {
        latency = Latency::sampled(rng.random_range(1..=4), lag, period);
        latency.sensor_lag = filter_beside_updates(rng, period);
        if rng.random_bool(0.5) {
            latency = jittering(rng, latency, period, 0.2 * period);
        }
        return latency;
    }
    if rng.random_bool(0.5) {
        latency.actuator_lag = about(rng, lag);
    }
    if rng.random_bool(0.15) {
        latency.sensor_lag = TimeRange::exactly(period * log_uniform(rng, 0.02, 0.8));
    }
    read_late(jittering(rng, latency, period, 0.4 * period))
}

fn filter_beside_updates(rng: &mut impl Rng, period: f64) -> TimeRange {
    if rng.random_bool(0.6) {
        return TimeRange::ZERO;
    }
    let lag = period * log_uniform(rng, 0.02, 1.0);
    about(rng, lag)
}

/// A delay alone, or none, often so that torques cross counts, with jitter.
pub fn plain(rng: &mut impl Rng, period: f64) -> Latency {
    let delay = match rng.random_range(0..5) {
        0 | 1 => 0.0,
        2 | 3 => period,
        _ => period * log_uniform(rng, 0.01, 1.8),
    };
    // Without a delay the torques of a late environment may be early, too.
    let most = if delay == 0.0 { period } else { delay };
    jittering(rng, Latency::delayed(delay), period, most.min(0.95 * period))
}

/// The same with the readings of an encoder, in every third scene. Its own numbers decide, so that the other scenes are
/// what they are without it.
pub fn read(latency: Latency, period: f64, coupling: Coupling) -> Latency {
    let rng = &mut ChaCha8Rng::seed_from_u64(period.to_bits());
    if !rng.random_bool(0.33) {
        return latency;
    }
    let mut reading = EncoderReading::IDEAL;
    if rng.random_bool(0.5) {
        let least = if rng.random_bool(0.5) { 0.0 } else { rng.random_range(0.0..1.5) };
        let most = least + if rng.random_bool(0.5) { log_uniform(rng, 1e-3, 0.3) } else { 0.0 };
        reading.age = TimeRange::between(least * period, most * period);
    }
    if rng.random_bool(0.4) {
        reading.noise = log_uniform(rng, 0.5, 300.0);
    }
    if rng.random_bool(0.3) {
        reading.hysteresis = log_uniform(rng, 0.5, 300.0);
    }
    if coupling == Coupling::Matched {
        // No more than an age, noise and hysteresis has a proof there.
        return latency.read_by(kept(reading));
    }
    if rng.random_bool(0.7) {
        reading.linearity = log_uniform(rng, 0.01, 0.4);
    }
    if rng.random_bool(0.2) {
        reading.dropped = rng.random_range(1..=2);
    }
    latency.read_by(kept(reading))
}

/// For as long as the program runs, as a scene wants it.
pub fn kept(reading: EncoderReading) -> &'static EncoderReading {
    Box::leak(Box::new(reading))
}

fn any(rng: &mut impl Rng, period: f64) -> Latency {
    if rng.random_bool(0.3) {
        return plain(rng, period);
    }
    let lag = period * log_uniform(rng, 0.01, 1.5);
    if rng.random_bool(0.15) {
        let updates = rng.random_range(1..=4);
        let mut latency = Latency::sampled(updates, lag, period);
        let delay = f64::from(rng.random_range(0..=2 * updates)) * period / f64::from(updates);
        latency.output_delay = TimeRange::exactly(delay);
        latency.sensor_lag = filter_beside_updates(rng, period);
        if rng.random_bool(0.4) {
            latency = jittering(rng, latency, period, 0.5 * delay);
        }
        return latency;
    }
    let mut latency = Latency::NONE;
    if rng.random_bool(0.8) {
        let delay = period * log_uniform(rng, 0.01, 1.8);
        latency.output_delay = about(rng, delay);
    }
    if rng.random_bool(0.35) {
        latency.actuator_lag = about(rng, lag);
    }
    if rng.random_bool(0.2) {
        let lag = period * log_uniform(rng, 0.02, 1.0);
        latency.sensor_lag = about(rng, lag);
    }
    if latency.actuator_lag.is_zero() && rng.random_bool(0.15) {
        let begin = period * rng.random_range(0.0..0.5);
        latency.actuator_response =
            TimeRange::between(begin, begin + period * rng.random_range(0.01..0.5));
    }
    if rng.random_bool(0.7) {
        let most = latency.output_delay.least.min(0.6 * period);
        latency = jittering(rng, latency, period, most);
    }
    latency
}
