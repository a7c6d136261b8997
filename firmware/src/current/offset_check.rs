//! A check of the phase that a program states at the encoder's index, by two pulses of torque at the first arming.
//!
//! ```text
//! current  across  +---+   .                         along the magnets, as the phase has them
//!                  |   |   .       .   +---+   .
//!                --+   +   +---+---+---+   +   +---+-
//!                      |   |   .       .   |   |
//!                      +---+   .       .   +---+
//! moved            by torque   |       by an error of the phase
//! ```
//!
//! Each pulse accelerates the handle and brakes it again. With the right phase the current across the magnets moves
//! the handle forward, and the current along them does not move it; with a phase that is off by an angle, the two
//! motions are as its cosine and its sine. So a phase is accepted within 45 degrees, for any inertia. With a larger
//! error the torque is weak or has the wrong sign, and the motor could run away.

use super::fault::PowerFault;
use super::vector::Vector;

/// Current of a pulse, relative to the current of full-scale torque.
const PART: f32 = 0.25;
/// Time in s of one direction of a pulse; the rest behind a pulse is as long.
const TIME: f64 = 5e-3;
/// Least motion in counts that a torque shows.
const LEAST: i32 = 4;
/// Stretches of a pulse: forward, back, and at rest; and of both pulses.
const STRETCHES: u32 = 3;
const ALL: u32 = 2 * STRETCHES;

/// A running check.
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
