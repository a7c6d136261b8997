//! The law of every wall: a spring with an optional damper, face and delay.

use super::delay_line::{DelayLine, VariableDelay};
use super::law::{AnyPart, Law, LawContext, LawOf};
use super::velocity::{AnyVelocity, Velocity};
use super::wall::{Side, Wall};
use crate::build_error::BuildError;
use crate::coupling::{Contact, Response, Slopes};
use crate::number::Number;

/// The position of a wall, and whether it can pull.
pub trait Place<N>: Clone + core::fmt::Debug + Sized {
    /// That of a side.
    ///
    /// # Errors
    /// If the number format cannot represent its position, or it is not such a side.
    fn of(side: Side) -> Result<Self, BuildError>;
    /// Depth in rad of the position `x` (rad) behind the wall's rest position.
    #[inline(always)]
    fn depth(&self, x: N) -> N {
        x
    }
    /// Whether the wall acts only at positive depths and only pushes.
    #[inline(always)]
    fn one_sided(&self) -> bool {
        false
    }
}

/// At rest at zero, pushes and pulls: costs nothing.
#[derive(Clone, Copy, Debug)]
pub struct Centred;

impl<N> Place<N> for Centred {
    fn of(side: Side) -> Result<Self, BuildError> {
        match side {
            Side::Centred => Ok(Self),
            _ => Err(BuildError::Structure),
        }
    }
}

/// At rest at a face, pushes and pulls.
#[derive(Clone, Copy, Debug)]
pub struct Displaced<N>(pub(crate) N);

impl<N: Number> Place<N> for Displaced<N> {
    fn of(side: Side) -> Result<Self, BuildError> {
        match side {
            Side::Displaced(position) => Ok(Self(BuildError::number("wall face", position)?)),
            _ => Err(BuildError::Structure),
        }
    }

    #[inline(always)]
    fn depth(&self, x: N) -> N {
        x.minus(self.0)
    }
}

/// Behind a face, only pushes.
#[derive(Clone, Copy, Debug)]
pub struct Face<N>(pub(crate) N);

impl<N: Number> Place<N> for Face<N> {
    fn of(side: Side) -> Result<Self, BuildError> {
        match side {
            Side::Face(position) => Ok(Self(BuildError::number("wall face", position)?)),
            _ => Err(BuildError::Structure),
        }
    }

    #[inline(always)]
    fn depth(&self, x: N) -> N {
        x.minus(self.0)
    }

    #[inline(always)]
    fn one_sided(&self) -> bool {
        true
    }
}

/// Any of these, for scenes as data.
#[derive(Clone, Copy, Debug)]
pub struct AnyPlace<N> {
    pub(crate) face: N,
    pub(crate) one_sided: bool,
}

impl<N: Number> Place<N> for AnyPlace<N> {
    fn of(side: Side) -> Result<Self, BuildError> {
        let face = BuildError::number("wall face", side.position())?;
        Ok(Self { face, one_sided: side.is_one_sided() })
    }

    fn depth(&self, x: N) -> N {
        x.minus(self.face)
    }

    fn one_sided(&self) -> bool {
        self.one_sided
    }
}

/// `F = K p + B v` with the depth `p = x_E - face`; one-sided: zero outside and never negative.
#[derive(Clone, Debug)]
pub struct WallLaw<N: Number, V, S, D> {
    stiffness: N::Coefficient,
    velocity: V,
    side: S,
    delay: D,
}

impl<N: Number, V: Velocity<N>, S: Place<N>, D: DelayLine<N>> WallLaw<N, V, S, D> {
    /// Torque of the spring and damper alone, as if the wall had no face.
    #[inline(always)]
    fn line(&self, x: N, depth: N) -> N {
        self.velocity.add_to(depth.times(self.stiffness), x)
    }

    /// The wall's torque in N m with the environment at `x` (rad), undelayed.
    #[inline(always)]
    fn torque(&self, x: N) -> N {
        let depth = self.side.depth(x);
        if !self.side.one_sided() {
            self.line(x, depth)
        } else if depth <= N::ZERO {
            N::ZERO
        } else {
            // If the depth is NaN, the torque must be NaN, too, which is a fault.
            self.line(x, depth).positive_part()
        }
    }

    /// The undelayed response.
    #[inline(always)]
    fn immediate(&self, x: N) -> Response<N> {
        let depth = self.side.depth(x);
        let torque = self.line(x, depth);
        if self.side.one_sided() {
            Response::Wall(Contact { torque, depth })
        } else {
            Response::Line(torque)
        }
    }
}

impl<N: Number> AnyPart<N> for Wall {
    type Law = WallLaw<N, AnyVelocity<N>, AnyPlace<N>, VariableDelay<N>>;
}

impl<N, V, S, D> LawOf<N, Wall> for WallLaw<N, V, S, D>
where
    N: Number,
    V: Velocity<N>,
    S: Place<N>,
    D: DelayLine<N>,
{
    fn law_of(wall: &Wall, context: &LawContext) -> Result<Self, BuildError> {
        let velocity = V::of(wall.damper.as_ref(), context.period)?;
        let (side, delay) = (S::of(wall.side)?, D::at_rest(wall.delay)?);
        let stiffness = BuildError::coefficient::<N>("wall stiffness", wall.stiffness)?;
        Ok(Self { stiffness, velocity, side, delay })
    }
}

impl<N: Number, V: Velocity<N>, S: Place<N>, D: DelayLine<N>> Law<N> for WallLaw<N, V, S, D> {
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        match self.delay.due() {
            Some(torque) => Response::Held(torque),
            None => self.immediate(x),
        }
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        if self.delay.due().is_some() {
            let torque = self.torque(x_e);
            self.delay.push(torque);
        }
        self.velocity.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.velocity.rest_at(x_e);
        let torque = self.torque(x_e);
        self.delay.fill(torque);
    }

    fn slopes(&self) -> Slopes {
        let slope = N::coefficient_to_f64(self.stiffness) + self.velocity.slope();
        match (self.delay.due(), self.side.one_sided()) {
            (Some(_), _) => Slopes::default(),
            (None, false) => Slopes { line: slope, wall: 0.0 },
            (None, true) => Slopes { line: 0.0, wall: slope },
        }
    }
}
