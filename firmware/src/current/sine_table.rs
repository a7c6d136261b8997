//! Sine and cosine of a phase by a table: the cheapest method whose error is invisible in a code
//! (`analysis/src/studies/tradeoff/sine.rs` compares the methods).

use core::f64::consts::TAU;

/// Entries per turn. The error of linear interpolation is 7.5e-5, and of the rounded entries another 1.5e-5:
/// together a third of half a code at full scale.
const ENTRIES: usize = 256;

/// Sines of 15 bits; the last entry repeats the first.
static TABLE: [i16; ENTRIES + 1] = {
    let (mut table, mut i) = ([0; ENTRIES + 1], 0);
    while i <= ENTRIES {
        table[i] = rounded(32767.0 * series(TAU * (i as f64 / ENTRIES as f64)));
        i += 1;
    }
    table
};

/// The sine of an angle of up to a turn in rad, whose last term is below 1e-13.
const fn series(angle: f64) -> f64 {
    let (mut term, mut sum, mut k) = (angle, 0.0, 1.0);
    while k < 36.0 {
        sum += term;
        term *= -angle * angle / ((k + 1.0) * (k + 2.0));
        k += 2.0;
    }
    sum
}

const fn rounded(number: f64) -> i16 {
    // The cast rounds to zero.
    (number + if number < 0.0 { -0.5 } else { 0.5 }) as i16
}

/// Sine and cosine of an angle in parts of a turn of 2^32.
#[inline(always)]
pub fn sine_and_cosine(angle: u32) -> [f32; 2] {
    [sine(angle), sine(angle.wrapping_add(1 << 30))]
}

/// Integer arithmetic up to the last product.
#[inline(always)]
fn sine(angle: u32) -> f32 {
    let (entry, part) = ((angle >> 24) as usize, (angle >> 8 & 0xffff).cast_signed());
    let (low, high) = (i32::from(TABLE[entry]), i32::from(TABLE[entry + 1]));
    ((low << 16) + (high - low) * part) as f32 * (1.0 / (32767.0 * 65536.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_off_by_less_than_it_says() {
        for k in 0..200_000_u32 {
            let angle = k.wrapping_mul(2_654_435_769);
            let exact = TAU * f64::from(angle) / 2_f64.powi(32);
            let [sine, cosine] = sine_and_cosine(angle).map(f64::from);
            assert!((sine - exact.sin()).abs() < 9.1e-5, "{angle}: {sine}");
            assert!((cosine - exact.cos()).abs() < 9.1e-5, "{angle}: {cosine}");
        }
        assert_eq!(sine_and_cosine(0), [0.0, 1.0]);
        assert_eq!(sine_and_cosine(3 << 30), [-1.0, 0.0]);
    }
}
