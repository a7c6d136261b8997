//! Any environment as data: for scenes that come from a file or over the wire.

use super::any_wall::{AnyWallLaw, Wall};
use super::composed::{Composed, ComposedLaw};
use super::delay_line::VariableDelay;
use super::free_mode::{FreeModeLaw, FreeModeWallLaw, canceller};
use super::law::{Discretize, Law, LawContext};
use super::matched::CouplingMemory;
use super::profile::{AnyProfile, AnyProfileLaw};
use super::rational::{Rational, RationalLaw};
use super::stated::StatedModel;
use super::turn::Turn;
use crate::build_error::BuildError;
use crate::coupling::{Coupling, Response, Slopes};
use crate::latency::TRAILS;
use crate::number::Number;

/// Any environment as data.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Environment {
    /// [`DelayedSpring`](super::DelayedSpring), placed or one-sided.
    DelayedSpring(Wall),
    /// [`DamperWall`](super::DamperWall) or [`FilteredWall`](super::FilteredWall), placed or
    /// one-sided.
    DamperWall(Wall),
    /// [`FreeMode`](super::FreeMode).
    FreeMode {
        /// Residual damping `epsilon` in N m s/rad.
        residual: f64,
        /// Delay in whole samples.
        delay: usize,
    },
    /// [`FreeModeWall`](super::FreeModeWall).
    FreeModeWall {
        /// Residual damping `epsilon` in N m s/rad.
        residual: f64,
        /// The wall that ends the free motion.
        wall: Wall,
    },
    /// An environment of another crate.
    Stated(StatedModel),
    /// [`Profile`](super::Profile), [`DampedProfile`](super::DampedProfile) or
    /// [`SnapProfile`](super::SnapProfile).
    Profile(AnyProfile),
    /// [`FreeModeProfile`](super::FreeModeProfile), [`WallAndProfile`](super::WallAndProfile) or
    /// [`FreeModeWallAndProfile`](super::FreeModeWallAndProfile).
    Composed(Composed),
    /// [`Rational`].
    // No board renders one, so it is not on the wire.
    #[cfg_attr(feature = "wire", serde(skip))]
    Rational(Rational),
}

impl Environment {
    /// The wall, if the environment has one. A spring ignores its wall's damping.
    pub const fn wall(&self) -> Option<Wall> {
        match self {
            Self::DelayedSpring(wall) => Some(Wall { damping: 0.0, filter: None, ..*wall }),
            Self::DamperWall(wall) | Self::FreeModeWall { wall, .. } => Some(*wall),
            Self::Composed(composed) => composed.wall,
            Self::FreeMode { .. } | Self::Stated(_) | Self::Profile(_) | Self::Rational(_) => None,
        }
    }

    /// The wall, mutable.
    pub const fn wall_mut(&mut self) -> Option<&mut Wall> {
        match self {
            Self::DelayedSpring(wall)
            | Self::DamperWall(wall)
            | Self::FreeModeWall { wall, .. } => Some(wall),
            Self::Composed(composed) => composed.wall.as_mut(),
            Self::FreeMode { .. } | Self::Stated(_) | Self::Profile(_) | Self::Rational(_) => None,
        }
    }

    /// The torque profile, if the environment is one or contains one.
    pub const fn profile(&self) -> Option<&AnyProfile> {
        match self {
            Self::Profile(profile) => Some(profile),
            Self::Composed(composed) => Some(&composed.profile),
            _ => None,
        }
    }

    /// Whether its torque jumps when a knob snaps from one detent to the next.
    pub(crate) const fn snaps(&self) -> bool {
        match self.profile() {
            Some(profile) => profile.snap.is_some(),
            None => false,
        }
    }

    /// Residual damping of its canceller in N m s/rad; `None` without a canceller.
    pub const fn residual(&self) -> Option<f64> {
        match self {
            Self::FreeMode { residual, .. } | Self::FreeModeWall { residual, .. } => {
                Some(*residual)
            }
            Self::Composed(composed) => composed.residual,
            _ => None,
        }
    }

    /// The rational function of the environment, or of its statement.
    pub const fn rational(&self) -> Option<&Rational> {
        match self {
            Self::Rational(rational) => Some(rational),
            Self::Stated(StatedModel::Linear(rational)) => Some(rational),
            _ => None,
        }
    }

    /// Whether it is linear apart from a face and a torque limit.
    pub const fn has_transfer(&self) -> bool {
        !matches!(
            self,
            Self::Stated(StatedModel::Bounded { .. }) | Self::Profile(_) | Self::Composed(_)
        )
    }

    /// Whether all its parts are late by at least one sample, so that its torque is known a tick early: only
    /// such an environment can be rendered with latched torques.
    pub const fn is_late(&self) -> bool {
        match self {
            Self::Composed(composed) => composed.is_late(),
            // The canceller in front of a wall is not delayed.
            Self::FreeModeWall { .. } => false,
            _ => self.delay() > 0,
        }
    }

    /// Its delay in whole samples; for a sum, the delay of the torque profile.
    pub const fn delay(&self) -> usize {
        match self {
            Self::DelayedSpring(wall)
            | Self::DamperWall(wall)
            | Self::FreeModeWall { wall, .. } => wall.delay,
            Self::FreeMode { delay, .. } | Self::Stated(StatedModel::Bounded { delay, .. }) => {
                *delay
            }
            Self::Profile(profile) => profile.delay,
            Self::Composed(composed) => composed.profile.delay,
            Self::Rational(rational) | Self::Stated(StatedModel::Linear(rational)) => {
                rational.whole_delay()
            }
        }
    }

    /// The delay in whole samples, mutable.
    pub(crate) const fn delay_mut(&mut self) -> &mut usize {
        match self {
            Self::DelayedSpring(wall)
            | Self::DamperWall(wall)
            | Self::FreeModeWall { wall, .. } => &mut wall.delay,
            Self::FreeMode { delay, .. } | Self::Stated(StatedModel::Bounded { delay, .. }) => {
                delay
            }
            Self::Profile(profile) => &mut profile.delay,
            Self::Composed(composed) => &mut composed.profile.delay,
            Self::Rational(rational) | Self::Stated(StatedModel::Linear(rational)) => {
                &mut rational.delay
            }
        }
    }
}

/// The law of any [`Environment`] without the coupling's memory.
#[derive(Clone, Debug)]
pub enum EnvironmentLaw<N: Number> {
    /// Of a spring or a wall.
    Wall(AnyWallLaw<N>),
    /// Of free mode.
    FreeMode(FreeModeLaw<N, VariableDelay<N>>),
    /// Of free mode that ends at a wall.
    FreeModeWall(FreeModeWallLaw<N, AnyWallLaw<N>>),
    /// Of a rational environment.
    Rational(RationalLaw<N>),
    /// Of a torque profile.
    Profile(AnyProfileLaw<N>),
    /// Of a sum with a torque profile.
    Composed(ComposedLaw<N>),
}

impl<N: Number> Law<N> for EnvironmentLaw<N> {
    fn evaluate(&self, x: N) -> Response<N> {
        match self {
            Self::Wall(law) => law.evaluate(x),
            Self::FreeMode(law) => law.evaluate(x),
            Self::FreeModeWall(law) => law.evaluate(x),
            Self::Rational(law) => law.evaluate(x),
            Self::Profile(law) => law.evaluate(x),
            Self::Composed(law) => law.evaluate(x),
        }
    }

    fn update(&mut self, x_e: N) {
        match self {
            Self::Wall(law) => law.update(x_e),
            Self::FreeMode(law) => law.update(x_e),
            Self::FreeModeWall(law) => law.update(x_e),
            Self::Rational(law) => law.update(x_e),
            Self::Profile(law) => law.update(x_e),
            Self::Composed(law) => law.update(x_e),
        }
    }

    fn rest_at(&mut self, x_e: N) {
        match self {
            Self::Wall(law) => law.rest_at(x_e),
            Self::FreeMode(law) => law.rest_at(x_e),
            Self::FreeModeWall(law) => law.rest_at(x_e),
            Self::Rational(law) => law.rest_at(x_e),
            Self::Profile(law) => law.rest_at(x_e),
            Self::Composed(law) => law.rest_at(x_e),
        }
    }

    fn turn(&mut self) -> Option<&mut Turn<N>> {
        match self {
            Self::Profile(law) => law.turn(),
            Self::Composed(law) => law.turn(),
            _ => None,
        }
    }

    fn shift(&mut self, by: N) {
        match self {
            Self::Profile(law) => law.shift(by),
            Self::Composed(law) => law.shift(by),
            _ => {}
        }
    }

    fn hysteresis(&self) -> f64 {
        match self {
            Self::Profile(law) => law.hysteresis(),
            _ => f64::INFINITY,
        }
    }

    fn slopes(&self) -> Slopes {
        match self {
            Self::Wall(law) => law.slopes(),
            Self::FreeMode(law) => law.slopes(),
            Self::FreeModeWall(law) => law.slopes(),
            Self::Rational(law) => law.slopes(),
            Self::Profile(law) => law.slopes(),
            Self::Composed(law) => law.slopes(),
        }
    }
}

/// The law of any [`Environment`], behind any coupling.
#[derive(Clone, Debug)]
pub struct DataLaw<N: Number> {
    law: EnvironmentLaw<N>,
    memory: Option<CouplingMemory<N, VariableDelay<N>, TRAILS>>,
}

impl<N: Number> Law<N> for DataLaw<N> {
    fn evaluate(&self, x: N) -> Response<N> {
        self.law.evaluate(x)
    }

    fn update(&mut self, x_e: N) {
        self.law.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.law.rest_at(x_e);
        if let Some(memory) = &mut self.memory {
            memory.rest();
        }
    }

    fn turn(&mut self) -> Option<&mut Turn<N>> {
        self.law.turn()
    }

    fn shift(&mut self, by: N) {
        self.law.shift(by);
    }

    fn hysteresis(&self) -> f64 {
        self.law.hysteresis()
    }

    fn slopes(&self) -> Slopes {
        self.law.slopes()
    }

    fn matched_compliance(&self) -> Option<f64> {
        self.memory.as_ref().map(CouplingMemory::compliance)
    }

    #[inline]
    fn deflection_after(&mut self, torque: N) -> N {
        self.memory.as_mut().map_or(N::ZERO, |memory| memory.deflection_after(torque))
    }

    #[inline]
    fn lasting_deflection(&self) -> N {
        self.memory.as_ref().map_or(N::ZERO, CouplingMemory::deflection)
    }

    #[inline]
    fn remember(&mut self, torque: N) {
        if let Some(memory) = &mut self.memory {
            memory.remember(torque);
        }
    }
}

impl<N: Number> Discretize<N> for Environment {
    type Law = DataLaw<N>;

    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
        let memory = match setting.coupling {
            Coupling::Matched => {
                let coupling = setting.matched::<true>(N::FORMAT)?;
                let torques = VariableDelay::at_rest(coupling.whole)?;
                Some(CouplingMemory::new(&coupling, torques)?)
            }
            Coupling::Rigid | Coupling::Spring { .. } => None,
        };
        Ok(DataLaw { law: self.memoryless_law(setting)?, memory })
    }
}

impl Environment {
    /// The law without its coupling's memory.
    fn memoryless_law<N: Number>(
        &self,
        setting: &LawContext,
    ) -> Result<EnvironmentLaw<N>, BuildError> {
        Ok(match self {
            // A spring ignores its wall's damping.
            Self::DelayedSpring(wall) => {
                EnvironmentLaw::Wall(Wall { damping: 0.0, filter: None, ..*wall }.law(setting)?)
            }
            Self::DamperWall(wall) => EnvironmentLaw::Wall(wall.law(setting)?),
            // Its statement does not contain its law.
            Self::Stated(_) => return Err(BuildError::LawElsewhere),
            Self::FreeMode { residual, delay } => EnvironmentLaw::FreeMode(FreeModeLaw {
                canceller: canceller(*residual, setting)?,
                delay: VariableDelay::at_rest(*delay)?,
            }),
            Self::FreeModeWall { residual, wall } => {
                EnvironmentLaw::FreeModeWall(FreeModeWallLaw {
                    canceller: canceller(*residual, setting)?,
                    wall: wall.law(setting)?,
                })
            }
            Self::Rational(rational) => EnvironmentLaw::Rational(rational.law(setting)?),
            Self::Profile(profile) => EnvironmentLaw::Profile(profile.law(setting)?),
            Self::Composed(composed) => EnvironmentLaw::Composed(composed.law(setting)?),
        })
    }
}
