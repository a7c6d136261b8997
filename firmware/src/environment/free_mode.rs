//! Free mode: cancels the device's own damping, so that the hand feels almost nothing.

use super::delay_line::{DelayLine, FixedDelay};
use super::law::{Discretize, Law, LawContext};
use super::turn::Turn;
use super::velocity::{Velocity, Washout};
use crate::build_error::BuildError;
use crate::coupling::{Coupling, Response, Slopes};
use crate::number::Number;
use crate::parameter::{NamedParameters, named_parameters};

/// Free mode: cancels the device's damping down to `residual` (equations 22 and 23).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeMode<const DELAY: usize> {
    /// Damping `epsilon` in N m s/rad that the hand still feels.
    pub residual: f64,
}

/// An undelayed [`FreeMode`] together with a wall: free motion that ends at a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeModeWall<W> {
    /// Damping `epsilon` in N m s/rad that the hand still feels.
    pub residual: f64,
    /// The wall, with its own delay.
    pub wall: W,
}

named_parameters! {
    [const N: usize] FreeMode<N>: Residual => residual;
    [W: NamedParameters] FreeModeWall<W>: Residual => residual; wall;
}

/// The canceller's high-pass.
///
/// The wanted controller is `C = -be s` with `be = b - epsilon`; behind the coupling this is the environment
/// `E = C / (1 - C / K_vc)`, by backward differences `E(z) = -g (z - 1) / (z - rho)` with
/// `g = be K_vc / (K_vc T + be)` and `rho = be / (K_vc T + be)` (equation 23 at `K_vc = 2 b / T`); rigid:
/// `g = be / T`, `rho = 0`.
pub(crate) fn canceller<N: Number>(
    residual: f64,
    setting: &LawContext,
) -> Result<Washout<N>, BuildError> {
    let be = setting.damping - residual;
    let stiffness = match setting.coupling {
        Coupling::Rigid => None,
        Coupling::Spring { stiffness } => Some(stiffness),
        Coupling::Matched => Some(2.0 * setting.passivity / setting.period),
    };
    match stiffness {
        None => Washout::new(-be / setting.period, 1.0),
        Some(stiffness) => {
            let leading = stiffness * setting.period + be;
            Washout::new(-be * stiffness / leading, stiffness * setting.period / leading)
        }
    }
}

/// The law of a [`FreeMode`].
#[derive(Clone, Debug)]
pub struct FreeModeLaw<N: Number, D> {
    pub(crate) canceller: Washout<N>,
    pub(crate) delay: D,
}

impl<N: Number, D: DelayLine<N>> Law<N> for FreeModeLaw<N, D> {
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        match self.delay.due() {
            Some(torque) => Response::Held(torque),
            None => Response::Line(self.canceller.torque(x)),
        }
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        if self.delay.due().is_some() {
            self.delay.push(self.canceller.torque(x_e));
        }
        self.canceller.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.canceller.rest_at(x_e);
        self.delay.fill(N::ZERO);
    }

    fn shift(&mut self, by: N) {
        self.canceller.shift(by);
    }

    fn slopes(&self) -> Slopes {
        match self.delay.due() {
            Some(_) => Slopes::default(),
            None => Slopes { line: self.canceller.slope(), wall: 0.0 },
        }
    }
}

impl<N: Number, const DELAY: usize> Discretize<N> for FreeMode<DELAY> {
    type Law = FreeModeLaw<N, FixedDelay<N, DELAY>>;

    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
        let canceller = canceller(self.residual, setting)?;
        Ok(FreeModeLaw { canceller, delay: FixedDelay::at_rest() })
    }
}

/// A response with the canceller's torque `free` in N m added to it.
#[inline(always)]
pub(super) fn beside<N: Number>(free: N, other: Response<N>) -> Response<N> {
    match other {
        Response::Held(torque) | Response::Line(torque) => Response::Line(free.plus(torque)),
        Response::Wall(contact) => Response::LineAndWall(free, contact),
        Response::LineAndWall(line, contact) => Response::LineAndWall(free.plus(line), contact),
    }
}

/// The law of a [`FreeModeWall`]: the sum of the two.
#[derive(Clone, Debug)]
pub struct FreeModeWallLaw<N: Number, L> {
    pub(crate) canceller: Washout<N>,
    pub(crate) wall: L,
}

impl<N: Number, L: Law<N>> Law<N> for FreeModeWallLaw<N, L> {
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        beside(self.canceller.torque(x), self.wall.evaluate(x))
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        self.canceller.update(x_e);
        self.wall.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.canceller.rest_at(x_e);
        self.wall.rest_at(x_e);
    }

    #[inline(always)]
    fn turn(&mut self) -> Option<&mut Turn<N>> {
        self.wall.turn()
    }

    fn shift(&mut self, by: N) {
        self.canceller.shift(by);
        self.wall.shift(by);
    }

    fn slopes(&self) -> Slopes {
        let wall = self.wall.slopes();
        Slopes { line: self.canceller.slope() + wall.line, wall: wall.wall }
    }
}

impl<N: Number, W: Discretize<N>> Discretize<N> for FreeModeWall<W> {
    type Law = FreeModeWallLaw<N, W::Law>;

    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
        let canceller = canceller(self.residual, setting)?;
        Ok(FreeModeWallLaw { canceller, wall: self.wall.law(setting)? })
    }
}
