//! The servo's interface to every environment: an affine law, whose state advances once per tick.

use super::turn::Turn;
use crate::build_error::BuildError;
use crate::coupling::{Coupling, Response, Slopes};
use crate::latency::Latency;
use crate::number::Number;

/// The difference equation of an environment, initially at rest at zero.
pub trait Law<N: Number> {
    /// The torque in this tick as a function of `x_E`, given by its value at `x_E = x` (rad); the
    /// slopes are those of [`Law::slopes`].
    fn evaluate(&self, x: N) -> Response<N>;
    /// Ends the tick with the environment at `x_E` (rad).
    fn update(&mut self, x_e: N);
    /// Resets the state as if the environment had always been at `x_e` (rad). Call it between two ticks.
    fn rest_at(&mut self, x_e: N);
    /// The turn of its angles, for a law that repeats without end.
    #[inline(always)]
    fn turn(&mut self) -> Option<&mut Turn<N>> {
        None
    }
    /// Moves all its stored positions by `by` rad.
    fn shift(&mut self, _by: N) {}
    /// Angle in rad by which the device must go back before a law with snap points snaps back: more than an
    /// encoder's count. Infinite for a law without snap points.
    fn hysteresis(&self) -> f64 {
        f64::INFINITY
    }
    /// Slopes of the responses in N m/rad, with the rounded coefficients.
    fn slopes(&self) -> Slopes;
}

/// The law of a part of an environment, built from its data of the type `D`.
pub trait LawOf<N: Number, D>: Law<N> + Clone + core::fmt::Debug {
    /// Computes the coefficients.
    ///
    /// # Errors
    /// If a coefficient does not fit the format or does not exist, or the part has another structure.
    fn law_of(part: &D, context: &LawContext) -> Result<Self, BuildError>;
}

/// The data of a part of an environment, with its law for scenes as data.
pub trait AnyPart<N: Number>: Sized {
    /// The law, of which all structure is chosen at run time.
    type Law: LawOf<N, Self>;
}

/// An environment that can run in the number format `N`.
pub trait Discretize<N: Number> {
    /// Its difference equation: only the state and the coefficients that it uses.
    type Law: Law<N> + Clone + core::fmt::Debug;
    /// Computes the coefficients.
    ///
    /// # Errors
    /// If a coefficient does not fit the format or does not exist.
    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError>;
}

/// The scene's other quantities that an environment's coefficients depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawContext {
    /// Sample period `T` in s.
    pub period: f64,
    /// Longest tolerated time in s between two updates of the torque; `None`: the period.
    pub worst_period: Option<f64>,
    /// Damping `b` of the device in N m s/rad.
    pub damping: f64,
    /// Passivity `delta` of the device in N m s/rad.
    pub passivity: f64,
    /// The coupling.
    pub coupling: Coupling,
    /// The delays of the torque in addition to the environment's whole samples.
    pub latency: Latency,
}
