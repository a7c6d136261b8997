//! Environments that are sums: a torque profile with a wall, with a free-mode canceller, or with both, all at
//! the same position `x_E`.
//!
//! Their passivity indices add, with a torque limit on the sum as well (theory, section 14.3). The profile of
//! a sum is late by at least one sample, because an undelayed profile is solved in front of the coupling. A
//! wall is at one angle of many turns, so the profile of such a sum must have end stops.
//!
//! If parts have parameters of the same name, `stiffness`, `damping` and `face` are the wall's; `torque`,
//! `count`, `centre`, `from`, `to` and `delay` the profile's; `residual` the canceller's. Without a wall,
//! `stiffness` is that of the end stops.

use super::any_wall::{AnyWallLaw, Wall};
use super::free_mode::{FreeModeWallLaw, beside, canceller};
use super::law::{Discretize, Law, LawContext};
use super::profile::{AnyProfile, AnyProfileLaw};
use super::turn::Turn;
use super::velocity::{Velocity, Washout};
use crate::build_error::BuildError;
use crate::coupling::{Response, Slopes};
use crate::number::Number;
use crate::parameter::{NamedParameters, Parameter};

/// A torque profile with an undelayed [`FreeMode`](super::FreeMode): detents on a device whose own damping is
/// cancelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeModeProfile<P> {
    /// Damping `epsilon` in N m s/rad that the hand still feels.
    pub residual: f64,
    /// The profile.
    pub profile: P,
}

/// A wall and a torque profile, each with its own delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallAndProfile<W, P> {
    /// The wall.
    pub wall: W,
    /// The profile.
    pub profile: P,
}

/// A wall and a torque profile together with an undelayed [`FreeMode`](super::FreeMode).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeModeWallAndProfile<W, P> {
    /// Damping `epsilon` in N m s/rad that the hand still feels.
    pub residual: f64,
    /// The wall.
    pub wall: W,
    /// The profile.
    pub profile: P,
}

impl<P: NamedParameters> NamedParameters for FreeModeProfile<P> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match parameter {
            Parameter::Residual => Some(&mut self.residual),
            _ => self.profile.value(parameter),
        }
    }
}

impl<W: NamedParameters, P: NamedParameters> NamedParameters for WallAndProfile<W, P> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        of_wall_or_profile(&mut self.wall, &mut self.profile, parameter)
    }
}

impl<W: NamedParameters, P: NamedParameters> NamedParameters for FreeModeWallAndProfile<W, P> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match parameter {
            Parameter::Residual => Some(&mut self.residual),
            _ => of_wall_or_profile(&mut self.wall, &mut self.profile, parameter),
        }
    }
}

/// The wall's parameter if it has one of this name, otherwise the profile's.
fn of_wall_or_profile<'n, W: NamedParameters, P: NamedParameters>(
    wall: &'n mut W,
    profile: &'n mut P,
    parameter: Parameter,
) -> Option<&'n mut f64> {
    match wall.value(parameter) {
        Some(value) => Some(value),
        None => profile.value(parameter),
    }
}

/// The law of a [`WallAndProfile`]: the sum of the two.
#[derive(Clone, Debug)]
pub struct WallAndProfileLaw<L, P> {
    wall: L,
    profile: P,
}

impl<N: Number, L: Law<N>, P: Law<N>> Law<N> for WallAndProfileLaw<L, P> {
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        sum(self.wall.evaluate(x), self.profile.evaluate(x))
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        self.wall.update(x_e);
        self.profile.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.wall.rest_at(x_e);
        self.profile.rest_at(x_e);
    }

    #[inline(always)]
    fn turn(&mut self) -> Option<&mut Turn<N>> {
        self.profile.turn()
    }

    fn shift(&mut self, by: N) {
        self.wall.shift(by);
        self.profile.shift(by);
    }

    fn slopes(&self) -> Slopes {
        // A late profile has no slopes.
        self.wall.slopes()
    }
}

/// A wall's response with that of a late profile added.
#[inline(always)]
fn sum<N: Number>(wall: Response<N>, profile: Response<N>) -> Response<N> {
    match profile {
        Response::Held(torque) => wall.plus(torque),
        // A late profile has no other response.
        _ => profile,
    }
}

impl<N: Number, P: Discretize<N>> Discretize<N> for FreeModeProfile<P> {
    type Law = FreeModeWallLaw<N, P::Law>;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        let canceller = canceller(self.residual, context)?;
        Ok(FreeModeWallLaw { canceller, wall: self.profile.law(context)? })
    }
}

impl<N: Number, W: Discretize<N>, P: Discretize<N>> Discretize<N> for WallAndProfile<W, P> {
    type Law = WallAndProfileLaw<W::Law, P::Law>;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        Ok(WallAndProfileLaw { wall: self.wall.law(context)?, profile: self.profile.law(context)? })
    }
}

impl<N: Number, W: Discretize<N>, P: Discretize<N>> Discretize<N> for FreeModeWallAndProfile<W, P> {
    type Law = FreeModeWallLaw<N, WallAndProfileLaw<W::Law, P::Law>>;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        let canceller = canceller(self.residual, context)?;
        let (wall, profile) = (self.wall.law(context)?, self.profile.law(context)?);
        Ok(FreeModeWallLaw { canceller, wall: WallAndProfileLaw { wall, profile } })
    }
}

/// Any of the sums in this module as data.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Composed {
    /// Residual damping `epsilon` of a canceller in N m s/rad; `None`: no canceller.
    pub residual: Option<f64>,
    /// The wall; `None`: no wall.
    pub wall: Option<Wall>,
    /// The profile.
    pub profile: AnyProfile,
}

impl Composed {
    /// Whether all its parts are late by at least one sample.
    pub const fn is_late(&self) -> bool {
        let is_wall_late = match &self.wall {
            Some(wall) => wall.delay > 0,
            None => true,
        };
        is_wall_late && self.residual.is_none() && self.profile.delay > 0
    }
}

/// The law of any [`Composed`] environment. It adds in the order of the typed sums, so its torques are the
/// same bits.
#[derive(Clone, Debug)]
pub struct ComposedLaw<N: Number> {
    canceller: Option<Washout<N>>,
    wall: Option<AnyWallLaw<N>>,
    profile: AnyProfileLaw<N>,
}

impl<N: Number> Law<N> for ComposedLaw<N> {
    fn evaluate(&self, x: N) -> Response<N> {
        let profile = self.profile.evaluate(x);
        let late = match &self.wall {
            Some(wall) => sum(wall.evaluate(x), profile),
            None => profile,
        };
        match &self.canceller {
            Some(canceller) => beside(canceller.torque(x), late),
            None => late,
        }
    }

    fn update(&mut self, x_e: N) {
        if let Some(canceller) = &mut self.canceller {
            canceller.update(x_e);
        }
        if let Some(wall) = &mut self.wall {
            wall.update(x_e);
        }
        self.profile.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        if let Some(canceller) = &mut self.canceller {
            canceller.rest_at(x_e);
        }
        if let Some(wall) = &mut self.wall {
            wall.rest_at(x_e);
        }
        self.profile.rest_at(x_e);
    }

    fn turn(&mut self) -> Option<&mut Turn<N>> {
        self.profile.turn()
    }

    fn shift(&mut self, by: N) {
        if let Some(canceller) = &mut self.canceller {
            canceller.shift(by);
        }
        if let Some(wall) = &mut self.wall {
            wall.shift(by);
        }
        self.profile.shift(by);
    }

    fn slopes(&self) -> Slopes {
        let Slopes { line, wall } = self.wall.as_ref().map_or(Slopes::default(), Law::slopes);
        match &self.canceller {
            Some(canceller) => Slopes { line: canceller.slope() + line, wall },
            None => Slopes { line, wall },
        }
    }
}

impl<N: Number> Discretize<N> for Composed {
    type Law = ComposedLaw<N>;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        let canceller = self.residual.map(|residual| canceller(residual, context)).transpose()?;
        let wall = self.wall.map(|wall| wall.law(context)).transpose()?;
        Ok(ComposedLaw { canceller, wall, profile: self.profile.law(context)? })
    }
}

#[cfg(test)]
mod tests;
