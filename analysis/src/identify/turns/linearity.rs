//! The integral nonlinearity (INL) of an encoder, its age and its hysteresis, by a second encoder on the same
//! shaft.
//!
//! From the angle `x` of the second encoder the first shows `x + e(x) - a v - s h/2`: the error `e` stays with the
//! angle, the age `a` with the speed, the hysteresis `h` with the direction.

use std::f64::consts::{PI, TAU};

use super::error::{LEAST_SPREAD, TurnsError};
use super::expansion::{Expansion, Floor, Part, Row, Sought};
use super::whole::Motion;
use super::{COUNTS, HIGHEST, Harmonic, estimate, harmonics};
use crate::identify::estimate::Estimate;
use crate::identify::record::Pair;

const HYSTERESIS: usize = 1;
const AGE: usize = 2;

/// Eccentricity and tilt of a magnet or a disk are in these harmonics.
const CERTAIN: [u32; 2] = [1, 2];
/// Points in a period of the highest harmonic at which the slope is computed.
const POINTS: u32 = 64;
/// Largest part of a turn by which the two encoders may be apart in a record.
const LARGEST: f64 = 0.25;

/// The error of an encoder over the angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearity {
    /// Largest slope of the error. The upper end is a bound over all angles, for the harmonics that were found.
    pub slope: Estimate,
    /// Largest error in rad, with half of its interval on either side.
    pub error: Estimate,
    /// Harmonics of the error in rad, the largest first.
    pub harmonics: Vec<Harmonic>,
    /// What harmonics would not have been found, in rad.
    pub floors: Vec<Floor>,
    /// Age in s of a reading at the time of the second encoder's; `None` where all turns have nearly one speed.
    pub age: Option<Estimate>,
    /// Hysteresis in rad.
    pub hysteresis: Estimate,
    /// Number of whole turns.
    pub turns: usize,
}

/// The nonlinearity of the counts of a record against its second encoder, each with the angle in rad of a count.
///
/// # Errors
/// If the record has no whole turns in both directions, or if the two encoders are not on one shaft.
pub fn linearity(
    pair: &Pair,
    count_angle: f64,
    reference_angle: f64,
) -> Result<Linearity, TurnsError> {
    let angles: Vec<f64> = pair.reference.iter().map(|count| count * reference_angle).collect();
    let motion = Motion { angles: &angles, count_angle: reference_angle, period: pair.period };
    let turns = motion.turns(false)?;
    let shown = |row: usize| pair.counts[row] * count_angle;
    for turn in &turns {
        let way = |of: &dyn Fn(usize) -> f64| (of(turn.rows.end) - of(turn.rows.start)) / TAU;
        let (counts, reference) = (way(&shown), way(&|row| angles[row]));
        if (counts - reference).abs() > LARGEST {
            return Err(TurnsError::NotOneShaft { counts, reference });
        }
    }
    let speeds = || turns.iter().map(|turn| turn.speed);
    let slowest = speeds().fold(f64::INFINITY, f64::min);
    let has_speeds = speeds().fold(0.0, f64::max) >= LEAST_SPREAD * slowest;
    let bases = if has_speeds { 3 } else { 2 };
    let (look, origin) = (motion.look(), shown(turns[0].rows.start) - angles[turns[0].rows.start]);
    let of_turn = |(number, turn): (usize, &super::whole::Turn)| {
        let sign = turn.sign;
        let angles = &angles;
        turn.rows.clone().map(move |row| {
            let moved = angles[row + look] - angles[row - look];
            let velocity = moved / (2.0 * look as f64 * pair.period);
            let factors = [1.0, -0.5 * sign, -velocity, 0.0, 0.0];
            Row {
                turn: number,
                value: shown(row) - angles[row] - origin,
                bases: factors,
                instruments: factors,
                angle: angles[row],
                sign,
                velocity,
                weight: velocity.abs() * pair.period,
                reach: 0.0,
            }
        })
    };
    let rows: Vec<Row> = turns.iter().enumerate().flat_map(of_turn).collect();
    let coarser = count_angle.max(reference_angle);
    let highest = f64::from(HIGHEST).min(TAU / coarser / COUNTS).max(2.0) as u32;
    let sought = Sought { bases, certain: &CERTAIN, fast: &[], highest, highest_odd: 0 };
    let found = Expansion::of(|_| rows.clone(), &sought)
        .ok_or(TurnsError::TooFew { turns: turns.len() })?;
    let hysteresis = estimate(found.number(HYSTERESIS));
    Ok(Linearity {
        slope: largest(&found, Part::Slope),
        error: largest(&found, Part::Series),
        harmonics: harmonics(&found),
        floors: found.floors.clone(),
        age: has_speeds.then(|| estimate(found.number(AGE))),
        hysteresis: Estimate { lo: hysteresis.lo.max(0.0), ..hysteresis },
        turns: turns.len(),
    })
}

/// The largest size of a series. Between points that are an `n`-th of a period of the highest harmonic apart it
/// is at most `1/cos(pi/n)` times its largest at the points (Ehlich and Zeller).
fn largest(found: &Expansion, part: Part) -> Estimate {
    let points = POINTS * found.even.iter().max().map_or(1, |order| *order);
    let between = (PI / f64::from(POINTS)).cos().recip();
    let at = |point: u32| found.series(part, TAU * f64::from(point) / f64::from(points));
    let none = Estimate { value: 0.0, lo: 0.0, hi: 0.0 };
    (0..points).map(at).fold(none, |most, [value, reach]| {
        let size = value.abs();
        Estimate {
            value: most.value.max(size),
            lo: most.lo.max(size - reach),
            hi: most.hi.max(between * (size + reach)),
        }
    })
}
