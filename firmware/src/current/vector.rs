//! Currents and voltages of three phases as vectors: at rest, and turning with the magnets.
//!
//! Clarke's transformation keeps the amplitude: the vector of three phases has the amplitude of one phase.

use core::f64::consts::TAU;
use core::hint::cold_path;

use super::modulation::{Duties, PwmTiming};

/// Entries of the table of sines per turn: the cheapest method whose error is invisible in a code
/// (`analysis/src/studies/tradeoff/sine.rs` compares the methods). The error of linear interpolation is 7.5e-5, and
/// of the rounded entries another 1.5e-5: together a third of half a code at full scale.
const ENTRIES: usize = 256;

const ROOT_3: f32 = 1.732_050_8;

/// A vector: along and across the magnets in the turning frame, or along and across U in the frame at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vector {
    pub along: f32,
    pub across: f32,
}

/// An angle, by its cosine and sine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rotation {
    cosine: f32,
    sine: f32,
}

impl Rotation {
    /// The rotation by an angle in parts of a turn of 2^32.
    #[inline(always)]
    pub(super) fn of(angle: u32) -> Self {
        let [sine, cosine] = sine_and_cosine(angle);
        Self { cosine, sine }
    }

    /// The same rotation, advanced by a small angle in rad, up to a half. The two terms of each series never
    /// make a vector longer.
    #[inline(always)]
    pub(super) const fn ahead(self, angle: f32) -> Self {
        // A larger angle is a jump of the count and not a speed of the handle.
        let angle = angle.clamp(-0.5, 0.5);
        let square = angle * angle;
        let (cosine, sine) = (1.0 - 0.5 * square, angle * (1.0 - square * (1.0 / 6.0)));
        Self {
            cosine: self.cosine * cosine - self.sine * sine,
            sine: self.sine * cosine + self.cosine * sine,
        }
    }
}

impl Vector {
    /// The vector of the currents in U and V; the current in W makes the sum zero.
    #[inline(always)]
    pub(super) const fn of_two_phases(u: f32, v: f32) -> Self {
        Self { along: u, across: (u + 2.0 * v) * (1.0 / ROOT_3) }
    }

    /// The vector in a frame turned by that angle.
    #[inline(always)]
    pub(super) const fn seen_from(self, rotation: Rotation) -> Self {
        let Rotation { cosine, sine } = rotation;
        Self {
            along: self.along * cosine + self.across * sine,
            across: self.across * cosine - self.along * sine,
        }
    }

    /// The vector turned by that angle.
    #[inline(always)]
    pub(super) const fn turned(self, rotation: Rotation) -> Self {
        let Rotation { cosine, sine } = rotation;
        Self {
            along: self.along * cosine - self.across * sine,
            across: self.across * cosine + self.along * sine,
        }
    }

    #[inline(always)]
    pub(super) const fn times(self, factor: f32) -> Self {
        Self { along: self.along * factor, across: self.across * factor }
    }

    /// The vector limited to this length, in the same direction; and whether it was limited.
    #[inline(always)]
    pub(super) fn within(self, length: f32) -> (Self, bool) {
        let square = self.along * self.along + self.across * self.across;
        if square <= length * length {
            return (self, false);
        }
        cold_path();
        (self.times(length * one_over_root(square)), true)
    }

    /// The components of the phases U, V and W.
    #[inline(always)]
    const fn phases(self) -> [f32; 3] {
        let (u, half) = (self.along, -0.5 * self.along);
        let part = 0.5 * ROOT_3 * self.across;
        [u, half + part, half - part]
    }

    /// The loss by the dead time of each phase's compare value with these currents: `counts` with the
    /// current's sign, and zero without a current (theory, section 15.9).
    #[inline(always)]
    pub(super) const fn dead_time(self, counts: f32) -> [f32; 3] {
        let [u, v, w] = self.phases();
        let counts = if self.along == 0.0 && self.across == 0.0 { 0.0 } else { counts };
        [counts.copysign(u), counts.copysign(v), counts.copysign(w)]
    }

    /// Compare values of a voltage in counts, with the compensation of the dead time. Their common part is
    /// chosen so that the highest and the lowest are equally far from half.
    #[inline(always)]
    pub(super) const fn duties(self, dead_time: [f32; 3], timing: PwmTiming) -> Duties {
        let [u, v, w] = self.phases();
        let (u, v, w) = (u + dead_time[0], v + dead_time[1], w + dead_time[2]);
        let highest = larger(larger(u, v), w);
        let lowest = smaller(smaller(u, v), w);
        let middle = 0.5 * (highest + lowest);
        // The casts round positive numbers down.
        let zero = 0.5 * timing.counts as f32 + 0.5 - middle;
        Duties([(u + zero) as u16, (v + zero) as u16, (w + zero) as u16])
    }
}

/// The larger of two numbers. `f32::max`, which also handles NaN, is a function call on these chips.
#[inline(always)]
pub(super) const fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers.
#[inline(always)]
const fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The reciprocal square root of a positive number, from below: by halving its exponent, and Newton's
/// iteration.
#[cold]
#[inline(never)]
fn one_over_root(square: f32) -> f32 {
    let mut root = f32::from_bits(0x5f37_59df - (square.to_bits() >> 1));
    for _ in 0..3 {
        root *= 1.5 - 0.5 * square * root * root;
    }
    root * (1.0 - 4.0 * f32::EPSILON)
}

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
