//! Any wall as data.

use super::delay_line::VariableDelay;
use super::law::{Discretize, LawContext};
use super::velocity::{AnyVelocity, Difference, NoDamping, Washout};
use super::wall_law::{AnySide, WallLaw};
use crate::build_error::BuildError;
use crate::number::Number;

/// A spring with an optional damper, as data.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Wall {
    /// Stiffness `K` in N m/rad.
    pub stiffness: f64,
    /// Damping `B` in N m s/rad.
    pub damping: f64,
    /// Pole `a` of the velocity filter, if there is one.
    pub filter: Option<f64>,
    /// Delay in whole samples.
    pub delay: usize,
    /// Rest position, or position of the face, in rad.
    pub face: f64,
    /// Whether the wall acts only above `face`.
    pub one_sided: bool,
}

impl Wall {
    /// A spring that pushes and pulls, at rest at zero.
    pub const fn spring(stiffness: f64, delay: usize) -> Self {
        Self { stiffness, damping: 0.0, filter: None, delay, face: 0.0, one_sided: false }
    }
}

/// The law of any wall. It is composed of the parts of the typed walls, so its torques are the same bits.
pub(super) type AnyWallLaw<N> = WallLaw<N, AnyVelocity<N>, AnySide<N>, VariableDelay<N>>;

impl<N: Number> Discretize<N> for Wall {
    type Law = AnyWallLaw<N>;

    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
        let (damping, period) = (self.damping, setting.period);
        let velocity = match self.filter {
            Some(pole) => AnyVelocity::Filtered(Washout::filtered(damping, period, pole)?),
            None if damping != 0.0 => AnyVelocity::Difference(Difference::new(damping, period)?),
            None => AnyVelocity::None(NoDamping),
        };
        let face = BuildError::number("wall face", self.face)?;
        let side = AnySide { face, one_sided: self.one_sided };
        WallLaw::new(self.stiffness, velocity, side, VariableDelay::at_rest(self.delay)?)
    }
}
