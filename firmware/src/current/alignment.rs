//! The alignment of a brushless motor: a field turns slowly, the magnets follow it, and the counts give the
//! phase.
//!
//! ```text
//! current  /-----------------------------------------------------\
//! angle    0   0  90  180  270  360  450  360  270  180  90   0
//! ```
//!
//! At each stop the handle settles, and its count is stored. From 90 to 450 degrees and from 360 back to 0
//! there is a whole electrical turn between two stops that are approached from the same side, so that neither
//! friction nor cogging changes the number of counts between them. The phase is the mean over all stops
//! except the first, which the magnets may not have reached. With equal friction in both directions, friction
//! cancels in the mean.

use super::current_loop::CurrentLoop;
use super::fault::AlignmentError;
use super::modulation::Duties;
use super::phase::{PhaseAlignment, Turn};

/// Current of the field, relative to the current of full-scale torque.
const PART: f32 = 0.25;

/// Durations in s: a ramp of the current, a quarter of a turn, and a stop.
const RAMP: f64 = 0.3;
const QUARTER: f64 = 0.3;
const STOP: f64 = 0.25;

/// The number of stops, and the stop after which the field turns back.
const STOPS: usize = 11;
const FORTH: usize = 5;

/// Largest deviation of the handle's motion from an electrical turn, as a part of it.
const TOLERANCE: f32 = 0.125;

/// Largest distance of a stop from the mean, in parts of a turn of 2^32: a twelfth of a turn, at which 13 per
/// cent of the torque would be lost.
const SPREAD: u32 = u32::MAX / 12;

/// The field that an alignment requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Field {
    /// Electrical angle in parts of a turn of 2^32.
    pub angle: u32,
    /// Current relative to the current of full-scale torque.
    pub current: f32,
}

/// The result of an instant of an alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlignmentStep {
    /// The alignment continues: compare values for the next instant.
    Turning(Duties),
    /// The alignment has ended with this result; switch the gates off.
    Ended(Result<PhaseAlignment, AlignmentError>),
}

/// A running alignment.
#[derive(Clone, Copy, Debug)]
pub struct Alignment {
    /// Instants of a ramp, of a quarter turn, and of a stop.
    ramp: u32,
    quarter: u32,
    stop: u32,
    is_brushed: bool,
    state: State,
    /// Instants in this state.
    time: u32,
    /// Counts since the beginning, and their sum over the second half of a stop.
    moved: i32,
    sum: i64,
    /// The handle's position in its turn at the beginning.
    begin: Turn,
    stops: [i32; STOPS],
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Rising,
    /// At a stop.
    At(usize),
    /// From a stop to the next one.
    From(usize),
    Falling,
    Ended,
}

/// The part by which the counts of an electrical turn may differ from those of a motor with so many pole pairs: one
/// more or less differs by twice as much.
pub const fn tolerance(pole_pairs: u16) -> f32 {
    TOLERANCE.min(0.5 / (1.0 + pole_pairs as f32))
}

/// The position of a stop in quarters of a turn.
const fn quarters(stop: usize) -> u32 {
    (if stop <= FORTH { stop } else { 2 * FORTH - stop }) as u32
}

impl Alignment {
    pub(super) const fn new(design: &CurrentLoop, begin: Turn) -> Self {
        let instants = 1.0 / design.instant();
        let is_brushed = !design.is_brushless();
        Self {
            ramp: (RAMP * instants) as u32,
            quarter: (QUARTER * instants) as u32,
            stop: (STOP * instants) as u32,
            is_brushed,
            state: if is_brushed { State::Ended } else { State::Rising },
            time: 0,
            moved: 0,
            sum: 0,
            begin,
            stops: [0; STOPS],
        }
    }

    /// An instant in which the handle moved by `moved` counts; returns the field for the next instant, and
    /// `None` after the end.
    pub(super) const fn step(&mut self, moved: i32) -> Option<Field> {
        self.moved = self.moved.wrapping_add(moved);
        self.time += 1;
        let (angle, part) = match self.state {
            State::Rising => (0, self.time as f32 / self.ramp as f32),
            State::At(stop) => (quarters(stop) << 30, 1.0),
            State::From(stop) => (self.angle_from(stop), 1.0),
            State::Falling => (0, 1.0 - self.time as f32 / self.ramp as f32),
            State::Ended => return None,
        };
        self.go_on();
        Some(Field { angle, current: PART * part })
    }

    const fn angle_from(&self, stop: usize) -> u32 {
        let part = ((self.time as u64) << 30) / self.quarter as u64;
        let from = quarters(stop) << 30;
        if stop < FORTH { from.wrapping_add(part as u32) } else { from.wrapping_sub(part as u32) }
    }

    const fn go_on(&mut self) {
        let (next, lasts) = match self.state {
            State::Rising => (State::At(0), self.ramp),
            State::At(stop) => {
                if self.time > self.stop / 2 {
                    self.sum += self.moved as i64;
                }
                let next = if stop + 1 < STOPS { State::From(stop) } else { State::Falling };
                (next, self.stop)
            }
            State::From(stop) => (State::At(stop + 1), self.quarter),
            State::Falling => (State::Ended, self.ramp),
            State::Ended => return,
        };
        if self.time < lasts {
            return;
        }
        if let State::At(stop) = self.state {
            self.stops[stop] = (self.sum / (self.stop - self.stop / 2) as i64) as i32;
            self.sum = 0;
        }
        (self.state, self.time) = (next, 0);
    }

    /// The result, after the end: an error if the handle did not follow the field like the magnets of such a motor.
    pub(super) fn result(&self) -> Result<PhaseAlignment, AlignmentError> {
        if self.is_brushed {
            return Err(AlignmentError::NotNeeded);
        }
        let turn = self.begin.counts_per_electrical_turn();
        let expected = turn as i32;
        let moved = self.stops[FORTH] - self.stops[FORTH - 4];
        let returned = self.stops[FORTH + 1] - self.stops[FORTH + 5];
        if moved.unsigned_abs() < expected.unsigned_abs() / 8 {
            return Err(AlignmentError::Blocked { moved, expected });
        }
        let tolerance = tolerance(self.begin.pole_pairs);
        if (moved.abs() as f32 - turn).abs() > tolerance * turn {
            return Err(AlignmentError::PolePairs { moved, expected });
        }
        if (moved - returned).abs() as f32 > 2.0 * tolerance * turn {
            return Err(AlignmentError::NotReturned { moved, returned });
        }
        self.offset(moved < 0)
    }

    /// The mean of all stops except the first.
    fn offset(&self, is_reversed: bool) -> Result<PhaseAlignment, AlignmentError> {
        let at = |stop: usize| {
            let mut turn = self.begin;
            turn.move_by(self.stops[stop]);
            let since_zero = PhaseAlignment { offset: 0, is_reversed }.angle(turn.angle());
            (quarters(stop) << 30).wrapping_sub(since_zero)
        };
        let from_first = |stop: usize| i64::from(at(stop).wrapping_sub(at(1)).cast_signed());
        let mean = (1..STOPS).map(from_first).sum::<i64>() / (STOPS as i64 - 1);
        let offset = at(1).wrapping_add(mean as u32);
        let off = |stop: usize| at(stop).wrapping_sub(offset).cast_signed().unsigned_abs();
        let worst = (1..STOPS).map(off).fold(0, u32::max);
        if worst > SPREAD {
            let degrees = |angle: u32| ((u64::from(angle) * 360) >> 32) as i32;
            return Err(AlignmentError::Uneven {
                degrees: degrees(worst),
                largest: degrees(SPREAD) + 1,
            });
        }
        Ok(PhaseAlignment { offset, is_reversed })
    }
}
