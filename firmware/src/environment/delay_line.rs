//! Whole samples of delay between an environment's position and its torque.

use super::MAX_DELAY;
use crate::build_error::BuildError;

/// The torques of the last ticks that are not due yet, or other values.
pub trait DelayLine<N>: Clone + core::fmt::Debug + Sized {
    /// A line full of zeros.
    ///
    /// # Errors
    /// If it cannot have this length.
    fn at_rest(delay: usize) -> Result<Self, BuildError>;
    /// The torque that is due in this tick; `None` without a delay.
    fn due(&self) -> Option<N>;
    /// The torques, the oldest first.
    fn waiting(&self) -> &[N];
    /// Stores this tick's torque and drops the oldest.
    fn push(&mut self, torque: N);
    /// Fills it with one torque.
    fn fill(&mut self, torque: N);
}

/// A delay in the scene's type. Moving a few samples is cheaper than a wrapping index, and for the usual
/// delay of one it is a single store.
#[derive(Clone, Debug)]
pub struct FixedDelay<N, const DELAY: usize> {
    oldest_first: [N; DELAY],
}

impl<N: Copy, const DELAY: usize> FixedDelay<N, DELAY> {
    /// A line full of one torque.
    pub const fn full_of(torque: N) -> Self {
        Self { oldest_first: [torque; DELAY] }
    }
}

impl<N: Copy + Default + core::fmt::Debug, const DELAY: usize> DelayLine<N>
    for FixedDelay<N, DELAY>
{
    fn at_rest(delay: usize) -> Result<Self, BuildError> {
        if delay != DELAY {
            return Err(BuildError::Structure);
        }
        Ok(Self::full_of(N::default()))
    }

    #[inline(always)]
    fn due(&self) -> Option<N> {
        self.oldest_first.first().copied()
    }

    #[inline(always)]
    fn waiting(&self) -> &[N] {
        &self.oldest_first
    }

    #[inline(always)]
    fn push(&mut self, torque: N) {
        move_along(&mut self.oldest_first, torque);
    }

    fn fill(&mut self, torque: N) {
        self.oldest_first = [torque; DELAY];
    }
}

/// A delay that is set at run time, up to [`MAX_DELAY`].
#[derive(Clone, Debug)]
pub struct VariableDelay<N> {
    oldest_first: [N; MAX_DELAY],
    delay: usize,
}

impl<N: Copy + Default + core::fmt::Debug> DelayLine<N> for VariableDelay<N> {
    fn at_rest(delay: usize) -> Result<Self, BuildError> {
        if delay > MAX_DELAY {
            return Err(BuildError::Delay { delay, largest: MAX_DELAY });
        }
        Ok(Self { oldest_first: [N::default(); MAX_DELAY], delay })
    }

    fn due(&self) -> Option<N> {
        if self.delay == 0 { None } else { self.oldest_first.first().copied() }
    }

    fn waiting(&self) -> &[N] {
        self.oldest_first.get(..self.delay).unwrap_or(&[])
    }

    fn push(&mut self, torque: N) {
        if let Some(used) = self.oldest_first.get_mut(..self.delay) {
            move_along(used, torque);
        }
    }

    fn fill(&mut self, torque: N) {
        self.oldest_first = [torque; MAX_DELAY];
    }
}

/// Shifts towards the oldest and puts the newest at the end.
#[inline(always)]
fn move_along<N: Copy>(oldest_first: &mut [N], newest: N) {
    let mut arriving = newest;
    for place in oldest_first.iter_mut().rev() {
        core::mem::swap(place, &mut arriving);
    }
}
