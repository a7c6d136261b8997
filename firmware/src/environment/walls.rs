//! Springs and damper walls: their numbers in a scene, and their laws.

use super::delay_line::{DelayLine, FixedDelay};
use super::law::{Discretize, LawContext};
use super::velocity::{Difference, NoDamping, Velocity, Washout};
use super::wall_law::{Centred, Displaced, Face, Side, WallLaw};
use crate::build_error::BuildError;
use crate::number::Number;
use crate::parameter::{NamedParameters, named_parameters};

/// Spring delayed by whole samples: `E(z) = stiffness * z^-DELAY`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayedSpring<const DELAY: usize> {
    /// Stiffness `K` in N m/rad.
    pub stiffness: f64,
}

/// Spring and backward-difference damper, delayed by whole samples:
/// `E(z) = z^-DELAY (stiffness + damping (z - 1) / (T z))` (equation 24 for `DELAY = 1`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DamperWall<const DELAY: usize> {
    /// Stiffness `K` in N m/rad.
    pub stiffness: f64,
    /// Damping `B` in N m s/rad; may be negative: the certificate decides.
    pub damping: f64,
}

/// A [`DamperWall`] whose velocity passes the filter `(1 - a) / (1 - a / z)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilteredWall<const DELAY: usize> {
    /// Stiffness `K` in N m/rad.
    pub stiffness: f64,
    /// Damping `B` in N m s/rad.
    pub damping: f64,
    /// Pole `a` of the velocity filter, `0 <= a < 1`.
    pub filter: f64,
}

/// A wall whose rest position is `face` instead of zero; it pushes and pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed<W> {
    /// Rest position in rad.
    pub face: f64,
    /// The wall.
    pub wall: W,
}

/// A wall that acts only beyond `face` and never pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneSided<W> {
    /// Position of the face in rad; the wall occupies the angles above it.
    pub face: f64,
    /// The wall behind the face.
    pub wall: W,
}

named_parameters! {
    [const N: usize] DelayedSpring<N>: Stiffness => stiffness;
    [const N: usize] DamperWall<N>: Stiffness => stiffness, Damping => damping;
    [const N: usize] FilteredWall<N>:
        Stiffness => stiffness, Damping => damping, Filter => filter;
    [W: NamedParameters] Placed<W>: Face => face; wall;
    [W: NamedParameters] OneSided<W>: Face => face; wall;
}

/// A wall at rest at zero that pushes and pulls; it may be [`Placed`] or [`OneSided`].
pub trait Spring<N: Number> {
    /// The velocity-dependent part.
    type Velocity: Velocity<N>;
    /// The stored samples.
    type Delay: DelayLine<N>;
    /// Stiffness `K` in N m/rad.
    fn stiffness(&self) -> f64;
    /// The velocity-dependent part.
    ///
    /// # Errors
    /// If a coefficient does not fit the number format.
    fn velocity(&self, setting: &LawContext) -> Result<Self::Velocity, BuildError>;
    /// The stored samples, at rest.
    fn delay(&self) -> Self::Delay;
}

macro_rules! springs {
    ($($wall:ident: $velocity:ty = |$self:ident, $setting:ident| $build:expr;)*) => {$(
        impl<N: Number, const DELAY: usize> Spring<N> for $wall<DELAY> {
            type Velocity = $velocity;
            type Delay = FixedDelay<N, DELAY>;

            fn stiffness(&self) -> f64 {
                self.stiffness
            }

            fn velocity(&$self, $setting: &LawContext) -> Result<Self::Velocity, BuildError> {
                $build
            }

            fn delay(&self) -> Self::Delay {
                FixedDelay::at_rest()
            }
        }

        impl<N: Number, const DELAY: usize> Discretize<N> for $wall<DELAY> {
            type Law = WallLaw<N, $velocity, Centred, FixedDelay<N, DELAY>>;

            fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
                wall_law(self, Centred, setting)
            }
        }
    )*};
}

springs! {
    DelayedSpring: NoDamping = |self, _setting| Ok(NoDamping);
    DamperWall: Difference<N> = |self, setting| Difference::new(self.damping, setting.period);
    FilteredWall: Washout<N> =
        |self, setting| Washout::filtered(self.damping, setting.period, self.filter);
}

impl<N: Number, W: Spring<N>> Discretize<N> for Placed<W> {
    type Law = WallLaw<N, W::Velocity, Displaced<N>, W::Delay>;

    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
        wall_law(&self.wall, Displaced(BuildError::number("wall face", self.face)?), setting)
    }
}

impl<N: Number, W: Spring<N>> Discretize<N> for OneSided<W> {
    type Law = WallLaw<N, W::Velocity, Face<N>, W::Delay>;

    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
        wall_law(&self.wall, Face(BuildError::number("wall face", self.face)?), setting)
    }
}

fn wall_law<N: Number, W: Spring<N>, S: Side<N>>(
    wall: &W,
    side: S,
    setting: &LawContext,
) -> Result<WallLaw<N, W::Velocity, S, W::Delay>, BuildError> {
    WallLaw::new(wall.stiffness(), wall.velocity(setting)?, side, wall.delay())
}
