//! A viscous damper that acts everywhere, also out of contact with a wall.

use super::delay_line::{DelayLine, VariableDelay};
use super::late_velocity::LateVelocity;
use super::law::{AnyPart, LawContext, LawOf};
use super::velocity::{Difference, Velocity};
use super::wall::{Damper, Wall};
use crate::build_error::BuildError;
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
pub type DragLaw<N, D> = LateVelocity<Difference<N>, D>;

impl<N: Number> AnyPart<N> for Drag {
    type Law = DragLaw<N, VariableDelay<N>>;
}

impl<N: Number, D: DelayLine<N>> LawOf<N, Drag> for DragLaw<N, D> {
    fn law_of(drag: &Drag, context: &LawContext) -> Result<Self, BuildError> {
        let velocity = Difference::of(Some(&drag.damper()), context.period)?;
        Ok(Self { velocity, delay: D::at_rest(drag.delay)? })
    }
}
