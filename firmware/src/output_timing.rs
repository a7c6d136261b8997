//! The times at which a count is read and its torque reaches the motor.
//!
//! A force takes time from count to motor. A scene states the delay of its environment in whole
//! samples, a board the instant at which its codes appear. The compiler checks that both agree, by
//! [`SupportsTiming`](crate::environment::SupportsTiming).

mod sealed {
    pub trait Sealed {}
}

/// The time at which a code reaches the motor, as a type.
pub trait OutputMode: sealed::Sealed + Copy + Send + core::fmt::Debug + 'static {
    /// The same as data.
    const TIMING: OutputTiming;
}

/// The time at which a code reaches the motor, as data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum OutputTiming {
    /// At the instant of its count.
    Simultaneous,
    /// At the next count, by the timer.
    Latched,
    /// This many nanoseconds after the beginning of the period of its count, by the timer.
    AtPhase(u32),
}

impl OutputTiming {
    /// Whether a code is put out at a phase of the period of its count.
    pub const fn is_at_phase(self) -> bool {
        matches!(self, Self::AtPhase(_))
    }

    /// Time in s from the beginning of a period to the output of its code; `None` if the output is not within
    /// the period.
    pub const fn phase(self) -> Option<f64> {
        match self {
            Self::AtPhase(nanoseconds) => Some(nanoseconds as f64 / 1e9),
            Self::Latched | Self::Simultaneous => None,
        }
    }

    /// The output timing of a board for a scene with this output delay in s: at a phase if there is a delay,
    /// otherwise latched. A delay that is too long for a phase gives a phase that no board has.
    pub const fn of_delay(delay: f64) -> Self {
        if delay == 0.0 {
            return Self::Latched;
        }
        // The cast rounds down, and saturates.
        Self::AtPhase((delay * 1e9 + 0.5) as u32)
    }

    /// Whether a board with this period in s supports it: a phase must be long enough to compute a code, and
    /// not so long that the next period's code could be put out in its place.
    pub const fn fits(self, period: f64) -> bool {
        match self.phase() {
            Some(phase) => phase >= SHORTEST_PHASE && phase <= longest_phase(period),
            None => true,
        }
    }
}

/// Shortest phase in s. A count is read up to [`READ_WITHIN`] late, and then the code takes up to 150
/// instructions, of three cycles each on the slowest board, whose flash memory has five wait states: less
/// than 4 microseconds together. The slack of a tick shows whether it is in time.
pub const SHORTEST_PHASE: f64 = 5e-6;

/// Longest phase in s in a period: the code of the next tick, which is not written before the next period
/// begins, must not be there yet, even if the timer's counts round the phase up.
pub const fn longest_phase(period: f64) -> f64 {
    period - READ_WITHIN
}

/// The timer that begins a period latches the code of the tick before: a torque appears exactly one sample
/// after its count, without jitter, so that equation 35 has no part of a sample. The servo computes each
/// torque one tick early, so the scene's sample of delay *is* that sample.
#[derive(Clone, Copy, Debug)]
pub struct Latched;

/// Count and torque are at the same instant: in a simulation, or on an emulated board in lockstep with one.
/// No DAC can do this.
#[derive(Clone, Copy, Debug)]
pub struct Simultaneous;

/// The timer puts the code of a count out a fixed time after the beginning of the count's own period,
/// which the scene states as its output delay: no torque waits for the next count, and none depends on
/// when the computation ended.
///
/// ```text
/// period     k                              k+1                            k+2
///            |---phase-->|                  |---phase-->|                  |
/// count      x(k) read                      x(k+1) read                    x(k+2) read
/// computed   torque of x(k)                 torque of x(k+1)
///                  ^ written ... slack      ^ late: a fault; x(k) is held, then no torque
/// at motor   x(k-1)      torque of x(k)                 torque of x(k+1)
/// ```
///
/// A code that is written later than its phase is a fault ([`LateTick`](crate::fault::Fault::LateTick)), and
/// is never put out: until the next phase the motor keeps the torque of the tick before, if its amplifier
/// were not switched off in the late tick itself, and then it is mid-scale that was written over it.
///
/// The coupling absorbs this time ([`Coupling::Matched`](crate::coupling::Coupling)), so an environment need
/// not be late.
#[derive(Clone, Copy, Debug)]
pub struct AtPhase<const NANOSECONDS: u32>;

impl<const NANOSECONDS: u32> AtPhase<NANOSECONDS> {
    /// The time in s, for the scene.
    pub const DELAY: f64 = NANOSECONDS as f64 / 1e9;
}

impl<const NANOSECONDS: u32> sealed::Sealed for AtPhase<NANOSECONDS> {}

impl<const NANOSECONDS: u32> OutputMode for AtPhase<NANOSECONDS> {
    const TIMING: OutputTiming = OutputTiming::AtPhase(NANOSECONDS);
}

impl sealed::Sealed for Latched {}
impl sealed::Sealed for Simultaneous {}

impl OutputMode for Latched {
    const TIMING: OutputTiming = OutputTiming::Latched;
}

impl OutputMode for Simultaneous {
    const TIMING: OutputTiming = OutputTiming::Simultaneous;
}

/// Time in s after the beginning of its period within which a tick reads its count, for latched torques: the
/// latency of the interrupt, and that by other instructions. The certificate of a board covers counts that
/// are read this late; later counts set [`BEGAN_LATE`](crate::servo_loop::BEGAN_LATE).
pub const READ_WITHIN: f64 = 1e-6;
