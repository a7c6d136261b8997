//! The velocity-dependent part of an environment.
//!
//! Every variant is a high-pass: with gain `g` and pole `a`, `g (z - 1) / (z - a)`, which is `g (x - s)` with
//! the state `s += (1 - a) (x - s)`. A backward difference is the case `a = 0`, where the state is the last
//! position.

use super::wall::Damper;
use crate::build_error::BuildError;
use crate::number::Number;

/// A torque for the velocity.
pub trait Velocity<N: Number>: Clone + core::fmt::Debug + Sized {
    /// That of a damper, with the period in s; `None`: without a damper.
    ///
    /// # Errors
    /// If a coefficient does not fit the number format, or it is not such a damper.
    fn of(damper: Option<&Damper>, period: f64) -> Result<Self, BuildError>;
    /// The torque in N m with the environment at `x` (rad).
    fn torque(&self, x: N) -> N;
    /// `torque` plus that torque.
    #[inline(always)]
    fn add_to(&self, torque: N, x: N) -> N {
        torque.plus(self.torque(x))
    }
    /// Ends the tick with the environment at `x_e` (rad).
    #[inline(always)]
    fn update(&mut self, _x_e: N) {}
    /// Resets the state as if the environment had always been at `x_e` (rad).
    fn rest_at(&mut self, _x_e: N) {}
    /// Moves its stored positions by `by` rad.
    fn shift(&mut self, _by: N) {}
    /// Derivative of the torque with respect to this tick's position, in N m/rad.
    fn slope(&self) -> f64 {
        0.0
    }
}

/// No damping: costs nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoDamping;

impl<N: Number> Velocity<N> for NoDamping {
    fn of(damper: Option<&Damper>, _: f64) -> Result<Self, BuildError> {
        if damper.is_none() { Ok(Self) } else { Err(BuildError::Structure) }
    }

    #[inline(always)]
    fn torque(&self, _x: N) -> N {
        N::ZERO
    }

    #[inline(always)]
    fn add_to(&self, torque: N, _x: N) -> N {
        torque
    }
}

/// Damping `B` on the backward difference: `B (z - 1) / (T z)`.
#[derive(Clone, Copy, Debug)]
pub struct Difference<N: Number> {
    gain: N::Coefficient,
    previous: N,
}

impl<N: Number> Velocity<N> for Difference<N> {
    fn of(damper: Option<&Damper>, period: f64) -> Result<Self, BuildError> {
        let Some(Damper { damping, filter: None }) = damper else {
            return Err(BuildError::Structure);
        };
        let gain = BuildError::coefficient::<N>("wall damping / period", damping / period)?;
        Ok(Self { gain, previous: N::ZERO })
    }

    #[inline(always)]
    fn torque(&self, x: N) -> N {
        x.minus(self.previous).times(self.gain)
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        self.previous = x_e;
    }

    fn rest_at(&mut self, x_e: N) {
        self.previous = x_e;
    }

    fn shift(&mut self, by: N) {
        self.previous = self.previous.plus(by);
    }

    fn slope(&self) -> f64 {
        N::coefficient_to_f64(self.gain)
    }
}

/// The high-pass with a pole: a damper whose velocity is filtered, or a free-mode canceller.
#[derive(Clone, Copy, Debug)]
pub struct Washout<N: Number> {
    gain: N::Coefficient,
    rate: N::Coefficient,
    state: N,
}

impl<N: Number> Washout<N> {
    /// A high-pass from `g` in N m/rad and `1 - a`.
    pub(crate) fn new(gain: f64, rate: f64) -> Result<Self, BuildError> {
        Ok(Self {
            gain: BuildError::coefficient::<N>("high-pass gain", gain)?,
            rate: BuildError::coefficient::<N>("high-pass rate", rate)?,
            state: N::ZERO,
        })
    }
}

impl<N: Number> Velocity<N> for Washout<N> {
    fn of(damper: Option<&Damper>, period: f64) -> Result<Self, BuildError> {
        match damper {
            Some(Damper { damping, filter: Some(pole) }) => {
                Self::new(damping / period * (1.0 - pole), 1.0 - pole)
            }
            _ => Err(BuildError::Structure),
        }
    }

    #[inline(always)]
    fn torque(&self, x: N) -> N {
        x.minus(self.state).times(self.gain)
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        self.state = self.state.plus(x_e.minus(self.state).times(self.rate));
    }

    fn rest_at(&mut self, x_e: N) {
        self.state = x_e;
    }

    fn shift(&mut self, by: N) {
        self.state = self.state.plus(by);
    }

    fn slope(&self) -> f64 {
        N::coefficient_to_f64(self.gain)
    }
}

/// Any of these, for scenes as data.
#[derive(Clone, Copy, Debug)]
pub enum AnyVelocity<N: Number> {
    /// A spring only.
    None(NoDamping),
    /// A damper.
    Difference(Difference<N>),
    /// A filtered damper.
    Filtered(Washout<N>),
}

macro_rules! of_any {
    ($any:expr, $velocity:ident => $value:expr) => {
        match $any {
            Self::None($velocity) => $value,
            Self::Difference($velocity) => $value,
            Self::Filtered($velocity) => $value,
        }
    };
}

impl<N: Number> Velocity<N> for AnyVelocity<N> {
    fn of(damper: Option<&Damper>, period: f64) -> Result<Self, BuildError> {
        Ok(match damper {
            None => Self::None(NoDamping),
            Some(Damper { filter: None, .. }) => Self::Difference(Difference::of(damper, period)?),
            Some(Damper { filter: Some(_), .. }) => Self::Filtered(Washout::of(damper, period)?),
        })
    }

    fn torque(&self, x: N) -> N {
        of_any!(self, velocity => velocity.torque(x))
    }

    fn add_to(&self, torque: N, x: N) -> N {
        of_any!(self, velocity => velocity.add_to(torque, x))
    }

    fn update(&mut self, x_e: N) {
        of_any!(self, velocity => velocity.update(x_e))
    }

    fn rest_at(&mut self, x_e: N) {
        of_any!(self, velocity => velocity.rest_at(x_e))
    }

    fn shift(&mut self, by: N) {
        of_any!(self, velocity => velocity.shift(by))
    }

    fn slope(&self) -> f64 {
        of_any!(self, velocity => Velocity::<N>::slope(velocity))
    }
}
