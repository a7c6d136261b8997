//! Observes the energy into the hand from counts and codes, and injects damping against it.
//!
//! Over a period the DAC holds a code and the device moves by some counts: their product is the work of the
//! motor, in the unit of [`Transducers::energy_unit`], exactly and without drift. A passive environment
//! returns at most the energy that was put in; the excess is a *deficit*. On a Cortex-M4 this costs 11
//! instructions per tick, and the test for a damper 3.
//!
//! [`Transducers::energy_unit`]: crate::servo::Transducers::energy_unit

use core::hint::cold_path;

use crate::build_error::BuildError;
use crate::coupling::Response;
use crate::dac::DacCode;
use crate::number::Number;
use crate::output_timing::{OutputMode, OutputTiming};

/// Parts of a period, as a power of two: if codes change within a period, energies are kept in these parts of
/// their unit, so that the weighted sum of two codes is exact.
const PARTS: u32 = 8;

/// Observes passivity, one tick at a time. It observes the work of the DAC's codes. An amplifier with a lag
/// does that work later.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnergyMonitor {
    /// Codes above mid-scale that the DAC holds until the next count is read.
    held: i32,
    /// If it is latched, the codes that it holds after that; with a fixed phase, those of the last tick,
    /// which it holds up to the next tick's phase.
    next: i32,
    /// The part of a period up to that phase, in [`PARTS`].
    phase: i32,
    /// The worst deficit less the net energy. With this in place of the net energy, a tick only tests a sign.
    below: i64,
    worst: i64,
}

impl EnergyMonitor {
    /// A monitor at zero energy, for codes that change this part of a period after their count.
    pub fn with_phase(part: f64) -> Self {
        // The cast saturates. Never zero, which stands for other modes.
        let phase = ((part * f64::from(1 << PARTS) + 0.5) as i32).max(1);
        Self { phase, ..Self::default() }
    }

    /// Ends a tick: the encoder moved by `step` counts since the last one, and `code` was written.
    #[inline(always)]
    pub fn observe<M: OutputMode>(&mut self, step: i32, code: DacCode) {
        // Below 2^11 times some thousand counts per tick: years until 2^63.
        self.below = self.below.wrapping_sub(i64::from(self.held) * i64::from(step));
        if self.below < 0 {
            cold_path();
            self.worst = self.worst.wrapping_sub(self.below);
            self.below = 0;
        }
        let offset = i32::from(code.offset());
        match M::TIMING {
            OutputTiming::Latched => self.held = core::mem::replace(&mut self.next, offset),
            OutputTiming::Simultaneous => self.held = offset,
            // The previous code counts for the part of the period before the phase: exact for motion at a
            // constant speed.
            OutputTiming::AtPhase(_) => {
                let before = core::mem::replace(&mut self.next, offset);
                self.held = (offset << PARTS) - (offset - before) * self.phase;
            }
        }
    }

    /// Call it before [`EnergyMonitor::observe`] if updates were missed since the last tick: the code changed
    /// at an unknown place in the encoder's `step`, and the worse case is taken.
    pub fn missed<M: OutputMode>(&mut self, step: i32) {
        let held = match M::TIMING {
            OutputTiming::Simultaneous => return,
            OutputTiming::Latched => self.next,
            // Most of such a long time has the newer code.
            OutputTiming::AtPhase(_) => self.next << PARTS,
        };
        let more = i64::from(held - self.held) * i64::from(step);
        self.below = self.below.wrapping_sub(more.max(0));
    }

    /// Starts at zero energy, with the DAC at mid-scale.
    pub fn reset(&mut self) {
        *self = Self { phase: self.phase, ..Self::default() };
    }

    /// Net energy that the motor has put into the hand and the device, in counts times codes; negative if
    /// they have put in more.
    pub const fn net(&self) -> i64 {
        self.worst.wrapping_sub(self.below) >> self.scale()
    }

    /// The number of binary digits of the energies below their unit.
    const fn scale(&self) -> u32 {
        if self.phase == 0 { 0 } else { PARTS }
    }

    /// The largest value of [`EnergyMonitor::net`] so far: the worst deficit. Never negative.
    pub const fn worst(&self) -> i64 {
        self.worst >> self.scale()
    }

    /// Whether there is a deficit now.
    #[inline(always)]
    pub const fn is_deficit(&self) -> bool {
        self.worst.wrapping_sub(self.below) > 0
    }
}

/// Adds a torque to the environment's, within the limit.
pub(crate) trait Action<N: Number> {
    /// The environment's response with this tick's torque added.
    fn add_to(&self, offer: Response<N>) -> Response<N>;
    /// Ends the tick with the environment at `x_e` (rad).
    fn update(&mut self, x_e: N);
    /// Moves its stored positions by `by` rad.
    fn shift(&mut self, by: N);
}

/// No action: costs nothing.
pub(crate) struct NoAction;

impl<N: Number> Action<N> for NoAction {
    #[inline(always)]
    fn add_to(&self, offer: Response<N>) -> Response<N> {
        offer
    }

    #[inline(always)]
    fn update(&mut self, _: N) {}

    #[inline(always)]
    fn shift(&mut self, _: N) {}
}

/// A switched damper on the environment's velocity of the previous two samples: any switching adds at most
/// its damping to the index (theory, section 5).
#[derive(Clone, Debug)]
pub(crate) struct Injector<N: Number> {
    /// Damping over the period, in N m/rad.
    gain: N::Coefficient,
    /// The environment's last position in rad.
    last: N,
    /// Its movement in the last period in rad.
    movement: N,
    on: bool,
}

impl<N: Number> Injector<N> {
    /// An injector from the damping in N m s/rad and the period in s, at rest at zero and off.
    pub(crate) fn new(damping: f64, period: f64) -> Result<Self, BuildError> {
        BuildError::unless_positive("injected damping", damping)?;
        let gain = BuildError::coefficient::<N>("injected damping / period", damping / period)?;
        Ok(Self { gain, last: N::ZERO, movement: N::ZERO, on: false })
    }

    /// Its rounded damping in N m s/rad, or more.
    pub(crate) fn damping(&self, period: f64) -> f64 {
        (N::coefficient_to_f64(self.gain) * period).next_up()
    }

    /// As if the environment had always been at `x_e` (rad).
    pub(crate) fn rest_at(&mut self, x_e: N) {
        (self.last, self.movement) = (x_e, N::ZERO);
    }

    pub(crate) fn switch(&mut self, on: bool) {
        self.on = on;
    }
}

impl<N: Number> Action<N> for Injector<N> {
    #[inline(always)]
    fn add_to(&self, offer: Response<N>) -> Response<N> {
        if self.on { offer.plus(Response::Held(self.movement.times(self.gain))) } else { offer }
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        self.movement = x_e.minus(self.last);
        self.last = x_e;
    }

    fn shift(&mut self, by: N) {
        self.last = self.last.plus(by);
    }
}

#[cfg(test)]
mod tests;
