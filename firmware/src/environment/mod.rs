//! Virtual environments: position `x_E` (rad) to torque `F` (N m).
//!
//! Sign: `F` is the torque that the environment exerts *on the coupling* against positive
//! deflection, so the motor applies `-F` to the device. A spring is `F = stiffness * x_E`.
//!
//! Each environment is a type of its own, so that a program contains only what its scene uses.
//! [`Environment`] is the same as data, for scenes that are read from a file or from the wire.

mod data;

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
    /// Damping `B` in N m s/rad; may be negative, which is for the certificate to judge.
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

/// A wall that is felt only beyond `face` and never pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneSided<W> {
    /// Position of the face in rad; the wall occupies the angles above it.
    pub face: f64,
    /// The wall behind the face.
    pub wall: W,
}

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

/// Largest degree of a [`Rational`] numerator or denominator.
pub const MAX_DEGREE: usize = 8;
/// Longest delay in samples.
pub const MAX_DELAY: usize = 8;

/// Any proper rational `E(z)` up to degree 8, with up to 8 samples of delay on top:
/// `E(z) = z^-delay (z - 1)^unit_zeros numerator(z) / denominator(z)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rational {
    /// Numerator, descending powers of z, `numerator.0[..numerator.1]`.
    pub numerator: Coefficients,
    /// Denominator, descending powers of z.
    pub denominator: Coefficients,
    /// Delay in whole samples.
    pub delay: usize,
    /// Zeros at `z = 1` that multiply the numerator. Declaring them keeps them exact where the
    /// coefficients of the product would not sum to zero in binary.
    pub unit_zeros: usize,
}

/// A polynomial's coefficients in descending powers, at most `MAX_DEGREE + 1` of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    values: [f64; MAX_DEGREE + 1],
    len: usize,
}

impl Coefficients {
    /// Takes descending coefficients; `None` if there are none or more than `MAX_DEGREE + 1`.
    pub const fn new(descending: &[f64]) -> Option<Self> {
        if descending.is_empty() || descending.len() > MAX_DEGREE + 1 {
            return None;
        }
        let mut values = [0.0; MAX_DEGREE + 1];
        let mut i = 0;
        while i < descending.len() {
            values[i] = descending[i];
            i += 1;
        }
        Some(Self { values, len: descending.len() })
    }

    /// The coefficients in descending powers.
    pub const fn as_slice(&self) -> &[f64] {
        self.values.split_at(self.len).0
    }
}

/// A spring with an optional damper, as data.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// Whether the wall is felt only above `face`.
    pub one_sided: bool,
}

/// Any environment as data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Environment {
    /// [`DelayedSpring`], placed or one-sided.
    DelayedSpring(Wall),
    /// [`DamperWall`] or [`FilteredWall`], placed or one-sided.
    DamperWall(Wall),
    /// [`FreeMode`].
    FreeMode {
        /// Damping `epsilon` in N m s/rad that is left.
        residual: f64,
        /// Delay in whole samples.
        delay: usize,
    },
    /// [`FreeModeWall`].
    FreeModeWall {
        /// Damping `epsilon` in N m s/rad that is left.
        residual: f64,
        /// The wall that ends the free motion.
        wall: Wall,
    },
    /// [`Rational`].
    Rational(Rational),
}
