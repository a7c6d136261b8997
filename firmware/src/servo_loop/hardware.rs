//! Hardware of the servo's interrupt, and the clock that counts its periods.

use core::hint::cold_path;
use core::num::NonZeroU32;

use crate::current::{AlignmentError, HeatStep, PowerFault};
use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::fault::{Fault, FaultRecord};
#[cfg(doc)]
use crate::output_timing::READ_WITHIN;

/// The result of [`Hardware::periods_since_last`] for one period whose tick began later than [`READ_WITHIN`].
pub const BEGAN_LATE: u32 = 0;

/// An event of a torque output for the servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputEvent {
    /// A fault: the output has already removed the torque.
    Fault(Fault),
    /// The torque's limit moves by a step, because of the heat of the current.
    Heat(HeatStep),
}

/// The board in the servo's interrupt: each method is an access or two to a register.
pub trait Hardware {
    /// The encoder's counter.
    fn count(&mut self) -> RawCount;
    /// Writes a code to the DAC, or to the board's own current loop; the output mode decides when it reaches
    /// the motor.
    fn write(&mut self, code: DacCode);
    /// Switches the motor's amplifier, or the board's bridge.
    fn amplifier(&mut self, on: bool);
    /// An event of the torque output since the last call. A DAC has none.
    fn output_event(&mut self) -> Option<OutputEvent> {
        None
    }
    /// Ticks after switching the amplifier on in which it does not follow the code yet; the servo's torque is zero
    /// for so long.
    fn start_up_ticks(&self) -> u32 {
        0
    }
    /// Begins to align a brushless motor, which moves the handle.
    ///
    /// # Errors
    /// If the board has no brushless motor on its bridge.
    fn align(&mut self) -> Result<(), Fault> {
        Err(Fault::Power(PowerFault::Alignment(AlignmentError::NotNeeded)))
    }
    /// Whether an alignment runs.
    fn is_aligning(&mut self) -> bool {
        false
    }
    /// Whole periods that began since the last call: 1 in time, more after missed ticks, and [`BEGAN_LATE`]
    /// for one period whose tick is late. A simulated board may omit [`BEGAN_LATE`] if its count is always
    /// that of the period's beginning.
    fn periods_since_last(&mut self) -> u32;
    /// The periods since the last call, then the count. A board whose count came before the tick may know it earlier.
    #[inline(always)]
    fn sample(&mut self) -> (u32, RawCount) {
        (self.periods_since_last(), self.count())
    }
    /// The fault of the encoder's reading of this tick, after [`Self::periods_since_last`] was not 1: a tick with such
    /// a fault counts as late, so that a usual tick does not ask for it. A counter has none.
    fn reading_fault(&mut self) -> Option<Fault> {
        None
    }
    /// Takes the number of a tick without a step; whether the encoder has stopped. A counter may rest.
    fn rested(&mut self, _tick: u32) -> bool {
        false
    }
    /// The fault of an encoder that has stopped by the last [`Self::rested`].
    fn stopped(&self) -> Option<Fault> {
        None
    }
    /// Timer counts since the period of this tick began; at least a period once the next one has
    /// begun.
    fn time_in_period(&mut self) -> u32;
    /// Timer counts from the beginning of the period of this tick to its count: now, unless hardware has taken the
    /// count at that beginning.
    fn lateness_of_count(&mut self) -> u32 {
        self.time_in_period()
    }
    /// Feeds the watchdog.
    fn feed_watchdog(&mut self);
    /// Keeps a [`FaultRecord`] in memory that survives a reset, or clears it. Rare.
    fn store_fault(&mut self, _record: &[u32; FaultRecord::WORDS]) {}
}

/// Counts the periods by a clock that wraps at 32 bits. The first period began at zero of the clock; its tick
/// is due one period later.
///
/// ```
/// use core::num::NonZeroU32;
/// use haptic_servo::servo_loop::{BEGAN_LATE, PeriodClock};
///
/// let mut periods = PeriodClock::new(NonZeroU32::new(1000).unwrap(), 10);
/// assert_eq!(periods.begun_by(1009), 1); // in time: 9 counts after its beginning
/// assert_eq!(periods.elapsed_at(1300), 300);
/// assert_eq!(periods.begun_by(2010), BEGAN_LATE);
/// assert_eq!(periods.begun_by(5009), 3); // two ticks were missed
/// assert_eq!(periods.begun_by(6000), 1);
/// ```
#[derive(Clone, Debug)]
pub struct PeriodClock {
    counts: NonZeroU32,
    /// Clock counts after the beginning of a period within which its tick is in time.
    in_time: u32,
    /// The clock when the present period began.
    began: u32,
}

impl PeriodClock {
    /// Periods of `counts` clock counts; a tick is in time within the first `in_time` of them: the counts of
    /// [`READ_WITHIN`](crate::output_timing::READ_WITHIN) seconds on a board whose certificate must hold.
    pub const fn new(counts: NonZeroU32, in_time: u32) -> Self {
        Self { counts, in_time, began: 0 }
    }

    /// The number of periods that began between the last call and this time of the clock: the result of
    /// [`Hardware::periods_since_last`](Hardware::periods_since_last).
    #[inline(always)]
    pub fn begun_by(&mut self, time: u32) -> u32 {
        let next = self.began.wrapping_add(self.counts.get());
        let late = time.wrapping_sub(next);
        if late < self.in_time {
            self.began = next;
            return 1;
        }
        cold_path();
        let missed = late / self.counts;
        self.began = next.wrapping_add(missed.wrapping_mul(self.counts.get()));
        if missed == 0 { BEGAN_LATE } else { missed + 1 }
    }

    /// From now on a tick is in time within the first `in_time` counts of its period; with 0 the next tick counts as
    /// late.
    pub const fn set_in_time(&mut self, in_time: u32) {
        self.in_time = in_time;
    }

    /// Clock counts in a period.
    pub const fn counts(&self) -> u32 {
        self.counts.get()
    }

    /// Clock counts since the present period began: the result of
    /// [`Hardware::time_in_period`](Hardware::time_in_period).
    #[inline(always)]
    pub const fn elapsed_at(&self, time: u32) -> u32 {
        time.wrapping_sub(self.began)
    }
}
