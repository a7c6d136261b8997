//! The number formats as data, for comparisons.

use fixed::types::{I1F31, I8F24, I16F16};

use super::{Format, Number, Truncated};

/// A number format for a servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Arithmetic {
    /// IEEE binary32, in the floating-point unit of the boards' cores.
    F32,
    /// IEEE binary64, in software on these cores.
    F64,
    /// Up to 32768 rad or N m, in steps of 1.5e-5.
    I16F16,
    /// The same, truncated.
    I16F16Truncated,
    /// Up to 128 rad or N m, in steps of 6e-8.
    I8F24,
    /// The same, truncated.
    I8F24Truncated,
    /// Up to 1 in the units of a scaled scene, in steps of 5e-10.
    I1F31,
    /// The same, truncated.
    I1F31Truncated,
}

/// A computation in a number format that is selected at run time.
pub trait InEach {
    /// The result.
    type Output;
    /// Computes in the format `N`.
    fn with<N: Number>(self) -> Self::Output;
}

impl Arithmetic {
    /// All formats.
    pub const ALL: [Self; 8] = [
        Self::F32,
        Self::F64,
        Self::I16F16,
        Self::I16F16Truncated,
        Self::I8F24,
        Self::I8F24Truncated,
        Self::I1F31,
        Self::I1F31Truncated,
    ];

    /// Its name, for tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
            Self::I16F16 => "i16f16",
            Self::I16F16Truncated => "i16f16-truncated",
            Self::I8F24 => "i8f24",
            Self::I8F24Truncated => "i8f24-truncated",
            Self::I1F31 => "i1f31",
            Self::I1F31Truncated => "i1f31-truncated",
        }
    }

    /// Its number format.
    pub fn format(self) -> Format {
        self.choose(OfNumber)
    }

    /// Whether a scene must be scaled for it, because neither a turn nor a torque of 1 N m fits.
    pub const fn is_scaled(self) -> bool {
        matches!(self, Self::I1F31 | Self::I1F31Truncated)
    }

    /// Computes in this format.
    pub fn choose<W: InEach>(self, what: W) -> W::Output {
        match self {
            Self::F32 => what.with::<f32>(),
            Self::F64 => what.with::<f64>(),
            Self::I16F16 => what.with::<I16F16>(),
            Self::I16F16Truncated => what.with::<Truncated<I16F16>>(),
            Self::I8F24 => what.with::<I8F24>(),
            Self::I8F24Truncated => what.with::<Truncated<I8F24>>(),
            Self::I1F31 => what.with::<I1F31>(),
            Self::I1F31Truncated => what.with::<Truncated<I1F31>>(),
        }
    }
}

/// The format of a number.
struct OfNumber;

impl InEach for OfNumber {
    type Output = Format;

    fn with<N: Number>(self) -> Format {
        N::FORMAT
    }
}
