//! What an environment of another crate states of itself to the certificate.

use super::rational::Rational;

/// What an environment of another crate is to the certificate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct StatedModel {
    /// Whole samples from a position to the first torque that depends on it. A
    /// [`transfer`](Self::transfer) implies the same.
    pub delay: usize,
    /// The transfer function from position to torque, where the law is linear. Its coefficients are
    /// judged as a [`Rational`] has them in the number format of the servo.
    // Not on the wire: a scene on a board passes by its bound.
    #[cfg_attr(feature = "wire", serde(skip))]
    pub transfer: Option<Rational>,
    /// Properties of the law with its torque limited at any level. A board requires them, as it limits
    /// every torque. A nonlinear law has nothing else.
    pub bound: Option<StatedBound>,
}

/// Bounds of a law that need not be linear. They hold for the coefficients of every number format
/// that the law runs in.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct StatedBound {
    /// Upper bound on the passivity index `alpha` in N m s/rad: for the positions `x_k` and torques
    /// `F_k` of every motion, `sum F_k (x_k - x_(k-1)) + alpha / T sum (x_k - x_(k-1))^2` is bounded
    /// from below, with the torque limited to any level.
    ///
    /// A servo moves that level while it fades: a falling level may only remove energy, and a rising
    /// level may add, once, the energy that the environment stores there, as for a spring.
    pub index: f64,
    /// Upper bound in N m s/rad on the change of the torque over that of the position, in the l2 norm
    /// and times the period (equation 37).
    pub gain: f64,
}

impl StatedBound {
    /// Of a law whose torque depends on one position, `delay` samples ago, and never falls as that
    /// rises, by no more than `steepest` N m/rad: a spring of any shape.
    ///
    /// Its potential is convex and `steepest`-smooth, so that the torque of the present position is
    /// passive by `(difference of torques)^2 / (2 steepest)` a tick; each sample of delay takes
    /// `steepest T`, the first of them half of it (equation 31). A clipped law is one of the same kind.
    pub const fn of_monotone_spring(steepest: f64, delay: usize, period: f64) -> Self {
        let gain = steepest * period;
        let samples = if delay == 0 { 0.0 } else { delay as f64 - 0.5 };
        // Rounded up twice each: both products of the index.
        Self { index: (gain * samples).next_up().next_up(), gain: gain.next_up() }
    }
}

impl StatedModel {
    /// A linear law. A board renders it only with a bound, too.
    pub const fn linear(transfer: Rational, bound: Option<StatedBound>) -> Self {
        Self { delay: transfer.delay, transfer: Some(transfer), bound }
    }

    /// A law that need not be linear, late by at least one sample.
    pub const fn nonlinear(delay: usize, bound: StatedBound) -> Self {
        Self { delay, transfer: None, bound: Some(bound) }
    }
}
