//! When a count is read, and when the torque that it gives reaches the motor.
//!
//! A force takes time from count to motor. A scene states the delay of its environment in whole
//! samples, a board the instant at which its codes appear. The compiler checks that both agree, by
//! [`SupportsTiming`](crate::environment::SupportsTiming).

mod sealed {
    pub trait Sealed {}
}

/// When a code reaches the motor, by type.
pub trait OutputMode: sealed::Sealed + Copy + Send + core::fmt::Debug + 'static {
    /// The same as data.
    const TIMING: OutputTiming;
}

/// When a code reaches the motor, as data.
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
    /// Whether a code is put out in the period of its count, at a time of its own.
    pub const fn is_at_phase(self) -> bool {
        matches!(self, Self::AtPhase(_))
    }

    /// Time in s from the beginning of a period to that at which the code of its count is put out;
    /// `None` where the timer does not do that within the period.
    pub const fn phase(self) -> Option<f64> {
        match self {
            Self::AtPhase(nanoseconds) => Some(nanoseconds as f64 / 1e9),
            Self::Latched | Self::Simultaneous => None,
        }
    }

    /// When a board puts the torques of a scene out that has this output delay in s: at a phase, where
    /// there is one, or by the latch. No phase is as long as what does not fit, and such a delay is no
    /// board's.
    pub const fn of_delay(delay: f64) -> Self {
        if delay == 0.0 {
            return Self::Latched;
        }
        // The cast rounds down, and saturates.
        Self::AtPhase((delay * 1e9 + 0.5) as u32)
    }

    /// Whether a board with this period in s can do it: a phase is not too short to compute a code in,
    /// and not so long that the next period's code could be put out in its place.
    pub const fn fits(self, period: f64) -> bool {
        match self.phase() {
            Some(phase) => phase >= SHORTEST_PHASE && phase <= longest_phase(period),
            None => true,
        }
    }
}

/// Shortest phase in s. A count is read up to [`READ_WITHIN`] late, and from there to the code it is up to
/// 150 instructions, of three cycles each on the slowest board, where they come from a flash memory with
/// five wait states: less than 4 microseconds together. Whether a tick makes it shows in its slack.
pub const SHORTEST_PHASE: f64 = 5e-6;

/// Longest phase in s in a period: the code of the next tick, which is not written before the next period
/// begins, must not be there yet, also where the timer's counts round the phase up.
pub const fn longest_phase(period: f64) -> f64 {
    period - READ_WITHIN
}

/// The timer that begins a period latches the code of the tick before: a torque appears exactly
/// one sample after the count that it was computed from, without jitter, so that equation 35 has no
/// part of a sample in it. The servo computes each
/// torque one tick early, so that what the scene calls one sample late *is* that sample.
#[derive(Clone, Copy, Debug)]
pub struct Latched;

/// Count and torque belong to the same instant: a simulation, or an emulated board in lockstep
/// with one. No DAC can do this.
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
/// A code that is written later than that is a fault ([`LateTick`](crate::fault::Fault::LateTick)), and
/// is never put out: until the next phase the motor keeps the torque of the tick before, if its amplifier
/// were not switched off in the late tick itself, and then it is mid-scale that was written over it.
///
/// The time belongs to the coupling ([`Coupling::Matched`](crate::coupling::Coupling)), so that an
/// environment need not be late.
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

/// Time in s after the beginning of its period in which a tick reads its count, where torques are
/// latched: the interrupt's own latency, and that by other instructions. The certificate of a board
/// covers counts that are read as late as this; later ones set
/// [`BEGAN_LATE`](crate::servo_loop::BEGAN_LATE).
pub const READ_WITHIN: f64 = 1e-6;
