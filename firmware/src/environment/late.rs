//! The delay that an environment needs for an output mode.

use super::any::Environment;
use crate::output_timing::{AtPhase, Latched, OutputMode, Simultaneous};

/// An environment that is late by at least one sample, so that its torque is known one tick early.
///
/// For an [`Environment`] the numbers decide; they are checked with the
/// [timing](crate::certificate::TimingChecked) of the scene.
///
/// The law of such an environment answers [`Response::Held`](crate::coupling::Response::Held).
pub trait Delayed {}

impl Delayed for Environment {}

/// An environment that can be rendered in the mode `M`: any environment if count and torque are simultaneous,
/// a [`Delayed`] one if a torque takes time.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not late by a whole sample, but on this board a torque takes one",
    label = "this environment needs a delay of at least one sample",
    note = "a sample passes until the motor has the torque: if its law computes no torque from the \
            position of the same tick, implement `Delayed` for it"
)]
pub trait SupportsTiming<M: OutputMode> {}

impl<E> SupportsTiming<Simultaneous> for E {}
impl<E: Delayed> SupportsTiming<Latched> for E {}
impl<const NANOSECONDS: u32> SupportsTiming<AtPhase<NANOSECONDS>> for Environment {}
