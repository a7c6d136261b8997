//! Slow whole turns in both directions: friction, damping, and the cogging over the angle (theory, section 3.5).
//!
//! Over a whole turn the torque of cogging takes no energy, so that the mean torque is that of friction, damping
//! and load alone. With three speeds in both directions they are told from each other. Half of the difference of
//! both directions at an angle is the friction there, half of their sum the cogging.
//!
//! The balance `F = m a + b v + s f(x) - c(x)` holds in the mean over two periods that rise and fall like a roof:
//! there `m a` is exactly `m` times the second difference of the angle, whatever the device does in between.
//! Where the device is turned by a constant torque, all of the cogging is in that term.

mod error;
mod expansion;
mod linearity;
mod whole;

pub use error::TurnsError;
pub use expansion::Floor;
pub use linearity::{Linearity, linearity};

use std::f64::consts::TAU;

use expansion::{BASES, Expansion, Means, Part, Row, Sought};
use nalgebra::Complex;
use whole::{Motion, Turn};

use super::estimate::Estimate;
use super::record::Record;
use super::response::Correction;
use crate::disturbance::{Cogging, Sine};

const INERTIA: usize = 0;
const DAMPING: usize = 1;
const FRICTION: usize = 2;
const MEAN: usize = 3;
const LOUD: usize = 4;

/// Harmonics of an encoder's nonlinearity that count: those of an axis beside the middle and of a tilted magnet.
const BY_NONLINEARITY: [u32; 2] = [1, 2];
/// Highest harmonic that is looked for.
const HIGHEST: u32 = 512;
/// Highest harmonic of the friction over the angle that is looked for.
const HIGHEST_ODD: u32 = 16;
/// Counts in a period of a harmonic that can be told.
const COUNTS: f64 = 8.0;
/// Largest phase in rad that a harmonic may advance in half of a window.
const PHASE: f64 = 0.5;
/// Samples of the map in a period of its highest harmonic: a straight line between two of them is off by at most
/// 2 % of that harmonic.
const SAMPLES: u32 = 16;
/// Fewest samples of a map.
const LEAST_SAMPLES: u32 = 32;
/// Ratio of the torque that harmonics are below at an angle, with the confidence of 95 %, to their root mean square.
/// Of any number of sines whose phases have nothing to do with each other it is at most `sqrt(2 ln(2/0.05))`: the
/// exponential moment of a sine is at most that of a normal distribution with its variance (Hoeffding).
const EACH: f64 = 2.717;
/// Part of the largest torque above which an amplifier that clips would show.
const IS_LOUD: f64 = 0.75;
/// Part of an added torque that may be missing.
const MISSING: f64 = 0.3;

/// A harmonic over the angle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Harmonic {
    /// Periods in a turn.
    pub count: u32,
    /// In N m, or in rad where it is one of an angle.
    pub amplitude: Estimate,
    /// In rad: that of `amplitude sin(count x + phase)` for the torque that opposes cogging, or for an angle.
    pub phase: f64,
}

/// What slow turns show of a device.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowTurns {
    /// Inertia in kg m^2.
    pub inertia: Estimate,
    /// Damping in N m s/rad.
    pub damping: Estimate,
    /// Mean Coulomb friction over the turn in N m.
    pub friction: Estimate,
    /// The least over the turn in N m; the upper end is that of the least, too.
    pub least_friction: Estimate,
    /// Mean torque in N m on the device besides: of a load, of the amplifier's offset, and of the map.
    pub mean: Estimate,
    /// Cogging and mean in N m at equally spaced angles of a turn, the first at zero: the torque on the device,
    /// positive in the direction of the angle.
    pub map: Vec<f64>,
    /// Half of the interval of each torque of the map in N m, with all harmonics up to `highest` in it, those that
    /// were not found included: what remains of the cogging where the map opposes it.
    pub uncertainty: f64,
    /// The highest harmonic that the uncertainty includes.
    pub highest: u32,
    /// Harmonics of the cogging, the largest first.
    pub harmonics: Vec<Harmonic>,
    /// Harmonics of the friction over the angle.
    pub friction_harmonics: Vec<u32>,
    /// What harmonics of the cogging would not have been found, in N m.
    pub floors: Vec<Floor>,
    /// Number of turns forward and back.
    pub turns: [usize; 2],
    /// Least and largest mean speed of a turn in rad/s.
    pub speeds: [f64; 2],
}

/// Friction, damping and cogging from a record of slow turns.
///
/// # Errors
/// If the record is not one of whole turns in both directions at three speeds, or if the motor did not give its
/// torques.
pub fn slow_turns(record: &Record, correction: &Correction) -> Result<SlowTurns, TurnsError> {
    let angles: Vec<f64> =
        record.counts.iter().map(|count| count * correction.count_angle).collect();
    let motion =
        Motion { angles: &angles, count_angle: correction.count_angle, period: record.period };
    let turns = motion.turns(true)?;
    let balance = Balance { record, motion, late: correction.delay() };
    let speeds = turns.iter().map(|turn| turn.speed);
    let [slowest, fastest] =
        [speeds.clone().fold(f64::INFINITY, f64::min), speeds.fold(0.0, f64::max)];
    let highest = highest(&motion, slowest);
    let too_few = TurnsError::TooFew { turns: turns.len() };
    let sought = Sought {
        bases: LOUD,
        certain: &[],
        fast: &BY_NONLINEARITY,
        highest,
        highest_odd: HIGHEST_ODD,
    };
    let found = Expansion::of(|highest| balance.rows(&turns, highest), &sought);
    let found = found.ok_or(too_few.clone())?;
    let [friction, _] = found.number(FRICTION);
    if friction < 0.0 && found.number(DAMPING)[0] < 0.0 {
        return Err(TurnsError::Reversed { torque: friction });
    }
    // With windows as long as the harmonics that are there allow, in which there is less noise: weaker ones stand
    // out, too.
    let steepest = found.steepest();
    let mut rows = balance.rows(&turns, steepest);
    let found = found.refined(&rows, HIGHEST_ODD).ok_or(too_few.clone())?;
    balance.check_clipping(&rows, &found)?;
    // The speed in a window is not steady, because of the cogging that is sought.
    let means = balance.means(&turns, steepest, &found);
    let by_angle = found.again_over(&rows, Some(&means)).ok_or(too_few.clone())?;
    let count = |sign: f64| turns.iter().filter(|turn| turn.sign == sign).count();
    let (turned, speeds) = ([count(1.0), count(-1.0)], [slowest, fastest]);
    // Where each row counts by its angle, harmonics that were not found average out, but noise that moves the
    // device counts more where it moves it on; where each counts by its time, it is the other way round.
    rows.iter_mut().for_each(|row| row.weight = turns[row.turn].speed * record.period);
    let by_time = found.again_over(&rows, Some(&means)).ok_or(too_few)?;
    let [by_angle, by_time] =
        [by_angle, by_time].map(|found| SlowTurns::of(&found, turned, speeds));
    Ok(by_angle.covering(&by_time))
}

impl SlowTurns {
    fn of(found: &Expansion, turns: [usize; 2], speeds: [f64; 2]) -> Self {
        let (map, reach) = map(found);
        Self {
            inertia: estimate(found.number(INERTIA)),
            damping: estimate(found.number(DAMPING)),
            friction: estimate(found.number(FRICTION)),
            least_friction: least_friction(found, map.len()),
            mean: estimate(opposed(found.number(MEAN))),
            map,
            uncertainty: reach.hypot(EACH * found.left_out),
            highest: found.top(),
            harmonics: harmonics(found),
            friction_harmonics: found.odd.clone(),
            floors: found.floors.clone(),
            turns,
            speeds,
        }
    }

    /// Largest torque in N m of the map besides its mean.
    pub fn largest(&self) -> f64 {
        let mean = self.map.iter().sum::<f64>() / self.map.len() as f64;
        self.map.iter().fold(0.0, |most: f64, torque| most.max((torque - mean).abs()))
    }

    /// Whether the map is told from noise: where it opposes the cogging, less remains than without it.
    pub fn tells_cogging(&self) -> bool {
        !self.harmonics.is_empty() && self.uncertainty < self.largest()
    }

    /// The harmonics of the cogging over the angle of the device, where the encoder shows `x + linearity sin(x)` as
    /// that of a simulation does: a servo that reads it then finds the map there.
    pub fn cogging(&self, linearity: f64) -> Vec<Sine> {
        /// Part of the largest amplitude from which on a harmonic counts.
        const LEAST: f64 = 0.02;
        let own = self.harmonics.iter().map(|harmonic| {
            let (torque, count) = (harmonic.amplitude.value, f64::from(harmonic.count));
            Sine { torque, count, phase: harmonic.phase }
        });
        let own: Vec<Sine> = own.collect();
        if linearity == 0.0 || own.is_empty() {
            return own;
        }
        let own = Cogging::of(own);
        let angles = 8 * HIGHEST;
        let torque = |sample: u32| {
            let angle = TAU * f64::from(sample) / f64::from(angles);
            (angle, -own.at(angle + linearity * angle.sin()))
        };
        let torques: Vec<(f64, f64)> = (0..angles).map(torque).collect();
        let sine = |count: u32| {
            let count = f64::from(count);
            let turned = torques.iter().map(|&(angle, torque)| {
                Complex::from_polar(2.0 / f64::from(angles) * torque, -count * angle)
            });
            let sum: Complex<f64> = turned.sum();
            // `A sin(N x + p)` has `-j A e^(j p)` as its complex amplitude.
            let phasor = sum * Complex::i();
            Sine { torque: phasor.norm(), count, phase: phasor.arg() }
        };
        let mut all: Vec<Sine> = (1..=HIGHEST).map(sine).collect();
        all.sort_by(|a, b| b.torque.total_cmp(&a.torque));
        let most = all[0].torque;
        all.retain(|sine| sine.torque >= LEAST * most);
        all
    }

    /// The same with intervals that hold those of another fit of the same harmonics.
    fn covering(self, other: &Self) -> Self {
        let apart = self.map.iter().zip(&other.map).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let same = |count: u32| other.harmonics.iter().find(|harmonic| harmonic.count == count);
        let wider = |harmonic: &Harmonic| Harmonic {
            amplitude: same(harmonic.count)
                .map_or(harmonic.amplitude, |same| covering(harmonic.amplitude, same.amplitude)),
            ..*harmonic
        };
        Self {
            inertia: covering(self.inertia, other.inertia),
            damping: covering(self.damping, other.damping),
            friction: covering(self.friction, other.friction),
            least_friction: covering(self.least_friction, other.least_friction),
            mean: covering(self.mean, other.mean),
            uncertainty: self.uncertainty.max(other.uncertainty) + apart,
            harmonics: self.harmonics.iter().map(wider).collect(),
            ..self
        }
    }
}

/// An estimate whose interval holds that of another.
fn covering(one: Estimate, other: Estimate) -> Estimate {
    Estimate { lo: one.lo.min(other.lo), hi: one.hi.max(other.hi), ..one }
}

fn opposed([value, reach]: [f64; 2]) -> [f64; 2] {
    [-value, reach]
}

fn estimate([value, reach]: [f64; 2]) -> Estimate {
    Estimate { value, lo: value - reach, hi: value + reach }
}

/// The highest harmonic that the encoder's counts and the slowest turns can show.
fn highest(motion: &Motion<'_>, slowest: f64) -> u32 {
    let by_counts = TAU / motion.count_angle / COUNTS;
    let by_speed = 2.0 / (slowest * motion.period);
    f64::from(HIGHEST).min(by_counts).min(by_speed).max(1.0) as u32
}

/// The balance of torques over a record.
struct Balance<'a> {
    record: &'a Record,
    motion: Motion<'a>,
    /// Time in s by which a row's torque acts after the position of its counts.
    late: f64,
}

impl Balance<'_> {
    /// The rows of all turns, with windows in which a harmonic of this order is still seen.
    fn rows(&self, turns: &[Turn], order: u32) -> Vec<Row> {
        let most = self.record.torque.iter().fold(0.0, |most: f64, torque| most.max(torque.abs()));
        let row = |(number, row, half)| self.row(number, &turns[number], row, half, IS_LOUD * most);
        self.windows(turns, order).map(row).collect()
    }

    /// The turn, the row of the record, and half of the width in periods of each of these windows.
    fn windows(&self, turns: &[Turn], order: u32) -> impl Iterator<Item = (usize, usize, usize)> {
        let look = self.motion.look();
        turns.iter().enumerate().flat_map(move |(number, turn)| {
            let advance = f64::from(order) * turn.speed * self.motion.period;
            let half = ((2.0 * PHASE / advance) as usize).clamp(1, look);
            // The roof and the torque before it are in the record, but at its very ends.
            let begin = turn.rows.start.max(3 * look + 2);
            let end = turn.rows.end.min(self.record.torque.len() - look);
            (begin..end).map(move |row| (number, row, half))
        })
    }

    /// The means of the harmonics that were found over the same windows, for an angle that is a straight line
    /// between two counts.
    fn means(&self, turns: &[Turn], order: u32, found: &Expansion) -> Means {
        let of = |harmonic: u32| {
            let ticks = self.over_ticks(f64::from(harmonic));
            let mean = |(_, row, half): (usize, usize, usize)| {
                let falls = |away: usize| {
                    let [flat, rising] = ticks[row + away];
                    flat * (half - away) as f64 - rising
                };
                let rises = |away: usize| {
                    let [flat, rising] = ticks[row - 1 - away];
                    flat * (half - away - 1) as f64 + rising
                };
                let sum: Complex<f64> = (0..half).map(|away| falls(away) + rises(away)).sum();
                let mean = sum / (half * half) as f64;
                [mean.re, mean.im]
            };
            (harmonic, self.windows(turns, order).map(mean).collect())
        };
        found.orders().map(of).collect()
    }

    /// Integrals of `e^(j n x)` over each period, without a weight, and with a weight that rises from 0 to 1.
    fn over_ticks(&self, harmonic: f64) -> Vec<[Complex<f64>; 2]> {
        let of = |pair: &[f64]| {
            let begin = Complex::from_polar(1.0, harmonic * pair[0]);
            let turn = Complex::new(0.0, harmonic * (pair[1] - pair[0]));
            // Beside it the exponential function cancels.
            if turn.im.abs() < 1e-3 {
                let (half, square) = (turn / 2.0, turn * turn);
                return [
                    begin * (half + square / 6.0 + 1.0),
                    begin * (turn / 3.0 + square / 8.0 + 0.5),
                ];
            }
            let end = turn.exp();
            [begin * (end - 1.0) / turn, begin * (end / turn - (end - 1.0) / (turn * turn))]
        };
        self.motion.angles.windows(2).map(of).collect()
    }

    fn row(&self, number: usize, turn: &Turn, row: usize, half: usize, loud: f64) -> Row {
        let Motion { angles, period, .. } = self.motion;
        let look = self.motion.look();
        let time = half as f64 * period;
        let bend = angles[row + half] - 2.0 * angles[row] + angles[row - half];
        let way = angles[row + half] - angles[row - half];
        let velocity = (angles[row + look] - angles[row - look]) / (2.0 * look as f64 * period);
        let (torque, before) = (self.torque(row, half), self.torque(row - 2 * look, half));
        let beyond = torque.signum() * (torque.abs() - loud).max(0.0);
        let of = |acceleration, velocity| [acceleration, velocity, turn.sign, 1.0, beyond];
        Row {
            turn: number,
            value: torque,
            bases: of(bend / (time * time), way / (2.0 * time)),
            // The command has neither the encoder's noise nor that of the torque, which moves the device, too.
            instruments: of(torque - before, torque),
            angle: angles[row],
            sign: turn.sign,
            velocity,
            weight: velocity.abs() * period,
            reach: 0.5 * velocity.abs() * time,
        }
    }

    /// Mean in N m of the torque that acts, over `half` periods before and behind a row that rise and fall like a
    /// roof.
    fn torque(&self, row: usize, half: usize) -> f64 {
        let late = self.late / self.motion.period;
        let (whole, part) = (late.floor(), late - late.floor());
        let mean = |row: usize| -> f64 {
            let height = |away: usize| (half as f64 - away as f64 - 0.5) / (half * half) as f64;
            let torques = &self.record.torque;
            (0..half)
                .map(|away| height(away) * (torques[row + away] + torques[row - 1 - away]))
                .sum()
        };
        let row = row.saturating_sub(whole as usize).max(half + 1);
        (1.0 - part) * mean(row) + part * mean(row - 1)
    }

    /// Refuses a record in which the largest torques did not reach the device.
    fn check_clipping(&self, rows: &[Row], found: &Expansion) -> Result<(), TurnsError> {
        let has_loud = rows.iter().filter(|row| row.bases[LOUD] != 0.0).count() * 100 > rows.len();
        if !has_loud {
            return Ok(());
        }
        let without = |row: &Row| Row { value: row.value - found.series_in(row), ..*row };
        let without: Vec<Row> = rows.iter().map(without).collect();
        let sought = Sought { bases: BASES, certain: &[], fast: &[], highest: 0, highest_odd: 0 };
        let Some(loud) = Expansion::of(|_| without.clone(), &sought) else { return Ok(()) };
        let [part, reach] = loud.number(LOUD);
        if part - reach <= MISSING {
            return Ok(());
        }
        let most = self.record.torque.iter().fold(0.0, |most: f64, torque| most.max(torque.abs()));
        Err(TurnsError::Clipped { torque: IS_LOUD * most, part: part.min(1.0) })
    }
}

/// The map of the mean and the cogging, and half of its widest interval.
fn map(found: &Expansion) -> (Vec<f64>, f64) {
    let highest = found.even.iter().max().map_or(0, |order| *order);
    let samples = (SAMPLES * highest).next_power_of_two().max(LEAST_SAMPLES);
    let at = |sample: u32| {
        let angle = TAU * f64::from(sample) / f64::from(samples);
        // The command opposes what acts on the device.
        let [command, reach] = found.series(Part::Even(MEAN), angle);
        [-command, reach]
    };
    let all: Vec<[f64; 2]> = (0..samples).map(at).collect();
    let reach = all.iter().fold(0.0, |most: f64, [_, reach]| most.max(*reach));
    (all.iter().map(|[torque, _]| *torque).collect(), reach)
}

/// The least friction over the turn.
fn least_friction(found: &Expansion, samples: usize) -> Estimate {
    let at =
        |sample: usize| found.series(Part::Odd(FRICTION), TAU * sample as f64 / samples as f64);
    let none = Estimate { value: f64::INFINITY, lo: f64::INFINITY, hi: f64::INFINITY };
    (0..samples).map(at).fold(none, |least, at| {
        let Estimate { value, lo, hi } = estimate(at);
        let least =
            Estimate { value: least.value.min(value), lo: least.lo.min(lo), hi: least.hi.min(hi) };
        Estimate { value: least.value.max(0.0), lo: least.lo.max(0.0), hi: least.hi }
    })
}

fn harmonics(found: &Expansion) -> Vec<Harmonic> {
    let of = |(index, count): (usize, &u32)| {
        let amplitude = estimate(found.amplitude(index));
        Harmonic { count: *count, amplitude, phase: found.phase(index) }
    };
    let mut harmonics: Vec<Harmonic> = found.even.iter().enumerate().map(of).collect();
    harmonics.sort_by(|a, b| b.amplitude.value.total_cmp(&a.amplitude.value));
    harmonics
}

#[cfg(test)]
mod tests;
