//! When a torque reaches the motor: how the board puts a code out, and what a scene must be to
//! stand that.
//!
//! A force takes time from count to motor. A scene says by how many whole samples its environment
//! is late; a board says when its codes appear; both have to agree, which the compiler sees to.

use crate::environment::{
    DamperWall, DelayedSpring, Environment, FilteredWall, FreeMode, OneSided, Placed, Rational,
};

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
}

/// The timer that begins a period latches the code of the tick before: a torque appears exactly
/// one sample after the count that it was computed from, without jitter, so that equation 35 has no
/// part of a sample in it. The servo computes each
/// torque one tick early, so that what the scene calls one sample late *is* that sample.
#[derive(Clone, Copy, Debug)]
pub struct Latched;

/// Count and torque belong to the same instant: a simulation, or an emulated board in lockstep
/// with one. No converter can do this.
#[derive(Clone, Copy, Debug)]
pub struct Simultaneous;

impl sealed::Sealed for Latched {}
impl sealed::Sealed for Simultaneous {}

impl OutputMode for Latched {
    const TIMING: OutputTiming = OutputTiming::Latched;
}

impl OutputMode for Simultaneous {
    const TIMING: OutputTiming = OutputTiming::Simultaneous;
}

/// An environment that is late by at least one sample, so that its torque is known one tick early.
///
/// Of [`Environment`] and [`Rational`] only the numbers tell; they are looked at when the scene
/// is [timed](crate::certificate::Timed).
pub trait Delayed: sealed::Sealed {}

macro_rules! delayed {
    ($($delay:literal)*) => {$(delayed! { @
        DelayedSpring<$delay>, Placed<DelayedSpring<$delay>>, OneSided<DelayedSpring<$delay>>,
        DamperWall<$delay>, Placed<DamperWall<$delay>>, OneSided<DamperWall<$delay>>,
        FilteredWall<$delay>, Placed<FilteredWall<$delay>>, OneSided<FilteredWall<$delay>>,
        FreeMode<$delay>,
    })*};
    (@ $($environment:ty,)*) => {$(
        impl sealed::Sealed for $environment {}
        impl Delayed for $environment {}
    )*};
}

delayed!(1 2 3 4 5 6 7 8);
delayed!(@ Environment, Rational,);

/// An environment that can be rendered in the mode `M`: any of them where count and torque are
/// simultaneous, one that is [`Delayed`] where a torque takes time.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not late by a whole sample, but on this board a torque takes one",
    label = "this environment needs a delay of 1 to 8 samples",
    note = "give it a delay of 1, as in `DamperWall<1>`: that is the sample which passes until the \
            motor has the torque; a `FreeModeWall` cancels without delay, and runs in simulation \
            only"
)]
pub trait Renders<M: OutputMode> {}

impl<E> Renders<Simultaneous> for E {}
impl<E: Delayed> Renders<Latched> for E {}
