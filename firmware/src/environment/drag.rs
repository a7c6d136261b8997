//! A viscous damper that acts everywhere, also out of contact with a wall.

use super::delay_line::{DelayLine, VariableDelay};
use super::law::{AnyPart, Law, LawContext, LawOf};
use super::velocity::{Difference, Velocity};
use super::wall::{Damper, Wall};
use crate::build_error::BuildError;
use crate::coupling::{Response, Slopes};
use crate::number::Number;
use crate::parameter::Parameter;

/// A torque in proportion to the velocity: `E(z) = z^-delay damping (z - 1) / (T z)`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Drag {
    /// Damping `B` in N m s/rad; may be negative: the certificate decides.
    pub damping: f64,
    /// Delay in whole samples.
    pub delay: usize,
}

impl Drag {
    /// A drag of this damping in N m s/rad and delay in whole samples.
    pub const fn of(damping: f64, delay: usize) -> Self {
        Self { damping, delay }
    }

    /// The damper of a wall with this velocity.
    const fn damper(&self) -> Damper {
        Damper { damping: self.damping, filter: None }
    }

    /// The wall without stiffness that has the same torque.
    pub(crate) const fn as_wall(&self) -> Wall {
        Wall { damper: Some(self.damper()), ..Wall::spring(0.0, self.delay) }
    }

    /// The same structure with this number.
    #[inline(always)]
    pub(crate) fn with_numbers(&self, number: impl Fn(Parameter) -> Option<f64>) -> Self {
        Self { damping: number(Parameter::Drag).unwrap_or(self.damping), ..*self }
    }
}

/// The law of a [`Drag`].
#[derive(Clone, Debug)]
pub struct DragLaw<N: Number, D> {
    velocity: Difference<N>,
    delay: D,
}

impl<N: Number> AnyPart<N> for Drag {
    type Law = DragLaw<N, VariableDelay<N>>;
}

impl<N: Number, D: DelayLine<N>> LawOf<N, Drag> for DragLaw<N, D> {
    fn law_of(drag: &Drag, context: &LawContext) -> Result<Self, BuildError> {
        let velocity = Difference::of(Some(&drag.damper()), context.period)?;
        Ok(Self { velocity, delay: D::at_rest(drag.delay)? })
    }
}

impl<N: Number, D: DelayLine<N>> Law<N> for DragLaw<N, D> {
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        match self.delay.due() {
            Some(torque) => Response::Held(torque),
            None => Response::Line(self.velocity.torque(x)),
        }
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        if self.delay.due().is_some() {
            self.delay.push(self.velocity.torque(x_e));
        }
        self.velocity.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.velocity.rest_at(x_e);
        self.delay.fill(N::ZERO);
    }

    fn shift(&mut self, by: N) {
        self.velocity.shift(by);
    }

    fn slopes(&self) -> Slopes {
        match self.delay.due() {
            Some(_) => Slopes::default(),
            None => Slopes { line: self.velocity.slope(), wall: 0.0 },
        }
    }
}
