//! What every environment is to the servo: an affine law, whose state advances once a tick.

use super::turn::Turn;
use crate::build_error::BuildError;
use crate::coupling::{Coupling, Response, Slopes};
use crate::latency::Latency;
use crate::matched::MatchedCoupling;
use crate::number::{Format, Number};

/// The difference equation of an environment, at rest at zero to begin with.
pub trait Law<N: Number> {
    /// Whether it is behind a compliant coupling, whatever the scene says.
    const IS_COMPLIANT: bool = false;
    /// The torque in this tick as a function of `x_E`, given by its value at `x_E = x` (rad); the
    /// slopes are those of [`Law::slopes`].
    fn evaluate(&self, x: N) -> Response<N>;
    /// Ends the tick with the environment at `x_E` (rad).
    fn update(&mut self, x_e: N);
    /// Starts anew, as if the environment had always been at `x_e` (rad). Between two ticks.
    fn rest_at(&mut self, x_e: N);
    /// Deflection in rad that the coupling has in this tick of the torques of earlier ticks, the last of
    /// which is given in N m: none, but behind a coupling with memory. Once a tick, before anything else.
    #[inline(always)]
    fn deflection_after(&mut self, _torque: N) -> N {
        N::ZERO
    }
    /// The same where a tick begins with its own torque known: of the torques that
    /// [`remember`](Law::remember) was told.
    #[inline(always)]
    fn lasting_deflection(&self) -> N {
        N::ZERO
    }
    /// Compliance in rad/(N m) for the torque of the same tick of a coupling whose torques it remembers;
    /// `None` where it remembers none.
    fn matched_compliance(&self) -> Option<f64> {
        None
    }
    /// Ends such a tick for the coupling, with this torque in N m.
    #[inline(always)]
    fn remember(&mut self, _torque: N) {}
    /// The turn within which its angles are, for a law that repeats for ever.
    #[inline(always)]
    fn turn(&mut self) -> Option<&mut Turn<N>> {
        None
    }
    /// Moves all positions that it remembers by so many rad.
    fn shift(&mut self, _by: N) {}
    /// Angle in rad by which the device goes back before a law that snaps from one branch to another snaps
    /// back: more than an encoder's count. Infinite for a law with one branch.
    fn hysteresis(&self) -> f64 {
        f64::INFINITY
    }
    /// Slopes of the lines that are offered, in N m/rad, of the coefficients as rounded.
    fn slopes(&self) -> Slopes;
}

/// An environment that can run in the number format `N`.
pub trait Discretize<N: Number> {
    /// Its difference equation: state and coefficients, and nothing that it does not use.
    type Law: Law<N> + Clone + core::fmt::Debug;
    /// Computes the coefficients.
    ///
    /// # Errors
    /// Where a coefficient does not fit the format or does not exist.
    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError>;
}

impl LawContext {
    /// The matched coupling in a number format; without `UPDATES` of an amplifier that is not updated in the
    /// period.
    ///
    /// # Errors
    /// Where it does not exist.
    pub(crate) fn matched<const UPDATES: bool>(
        &self,
        format: Format,
    ) -> Result<MatchedCoupling, BuildError> {
        MatchedCoupling::of_kind::<UPDATES>(self.period, self.passivity, &self.latency, format)
            .ok_or(BuildError::NoMatchedCoupling)
    }
}

/// What an environment's coefficients depend on besides the environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawContext {
    /// Sample period `T` in s.
    pub period: f64,
    /// Damping `b` of the device in N m s/rad.
    pub damping: f64,
    /// Passivity `delta` of the device in N m s/rad.
    pub passivity: f64,
    /// The coupling.
    pub coupling: Coupling,
    /// What delays the torque beside the environment's whole samples.
    pub latency: Latency,
}
