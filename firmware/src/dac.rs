//! The 12-bit DAC that drives the motor's current amplifier.

use core::fmt;

/// An output that holds each code until the next (zero-order hold).
pub trait Dac {
    /// Writes a code; the output holds it until the next.
    fn write(&mut self, code: DacCode);
}

/// A code of a 12-bit DAC: mid-scale is zero torque, one code more is one step of positive motor torque.
///
/// ```
/// use haptic_servo::dac::DacCode;
/// assert_eq!(DacCode::new(4095).map(DacCode::get), Ok(4095));
/// assert_eq!(
///     DacCode::new(4096).unwrap_err().to_string(),
///     "4096 is not a code of a 12-bit DAC: the largest is 4095"
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
    /// Codes between mid-scale and full torque in both directions, in the linear range of every board's
    /// output. The same number for all boards, the emulated board and the host, so that all compute the same
    /// codes; a board whose [`OutputRange`] has fewer does not compile.
    pub const CODES_TO_FULL_SCALE: u16 = 1791;

    /// Takes a code.
    pub const fn new(code: u16) -> Result<Self, CodeOutOfRange> {
        if code <= Self::MAX.0 { Ok(Self(code)) } else { Err(CodeOutOfRange { code }) }
    }

    /// The low 12 bits of a number, for a computation whose result has no more.
    #[inline(always)]
    pub(crate) const fn from_low_bits(bits: u16) -> Self {
        Self(bits & Self::MAX.0)
    }

    /// The code with a torque of so many codes beside it, which are together within full scale.
    #[inline(always)]
    pub const fn beside(self, codes: i32) -> Self {
        Self::from_low_bits(self.0.wrapping_add(codes as u16))
    }

    /// The code as a number for the DAC.
    #[inline(always)]
    pub const fn get(self) -> u16 {
        self.0
    }

    /// Codes above mid-scale: the sign is that of the motor torque.
    pub const fn offset(self) -> i16 {
        self.0.cast_signed() - Self::MID_SCALE.0.cast_signed()
    }
}

/// The usable range of a DAC's output: near its rails the output buffer saturates, and the torque is smaller
/// than the code's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputRange {
    /// Lowest voltage of the DAC's supply and reference in V.
    pub supply: f64,
    /// Smallest distance of the output from either rail in V.
    pub headroom: f64,
}

impl OutputRange {
    /// Number of linear codes on both sides of mid-scale.
    ///
    /// ```
    /// use haptic_servo::dac::OutputRange;
    /// assert_eq!(OutputRange { supply: 3.3, headroom: 0.2 }.codes_each_way(), 1798);
    /// assert_eq!(OutputRange { supply: 3.3, headroom: 0.0 }.codes_each_way(), 2047);
    /// ```
    pub const fn codes_each_way(&self) -> u16 {
        let lost = self.headroom / self.supply * 4096.0;
        // Above mid-scale there is one code less than below it.
        let above = DacCode::MAX.0 - DacCode::MID_SCALE.0;
        // Written so that NaN gives none.
        if !(lost >= 0.0 && lost <= above as f64) {
            return 0;
        }
        // The cast rounds down a positive number.
        (above as f64 - lost) as u16
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

/// A number that is not a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeOutOfRange {
    /// The number.
    pub code: u16,
}

impl fmt::Display for CodeOutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (code, largest) = (self.code, DacCode::MAX.0);
        write!(f, "{code} is not a code of a 12-bit DAC: the largest is {largest}")
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

    #[test]
    fn full_torque_is_within_what_a_buffered_output_gives_at_its_lowest_supply() {
        let buffered = |supply| OutputRange { supply, headroom: 0.2 }.codes_each_way();
        assert_eq!(buffered(3.2), DacCode::CODES_TO_FULL_SCALE);
        // In volts, by the manuals' formula: code over 4096 (RM0440) or 4095 (RM0090) of the supply.
        let full = f64::from(DacCode::CODES_TO_FULL_SCALE);
        for steps in [4095.0, 4096.0] {
            let volts = |offset: f64| 3.2 * (2048.0 + offset) / steps;
            assert!(volts(-full) >= 0.2 && volts(full) <= 3.0, "{steps}");
        }
        assert_eq!(buffered(0.0), 0);
        assert_eq!(buffered(f64::NAN), 0);
    }
}
