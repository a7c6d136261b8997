//! The number formats as data, for comparisons.

use fixed::types::{I1F31, I8F24, I16F16};

use super::{Format, Number, Truncated};

macro_rules! formats {
    ($($(#[$meaning:meta])+ $format:ident $name:literal $number:ty;)+) => {
        /// A number format for a servo.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
        pub enum Arithmetic {
            $($(#[$meaning])+ $format,)+
        }

        impl Arithmetic {
            /// All formats.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$format),+];

            /// Its name, for tables.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$format => $name,)+
                }
            }

            /// Computes in this format.
            pub fn choose<W: InEach>(self, what: W) -> W::Output {
                match self {
                    $(Self::$format => what.with::<$number>(),)+
                }
            }
        }
    };
}

formats! {
    /// IEEE binary32, in the floating-point unit of the boards' cores.
    F32 "f32" f32;
    /// IEEE binary64, in software on these cores.
    F64 "f64" f64;
    /// Up to 32768 rad or N m, in steps of 1.5e-5.
    I16F16 "i16f16" I16F16;
    /// The same, truncated.
    I16F16Truncated "i16f16-truncated" Truncated<I16F16>;
    /// Up to 128 rad or N m, in steps of 6e-8.
    I8F24 "i8f24" I8F24;
    /// The same, truncated.
    I8F24Truncated "i8f24-truncated" Truncated<I8F24>;
    /// Up to 1 in the units of a scaled scene, in steps of 5e-10.
    I1F31 "i1f31" I1F31;
    /// The same, truncated.
    I1F31Truncated "i1f31-truncated" Truncated<I1F31>;
}

impl Arithmetic {
    /// Its number format.
    pub fn format(self) -> Format {
        self.choose(OfNumber)
    }

    /// Whether a scene must be scaled for it, because neither a turn nor a torque of 1 N m fits.
    pub const fn is_scaled(self) -> bool {
        matches!(self, Self::I1F31 | Self::I1F31Truncated)
    }
}

/// A computation in a number format that is selected at run time.
pub trait InEach {
    /// The result.
    type Output;
    /// Computes in the format `N`.
    fn with<N: Number>(self) -> Self::Output;
}

/// The format of a number.
struct OfNumber;

impl InEach for OfNumber {
    type Output = Format;

    fn with<N: Number>(self) -> Format {
        N::FORMAT
    }
}
