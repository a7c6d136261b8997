//! When counts are read and when their codes reach the motor, and the steps of the device between these
//! instants.
//!
//! All times are in periods. An instant within a period is a place in a list of all instants that a plan can
//! have, so that the motion from each to the next is computed once.

use haptic_servo::latency::TimeRange;
use haptic_servo::scene::Scene;

use crate::device::{HeldDevice, Lags, Step};
use crate::hardware::PERIOD;
use crate::plan::{Plan, Signs};

/// Instants nearer than this are one.
const SAME: f64 = 1e-9;

/// Steps of a period in which an encoder's error is filtered.
const PIECES: u32 = 16;

/// The times of a loop, as far as a scene states them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopTiming {
    /// The time from a count to its torque.
    pub delay: TimeRange,
    /// Largest deviations that differ from tick to tick: of torques, and of counts.
    pub jitters: [f64; 2],
    /// Whether both deviate at the same time.
    pub both: bool,
    /// Time constant of the amplifier.
    pub amplifier: TimeRange,
    /// Updates of the amplifier in a period; 0 if its lag is continuous.
    pub updates: u16,
    /// Time constant of the filter between encoder and servo.
    pub sensor: TimeRange,
    /// The middle age of a reading, a part of the delay.
    pub age: f64,
}

impl LoopTiming {
    /// The times of a scene whose codes are put out `samples` whole periods after their counts, beside the
    /// scene's delay.
    pub fn of(scene: &Scene, samples: f64) -> Self {
        let latency = &scene.latency;
        let in_periods = |time: TimeRange| {
            let period = scene.timing.period;
            TimeRange::between(time.least / period, time.most / period)
        };
        let delay = in_periods(latency.torque_delay());
        let jitters = match latency.jitters_twice() {
            true => [latency.output_jitter, latency.count_jitter],
            false => [latency.total_jitter(); 2],
        };
        Self {
            delay: TimeRange::between(delay.least + samples, delay.most + samples),
            jitters: jitters.map(|jitter| jitter / scene.timing.period),
            both: latency.jitters_twice(),
            amplifier: in_periods(latency.actuator_lag),
            updates: latency.actuator_updates,
            sensor: in_periods(latency.sensor_lag),
            age: latency.encoder.age.middle() / scene.timing.period,
        }
    }

    /// The lags at one place in their ranges.
    fn lags_at(&self, place: f64) -> Lags {
        Lags {
            amplifier: within(self.amplifier, place),
            updates: self.updates,
            sensor: within(self.sensor, place),
        }
    }
}

fn within(range: TimeRange, place: f64) -> f64 {
    range.least + place * (range.most - range.least)
}

/// An instant: whole periods from the beginning of a period, and the place in the list.
pub type Instant = (u32, usize);

/// The instants of a plan, and the motion between them.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// The device and its hand.
    pub held: HeldDevice,
    /// The lags.
    pub lags: Lags,
    /// The steps from each instant to the next.
    pub steps: Vec<Step>,
    /// The instants of a count: early, in time, late.
    counts: [Instant; 3],
    /// The instant of a tick that begins late in its period.
    pub delayed: Instant,
    /// The instants of a torque: early, in time, late.
    torques: [Instant; 3],
    /// The instants at which the amplifier is updated.
    pub updates: Vec<usize>,
}

impl Schedule {
    /// The instants of a plan.
    pub fn new(plan: &Plan, damping: f64, timing: &LoopTiming, audited: bool) -> Self {
        let delay = within(timing.delay, plan.within[0]);
        // No torque begins before its count.
        let shifts = |jitter: f64, signs: &Option<Signs>| {
            signs.as_ref().map_or([0.0; 3], |_| [-jitter.min(delay), 0.0, jitter])
        };
        let torques = shifts(timing.jitters[0], &plan.jitter.torques);
        let counts = shifts(timing.jitters[1], &plan.jitter.counts).map(|shift| -shift);
        // The earliest count begins the period.
        let start = -counts.iter().copied().fold(0.0, f64::min);
        let counts = counts.map(|shift| start + shift);
        let torques = torques.map(|shift| start + delay + shift);
        // As the timer of the board counts.
        let late = if plan.pattern.delays() { start + plan.delay } else { start };
        // A tick is so much later than the position that it reads.
        let update = |i| start + timing.age + f64::from(i) / f64::from(timing.updates);
        let updates: Vec<f64> = (0..timing.updates).map(update).collect();
        let mut all = vec![0.0];
        // An error is filtered in small steps.
        let pieces =
            if plan.readings.waves[1] > 0.0 && timing.sensor.most > 0.0 { PIECES } else { 0 };
        let pieces: Vec<_> = (0..pieces).map(|i| f64::from(i) / f64::from(PIECES)).collect();
        for at in counts.iter().chain(&torques).chain([&late]).chain(&updates).chain(&pieces) {
            let part = part(*at);
            if all.iter().all(|known: &f64| (known - part).abs() > SAME) {
                all.push(part);
            }
        }
        all.sort_by(f64::total_cmp);
        let instant = |at: f64| -> Instant {
            let near = |known: &f64| (known - part(at)).abs() <= SAME;
            ((at + SAME) as u32, all.iter().position(near).unwrap_or(0))
        };
        let lags = timing.lags_at(plan.within[1]);
        let held = HeldDevice::new(&plan.hand, damping, &lags);
        let ends = all.iter().skip(1).copied().chain([1.0]);
        let lengths = all.iter().zip(ends).map(|(from, to)| to - from);
        let step = |part: f64| if audited { held.audited(part) } else { held.step(part) };
        Self {
            held,
            lags,
            steps: lengths.map(step).collect(),
            counts: counts.map(instant),
            delayed: instant(late),
            torques: torques.map(instant),
            updates: updates.into_iter().map(|at| instant(at).1).collect(),
        }
    }

    /// When a count is read that comes so early (-1), in time (0) or late (1).
    pub fn count(&self, shift: i8) -> Instant {
        place(&self.counts, shift)
    }

    /// When a torque begins that comes so early (-1), in time (0) or late (1).
    pub fn torque(&self, shift: i8) -> Instant {
        place(&self.torques, shift)
    }
}

fn place(instants: &[Instant; 3], shift: i8) -> Instant {
    match shift {
        ..0 => instants[0],
        0 => instants[1],
        1.. => instants[2],
    }
}

/// The part of a period after the last whole one.
fn part(at: f64) -> f64 {
    let part = at - (at + SAME).floor();
    part.max(0.0)
}

/// Timer counts after the beginning of a period.
pub fn timer_counts(part: f64) -> u32 {
    (part * f64::from(PERIOD)) as u32
}
