//! The sine of a part of a turn by a polynomial.

/// The coefficients of `u, u^3, u^5` with the smallest possible largest error on a quarter of a turn, 7e-5: a
/// seventh of a DAC's code at full scale.
pub const QUINTIC: [f32; 3] = [6.281_28, -41.095_24, 73.585_51];

/// The sine of `turn` turns, from 0 to 1, by an odd polynomial of the angle to the nearest zero.
///
/// In turns, and not in rad, the nearest zero is found by three exact subtractions. The polynomial
/// is computed by sums and products in `f32`, which are the same on every machine.
#[inline(always)]
pub fn sine<const N: usize>(turn: f32, coefficients: &[f32; N]) -> f32 {
    // Measured from the zero in the middle, where the sine falls.
    let from_middle = 0.5 - turn;
    let to_zero = 0.25 - (from_middle.abs() - 0.25).abs();
    let square = to_zero * to_zero;
    let (mut sum, mut rest) = (0.0, N);
    while rest > 0 {
        rest -= 1;
        sum = sum * square + coefficients[rest];
    }
    (sum * to_zero).copysign(from_middle)
}
