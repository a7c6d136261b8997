//! A wall: a spring, everywhere or behind a face, with or without a damper.

use crate::parameter::Parameter;

/// A spring with an optional damper, delayed by whole samples:
/// `E(z) = z^-delay (stiffness + damping (z - 1) / (T z))` (equation 24 for one sample).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Wall {
    /// Stiffness `K` in N m/rad.
    pub stiffness: f64,
    /// The damper; `None`: a spring.
    pub damper: Option<Damper>,
    /// Where it is at rest, and whether it pulls.
    pub side: Side,
    /// Delay in whole samples.
    pub delay: usize,
}

/// The damper of a wall, on the backward difference of the position: `B (z - 1) / (T z)`, with the velocity
/// filter `(1 - a) / (1 - a / z)` if it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Damper {
    /// Damping `B` in N m s/rad; may be negative: the certificate decides.
    pub damping: f64,
    /// Pole `a` of the velocity filter, `0 <= a < 1`; `None`: no filter.
    pub filter: Option<f64>,
}

/// Where a wall is at rest, in rad, and whether it pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Side {
    /// At rest at zero, pushes and pulls.
    Centred,
    /// At rest at this position, pushes and pulls.
    Displaced(f64),
    /// Acts only above this position, its face, and never pulls.
    Face(f64),
}

impl Side {
    /// The position of rest, or of the face.
    pub const fn position(self) -> f64 {
        match self {
            Self::Centred => 0.0,
            Self::Displaced(position) | Self::Face(position) => position,
        }
    }

    /// Whether it never pulls.
    pub const fn is_one_sided(self) -> bool {
        matches!(self, Self::Face(_))
    }

    /// The same side at another position.
    pub const fn at(self, position: f64) -> Self {
        match self {
            Self::Centred | Self::Displaced(_) => Self::Displaced(position),
            Self::Face(_) => Self::Face(position),
        }
    }
}

impl Wall {
    /// A spring that pushes and pulls, at rest at zero.
    pub const fn spring(stiffness: f64, delay: usize) -> Self {
        Self { stiffness, damper: None, side: Side::Centred, delay }
    }

    /// A spring with a damper of `damping` N m s/rad that pushes and pulls, at rest at zero.
    pub const fn damped(stiffness: f64, damping: f64, delay: usize) -> Self {
        let damper = Some(Damper { damping, filter: None });
        Self { stiffness, damper, side: Side::Centred, delay }
    }

    /// The same with a filter of its velocity, if it has a damper.
    pub const fn filtered(self, pole: f64) -> Self {
        let damper = match self.damper {
            Some(damper) => Some(Damper { filter: Some(pole), ..damper }),
            None => None,
        };
        Self { damper, ..self }
    }

    /// The same at rest at this position in rad.
    pub const fn placed(self, position: f64) -> Self {
        Self { side: Side::Displaced(position), ..self }
    }

    /// The same behind a face at this position in rad: it never pulls.
    pub const fn behind(self, face: f64) -> Self {
        Self { side: Side::Face(face), ..self }
    }

    /// The same structure with these numbers, all of which it has.
    #[inline(always)]
    pub(crate) fn with_numbers(&self, number: impl Fn(Parameter) -> Option<f64>) -> Self {
        let of = |parameter, like| number(parameter).unwrap_or(like);
        let filter = |like| of(Parameter::Filter, like);
        Self {
            stiffness: of(Parameter::Stiffness, self.stiffness),
            damper: self.damper.map(|like| Damper {
                damping: of(Parameter::Damping, like.damping),
                filter: like.filter.map(filter),
            }),
            side: match self.side {
                Side::Centred => Side::Centred,
                Side::Displaced(like) => Side::Displaced(of(Parameter::Face, like)),
                Side::Face(like) => Side::Face(of(Parameter::Face, like)),
            },
            delay: self.delay,
        }
    }

    /// Damping in N m s/rad; 0 without a damper.
    pub const fn damping(&self) -> f64 {
        match self.damper {
            Some(damper) => damper.damping,
            None => 0.0,
        }
    }

    /// The pole of its velocity filter.
    pub const fn filter(&self) -> Option<f64> {
        let damper = some!(self.damper);
        damper.filter
    }

    /// The position of rest, or of the face, in rad.
    pub const fn face(&self) -> f64 {
        self.side.position()
    }

    /// Whether it never pulls.
    pub const fn is_one_sided(&self) -> bool {
        self.side.is_one_sided()
    }
}
