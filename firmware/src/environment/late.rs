//! The delay that an environment needs for an output mode.

use super::{
    DampedProfile, DamperWall, DelayedSpring, Environment, FilteredWall, FreeMode, Matched,
    OneSided, Placed, Profile, ProfileModes, Rational, SnapProfile, Uncoupled, WallAndProfile,
};
use crate::output_timing::{AtPhase, Latched, OutputMode, Simultaneous};

/// An environment that is late by at least one sample, so that its torque is known one tick early.
///
/// For [`Environment`] and [`Rational`] the numbers decide; they are checked with the
/// [timing](crate::certificate::TimingChecked) of the scene.
///
/// The law of such an environment answers [`Response::Held`](crate::coupling::Response::Held).
pub trait Delayed {}

macro_rules! delayed {
    ($($delay:literal)*) => {$(delayed! { @
        DelayedSpring<$delay>, Placed<DelayedSpring<$delay>>, OneSided<DelayedSpring<$delay>>,
        DamperWall<$delay>, Placed<DamperWall<$delay>>, OneSided<DamperWall<$delay>>,
        FilteredWall<$delay>, Placed<FilteredWall<$delay>>, OneSided<FilteredWall<$delay>>,
        FreeMode<$delay>, ProfileModes<$delay>,
    } delayed! { knots $delay })*};
    (knots $delay:literal) => {
        impl<const KNOTS: usize> Delayed for Profile<KNOTS, $delay> {}
        impl<const KNOTS: usize> Delayed for DampedProfile<KNOTS, $delay> {}
    };
    (@ $($environment:ty,)*) => {$(
        impl Delayed for $environment {}
    )*};
}

delayed!(1 2 3 4 5 6 7 8);
// An environment with snap points is certified up to one sample late.
impl<const KNOTS: usize> Delayed for SnapProfile<KNOTS, 1> {}

delayed!(@ Environment, Rational,);

/// An environment that can be rendered in the mode `M`: any environment if count and torque are simultaneous,
/// a [`Delayed`] one if a torque takes time.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not late by a whole sample, but on this board a torque takes one",
    label = "this environment needs a delay of 1 to 8 samples",
    note = "give it a delay of 1, as in `DamperWall<1>`: that is the sample which passes until the \
            motor has the torque; what cancels or answers without delay, as a `FreeModeWall`, runs as \
            `Matched<...>` behind `Coupling::Matched`, with the output `AtPhase<...>`"
)]
pub trait SupportsTiming<M: OutputMode> {}

impl<W: Delayed, P: Delayed> Delayed for WallAndProfile<W, P> {}
impl<E: Delayed, const WHOLE: usize, const LAGS: usize, const UPDATES: bool> Delayed
    for Matched<E, WHOLE, LAGS, UPDATES>
{
}

impl<E: Delayed> Delayed for Uncoupled<E> {}

impl<E> SupportsTiming<Simultaneous> for E {}
impl<E, const WHOLE: usize, const LAGS: usize, const UPDATES: bool, const NANOSECONDS: u32>
    SupportsTiming<AtPhase<NANOSECONDS>> for Matched<E, WHOLE, LAGS, UPDATES>
{
}
impl<E, const NANOSECONDS: u32> SupportsTiming<AtPhase<NANOSECONDS>> for Uncoupled<E> {}
impl<const NANOSECONDS: u32> SupportsTiming<AtPhase<NANOSECONDS>> for Environment {}
impl<E: Delayed> SupportsTiming<Latched> for E {}
