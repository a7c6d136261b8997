//! What every environment is to the servo: an affine law, whose state advances once a tick.

use crate::build_error::BuildError;
use crate::coupling::{Coupling, Offer, Slopes};
use crate::number::Number;

/// The difference equation of an environment, at rest at zero to begin with.
pub trait Law<N: Number> {
    /// The torque in this tick as a function of `x_E`, given by its value at `x_E = x` (rad); the
    /// slopes are those of [`Law::slopes`].
    fn offer(&self, x: N) -> Offer<N>;
    /// Ends the tick with the environment at `x_E` (rad).
    fn advance(&mut self, x_e: N);
    /// Starts anew, as if the environment had always been at `x_e` (rad). Between two ticks.
    fn rest_at(&mut self, x_e: N);
    /// Slopes of the lines that are offered, in N m/rad, of the coefficients as rounded.
    fn slopes(&self) -> Slopes;
}

/// An environment that can run in the number format `N`.
pub trait Renderable<N: Number> {
    /// Its difference equation: state and coefficients, and nothing that it does not use.
    type Law: Law<N> + Clone + core::fmt::Debug;
    /// Computes the coefficients.
    ///
    /// # Errors
    /// Where a coefficient does not fit the format or does not exist.
    fn law(&self, setting: &Setting) -> Result<Self::Law, BuildError>;
}

/// What an environment's coefficients depend on besides the environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Sample period `T` in s.
    pub period: f64,
    /// Damping `b` of the device in N m s/rad.
    pub damping: f64,
    /// The coupling.
    pub coupling: Coupling,
}
