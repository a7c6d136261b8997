//! The whole turns of a record: stretches in which the device moves on in one direction by a turn.

use std::f64::consts::TAU;
use std::ops::Range;

use super::error::{LEAST_SPREAD, TurnsError};

/// Time in s to either side of a row over which its motion is looked at.
const LOOK: f64 = 0.01;
/// Counts over that time up to which the device may stand still: those of noise.
const STILL: f64 = 6.0;
/// Time in s for which it may seem to stand still in the middle of a motion.
const FLICKER: f64 = 0.005;
/// Smallest ratio of two speeds that are not the same.
const APART: f64 = 1.1;
/// Fewest speeds in each direction.
const SPEEDS: usize = 3;

/// A whole turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// Its rows; the motion is the same for [`Motion::look`] rows before and behind.
    pub rows: Range<usize>,
    /// 1 or -1.
    pub sign: f64,
    /// Mean speed in rad/s.
    pub speed: f64,
}

/// The angles in rad of a record, over time.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Angles in rad.
    pub angles: &'a [f64],
    /// Angle in rad of a count.
    pub count_angle: f64,
    /// Period in s.
    pub period: f64,
}

impl Motion<'_> {
    /// Rows to either side of a row over which its motion is looked at.
    pub fn look(&self) -> usize {
        (LOOK / self.period).round().max(2.0) as usize
    }

    /// Direction of the motion at a row: 1, -1, or 0 where it may stand still.
    fn direction(&self, row: usize) -> f64 {
        let moved = self.angles[row + self.look()] - self.angles[row - self.look()];
        if moved.abs() > STILL * self.count_angle { moved.signum() } else { 0.0 }
    }

    /// The whole turns, in the order of the record.
    ///
    /// # Errors
    /// If they are not in both directions, or where they have to be of three speeds, of fewer.
    pub fn turns(&self, needs_speeds: bool) -> Result<Vec<Turn>, TurnsError> {
        let look = self.look();
        let (mut turns, mut stops, mut first_stop) = (Vec::new(), 0, 0);
        let (mut farthest, mut before) = (0.0_f64, 0.0);
        for (rows, sign) in self.runs() {
            // A motion that goes on in the same direction had stopped.
            if sign == before {
                stops += 1;
                first_stop = if stops == 1 { rows.start } else { first_stop };
            }
            before = sign;
            let moved = (self.angles[rows.end - 1] - self.angles[rows.start]).abs();
            farthest = farthest.max(moved);
            turns.extend(self.cut(rows, sign));
        }
        if turns.is_empty() && stops > 0 && farthest < TAU {
            let time = first_stop as f64 * self.period;
            return Err(TurnsError::StickSlip { stops, row: first_stop + 1, time, farthest });
        }
        if turns.is_empty() {
            let rows = self.angles.len().saturating_sub(2 * look);
            return Err(TurnsError::NotWhole { farthest, rows });
        }
        let speeds = |sign: f64| {
            let of = turns.iter().filter(|turn: &&Turn| turn.sign == sign);
            let mut speeds: Vec<f64> = of.map(|turn| turn.speed).collect();
            speeds.sort_by(f64::total_cmp);
            speeds
        };
        let [forward, back] = [1.0, -1.0].map(speeds);
        if forward.is_empty() || back.is_empty() {
            let direction = if back.is_empty() { "forward" } else { "back" };
            return Err(TurnsError::OneDirection { turns: turns.len(), direction });
        }
        for (direction, speeds) in [("forward", &forward), ("back", &back)] {
            let [least, most] = [speeds[0], speeds[speeds.len() - 1]];
            let found = distinct(speeds);
            if needs_speeds && (found < SPEEDS || most < LEAST_SPREAD * least) {
                return Err(TurnsError::FewSpeeds { direction, found, least, most });
            }
        }
        Ok(turns)
    }

    /// Stretches of motion in one direction.
    fn runs(&self) -> Vec<(Range<usize>, f64)> {
        let (look, rows) = (self.look(), self.angles.len());
        let flicker = (FLICKER / self.period).round() as usize;
        let mut runs: Vec<(Range<usize>, f64)> = Vec::new();
        for row in look..rows.saturating_sub(look) {
            let sign = self.direction(row);
            if sign == 0.0 {
                continue;
            }
            match runs.last_mut() {
                Some((run, of)) if *of == sign && row <= run.end + flicker => run.end = row + 1,
                _ => runs.push((row..row + 1, sign)),
            }
        }
        runs.retain(|(run, _)| run.len() > look);
        runs
    }

    /// The whole turns of a stretch, one after the other from its end backwards: at its begin the speed changes
    /// most.
    fn cut(&self, rows: Range<usize>, sign: f64) -> Vec<Turn> {
        let (mut turns, mut end) = (Vec::new(), rows.end);
        for row in rows.clone().rev() {
            if sign * (self.angles[end - 1] - self.angles[row]) >= TAU {
                let speed = TAU / ((end - 1 - row) as f64 * self.period);
                turns.push(Turn { rows: row..end - 1, sign, speed });
                end = row + 1;
            }
        }
        turns.reverse();
        turns
    }
}

/// How many of the speeds, in ascending order, differ.
fn distinct(speeds: &[f64]) -> usize {
    let (mut count, mut last) = (0, 0.0);
    for speed in speeds {
        if *speed > APART * last {
            (count, last) = (count + 1, *speed);
        }
    }
    count
}
