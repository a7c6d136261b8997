//! The phase of a brushless motor and the speed of the handle from the counts of an encoder, and the encoder's
//! index. With an index, a motor that was aligned once need not be aligned after each reset. It also shows lost
//! counts.
//!
//! Angles are parts of an electrical turn in 32 bits, which wrap as turns do.

use super::fault::PowerFault;
use super::modulation::Vector;
use crate::encoder::{CounterWidth, RawCount};

/// Weight of the last instant's counts in the mean: a time constant of 32 instants, which makes a count of a
/// coarse encoder a small step of the phase.
const NEWEST: f32 = 1.0 / 32.0;

/// The position of the handle in its turn, in whole counts, so that no error accumulates over any number of
/// turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// From zero to the counts of a turn less one.
    pub count: i32,
    pub counts: i32,
    /// Electrical turns in a count, times 2^64: over a turn its rounding adds up to less than 2^-40 of a
    /// turn.
    scale: u64,
    /// Electrical turns in a turn.
    pub pole_pairs: u16,
}

impl Turn {
    /// The position at the count 0 of an encoder with `counts` counts per turn.
    pub(super) const fn new(counts: u32, pole_pairs: u16) -> Self {
        let whole = (pole_pairs as u128) << 64;
        // The quotient is below 2^59: no electrical turn has fewer than 64 counts.
        let scale = ((whole + counts as u128 / 2) / counts as u128) as u64;
        Self { count: 0, counts: counts.cast_signed(), scale, pole_pairs }
    }

    #[inline(always)]
    pub(super) const fn move_by(&mut self, step: i32) {
        let mut count = self.count.wrapping_add(step);
        if count < 0 {
            count = count.wrapping_add(self.counts);
        } else if count >= self.counts {
            count -= self.counts;
        }
        self.count = if 0 <= count && count < self.counts { count } else { self.far(step) };
    }

    /// The position after a step of more than a turn, which no handle makes.
    #[cold]
    #[inline(never)]
    const fn far(&self, step: i32) -> i32 {
        (self.count as i64 + step as i64).rem_euclid(self.counts as i64) as i32
    }

    /// Electrical angle since the count 0.
    #[inline(always)]
    pub(super) const fn angle(&self) -> u32 {
        self.angle_of(self.count.cast_unsigned())
    }

    /// Electrical angle of a number of counts.
    #[inline(always)]
    pub(super) const fn angle_of(&self, counts: u32) -> u32 {
        ((counts as u64).wrapping_mul(self.scale) >> 32) as u32
    }

    /// The number of counts nearest to an electrical angle, less than an electrical turn.
    pub(super) const fn electrical_counts(&self, angle: u32) -> u32 {
        let turns = angle as u128 * self.counts.cast_unsigned() as u128;
        let one = (self.pole_pairs as u128) << 32;
        // The quotient is at most the counts of a turn.
        let nearest = ((turns + one / 2) / one) as u32;
        let is_whole_turn = nearest as u128 * self.pole_pairs as u128 >= self.counts as u128;
        if is_whole_turn { 0 } else { nearest }
    }

    pub(super) const fn counts_per_electrical_turn(&self) -> f32 {
        self.counts as f32 / self.pole_pairs as f32
    }
}

/// The relation between the phase of a motor and the counts of its encoder: the result of an
/// [`Alignment`](super::Alignment).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhaseAlignment {
    /// Electrical angle at the count 0, in parts of a turn of 2^32.
    pub offset: u32,
    /// Whether the angle falls while the count rises: the encoder, or two of the motor's wires, are reversed.
    pub is_reversed: bool,
}

impl PhaseAlignment {
    /// The angle of the motor's magnets, from the encoder's angle since the count 0.
    #[inline(always)]
    pub(super) const fn angle(&self, since_zero: u32) -> u32 {
        let angle = if self.is_reversed { since_zero.wrapping_neg() } else { since_zero };
        self.offset.wrapping_add(angle)
    }

    /// The sign of a current or a speed in the direction of rising counts.
    #[inline(always)]
    pub(super) const fn sign(&self) -> f32 {
        if self.is_reversed { -1.0 } else { 1.0 }
    }
}

/// The mean of the counts in an instant, for the angle by which the phase turns until its voltage acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Speed {
    last: u32,
    width: CounterWidth,
    mean: f32,
}

impl Speed {
    pub(super) const fn new(width: CounterWidth) -> Self {
        Self { last: 0, width, mean: 0.0 }
    }

    /// Restarts the mean from zero.
    pub(super) const fn restart(&mut self) {
        self.mean = 0.0;
    }

    /// Counts since the last reading, less than half the counter's range. The first reading counts from the
    /// nearest zero.
    #[inline(always)]
    pub(super) const fn step(&mut self, position: RawCount) -> i32 {
        let step = self.since_last(position);
        self.last = position.bits();
        step
    }

    /// Counts from the last reading to a reading near it.
    #[inline(always)]
    pub(super) const fn since_last(&self, position: RawCount) -> i32 {
        let shift = self.width as u32;
        (position.bits().wrapping_sub(self.last) << shift).cast_signed() >> shift
    }

    /// Takes the counts of an instant; returns their mean.
    #[inline(always)]
    pub(super) const fn update(&mut self, counts: f32) -> f32 {
        self.mean += NEWEST * (counts - self.mean);
        self.mean
    }
}

/// Tolerance of the index in counts: its pulse has up to this width, and comes from both sides.
pub(super) const WIDTH: u32 = 4;

/// Current of a pulse of an [`OffsetCheck`], relative to the current of full-scale torque.
const PULSE_PART: f32 = 0.25;
/// Time in s of one direction of a pulse; the rest behind a pulse is as long.
const PULSE_TIME: f64 = 5e-3;
/// Least motion in counts that a torque shows.
const LEAST_MOTION: i32 = 4;
/// Stretches of a pulse: forward, back, and at rest; and of both pulses.
const PULSE_STRETCHES: u32 = 3;
const ALL_STRETCHES: u32 = 2 * PULSE_STRETCHES;

/// An index that comes once per turn of the encoder, as a program states it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderIndex {
    /// The motor's phase at the index, as the board reports it after an alignment. Without it the motor is
    /// aligned after each reset, and the index only detects lost counts.
    pub offset: Option<IndexOffset>,
}

/// The phase of a motor at its encoder's index. It is valid for this motor with its three wires in this order
/// and the encoder in this position on the shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct IndexOffset {
    /// Electrical angle at the index in encoder counts, less than an electrical turn.
    pub counts: u32,
    /// Whether that angle falls while the count rises.
    pub is_reversed: bool,
}

impl IndexOffset {
    /// The offset of an aligned motor whose index is at this position in the turn.
    pub(super) const fn of(phase: PhaseAlignment, index: Turn) -> Self {
        let counts = index.electrical_counts(phase.angle(index.angle()));
        Self { counts, is_reversed: phase.is_reversed }
    }

    /// The phase of a motor with this offset whose index is at this position in the turn.
    pub(super) const fn phase(self, index: Turn) -> PhaseAlignment {
        let since_zero = PhaseAlignment { offset: 0, is_reversed: self.is_reversed };
        let offset = index.angle_of(self.counts).wrapping_sub(since_zero.angle(index.angle()));
        PhaseAlignment { offset, is_reversed: self.is_reversed }
    }
}

/// Checks that an index is where the first one was, from the handle's positions in its turn.
pub(super) const fn check_index(first: Turn, at: Turn) -> Result<(), PowerFault> {
    let (count, aligned) = (at.count.cast_unsigned(), first.count.cast_unsigned());
    let apart = count.abs_diff(aligned);
    // The distance in either direction around the turn.
    let other_way = at.counts.cast_unsigned().saturating_sub(apart);
    if apart <= WIDTH || other_way <= WIDTH {
        Ok(())
    } else {
        Err(PowerFault::IndexMismatch { count, aligned })
    }
}

/// A running check of the phase that a program states at the encoder's index, by two pulses of torque at the first
/// arming.
///
/// ```text
/// current  across  +---+   .                         along the magnets, as the phase has them
///                  |   |   .       .   +---+   .
///                --+   +   +---+---+---+   +   +---+-
///                      |   |   .       .   |   |
///                      +---+   .       .   +---+
/// moved            by torque   |       by an error of the phase
/// ```
///
/// Each pulse accelerates the handle and brakes it again. With the right phase the current across the magnets moves
/// the handle forward, and the current along them does not move it; with a phase that is off by an angle, the two
/// motions are as its cosine and its sine. So a phase is accepted within 45 degrees, for any inertia. With a larger
/// error the torque is weak or has the wrong sign, and the motor could run away.
#[derive(Clone, Copy, Debug)]
pub struct OffsetCheck {
    stretch: u32,
    time: u32,
    /// Counts that the handle moved by the currents across and along the magnets, forward with the phase.
    across: i32,
    along: i32,
}

impl OffsetCheck {
    /// A check with periods of the modulation in s.
    pub(super) const fn new(instant: f64) -> Self {
        Self { stretch: Self::instants(instant) / ALL_STRETCHES, time: 0, across: 0, along: 0 }
    }

    pub(super) const fn instants(instant: f64) -> u32 {
        ALL_STRETCHES * (PULSE_TIME / instant) as u32
    }

    /// An instant in which the handle moved by `moved` counts; returns the current for the next instant, relative
    /// to the current of full-scale torque, and `None` at the end.
    pub(super) const fn step(&mut self, moved: i32) -> Option<Vector> {
        let place = self.time / self.stretch;
        // Only the way forward: inertia takes the handle further during the second half, damping takes it back.
        if place == 0 {
            self.across += moved;
        } else if place == PULSE_STRETCHES {
            self.along += moved;
        }
        self.time += 1;
        let current = match place % PULSE_STRETCHES {
            0 => PULSE_PART,
            1 => -PULSE_PART,
            _ => 0.0,
        };
        match place {
            0..PULSE_STRETCHES => Some(Vector { along: 0.0, across: current }),
            PULSE_STRETCHES..ALL_STRETCHES => Some(Vector { along: current, across: 0.0 }),
            _ => None,
        }
    }

    /// The result, after the end: an error if the handle did not move as with the right phase.
    pub(super) const fn result(&self) -> Result<(), PowerFault> {
        let (across, along) = (self.across, self.along);
        if across >= LEAST_MOTION && along.unsigned_abs() < across.unsigned_abs() {
            return Ok(());
        }
        Err(PowerFault::IndexOffset { across, along })
    }
}
