//! The 12-bit converter that drives the motor's current amplifier.

use core::fmt;

/// Something that holds an output until the next one is written (zero-order hold).
pub trait Dac {
    /// Writes a code; it holds until the next one.
    fn write(&mut self, code: DacCode);
}

/// A code of a 12-bit converter: mid-scale is no torque, one code up is one step of positive
/// motor torque.
///
/// ```
/// use firmware::dac::DacCode;
/// assert_eq!(DacCode::new(4095).map(DacCode::get), Ok(4095));
/// assert_eq!(
///     DacCode::new(4096).unwrap_err().to_string(),
///     "4096 is no code of a 12-bit converter: the largest is 4095"
/// );
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "wire", serde(try_from = "u16", into = "u16"))]
pub struct DacCode(u16);

impl DacCode {
    /// No torque.
    pub const MID_SCALE: Self = Self(2048);
    /// The largest code.
    pub const MAX: Self = Self(4095);
    /// Codes between mid-scale and full torque. The 2048th code below mid-scale has no counterpart
    /// above it and is left unused, so that both directions are equally strong.
    pub const CODES_TO_FULL_SCALE: u16 = 2047;

    /// Takes a code.
    pub const fn new(code: u16) -> Result<Self, CodeOutOfRange> {
        if code <= Self::MAX.0 { Ok(Self(code)) } else { Err(CodeOutOfRange { code }) }
    }

    /// The low 12 bits of a number: for a computation that cannot give more.
    #[inline(always)]
    pub(crate) const fn from_low_bits(bits: u16) -> Self {
        Self(bits & Self::MAX.0)
    }

    /// The code as the converter wants it.
    #[inline(always)]
    pub const fn get(self) -> u16 {
        self.0
    }

    /// Codes above mid-scale: the sign is that of the motor torque.
    pub const fn offset(self) -> i16 {
        self.0.cast_signed() - Self::MID_SCALE.0.cast_signed()
    }
}

impl TryFrom<u16> for DacCode {
    type Error = CodeOutOfRange;

    fn try_from(code: u16) -> Result<Self, CodeOutOfRange> {
        Self::new(code)
    }
}

impl From<DacCode> for u16 {
    fn from(code: DacCode) -> Self {
        code.get()
    }
}

/// A number that is no code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeOutOfRange {
    /// The number.
    pub code: u16,
}

impl fmt::Display for CodeOutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (code, largest) = (self.code, DacCode::MAX.0);
        write!(f, "{code} is no code of a 12-bit converter: the largest is {largest}")
    }
}

impl core::error::Error for CodeOutOfRange {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_every_code_and_nothing_else() {
        for code in 0..=u16::MAX {
            let taken = DacCode::new(code);
            if code < 4096 {
                assert_eq!(taken.map(DacCode::get), Ok(code));
                assert_eq!(DacCode::from_low_bits(code), DacCode(code));
            } else {
                assert_eq!(taken, Err(CodeOutOfRange { code }));
            }
        }
    }

    #[test]
    fn full_torque_is_as_far_from_the_middle_on_both_sides() {
        assert_eq!(DacCode::MID_SCALE.offset(), 0);
        assert_eq!(DacCode::MAX.offset(), 2047);
        assert_eq!(DacCode(1).offset(), -2047);
    }
}
