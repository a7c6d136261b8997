//! The index of a brushless motor's encoder. With it, a motor that was aligned once need not be aligned after
//! each reset. It also shows lost counts.

use super::fault::PowerFault;
use super::phase::{PhaseAlignment, Turn};
use super::vector::Vector;

/// Tolerance of the index in counts: its pulse has up to this width, and comes from both sides.
pub(super) const WIDTH: u32 = 4;

/// Current of a pulse of an [`OffsetCheck`], relative to the current of full-scale torque.
const PART: f32 = 0.25;
/// Time in s of one direction of a pulse; the rest behind a pulse is as long.
const TIME: f64 = 5e-3;
/// Least motion in counts that a torque shows.
const LEAST: i32 = 4;
/// Stretches of a pulse: forward, back, and at rest; and of both pulses.
const STRETCHES: u32 = 3;
const ALL: u32 = 2 * STRETCHES;

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
///
/// # Errors
/// If it is at another count.
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
        Self { stretch: Self::instants(instant) / ALL, time: 0, across: 0, along: 0 }
    }

    /// Instants of a check.
    pub(super) const fn instants(instant: f64) -> u32 {
        ALL * (TIME / instant) as u32
    }

    /// An instant in which the handle moved by `moved` counts; returns the current for the next instant, relative
    /// to the current of full-scale torque, and `None` at the end.
    pub(super) const fn step(&mut self, moved: i32) -> Option<Vector> {
        let place = self.time / self.stretch;
        // Only the way forward: inertia takes the handle further during the second half, damping takes it back.
        if place == 0 {
            self.across += moved;
        } else if place == STRETCHES {
            self.along += moved;
        }
        self.time += 1;
        let current = match place % STRETCHES {
            0 => PART,
            1 => -PART,
            _ => 0.0,
        };
        match place {
            0..STRETCHES => Some(Vector { along: 0.0, across: current }),
            STRETCHES..ALL => Some(Vector { along: current, across: 0.0 }),
            _ => None,
        }
    }

    /// The result, after the end.
    ///
    /// # Errors
    /// If the handle did not move as with the right phase.
    pub(super) const fn result(&self) -> Result<(), PowerFault> {
        let (across, along) = (self.across, self.along);
        if across >= LEAST && along.unsigned_abs() < across.unsigned_abs() {
            return Ok(());
        }
        Err(PowerFault::IndexOffset { across, along })
    }
}
