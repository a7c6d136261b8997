//! The pulse-width modulation: its periods in a period of the servo, the samples of each, and its compare values;
//! for three phases from vectors of currents and voltages, at rest and turning with the magnets.
//!
//! Clarke's transformation keeps the amplitude: the vector of three phases has the amplitude of one phase.

use core::f64::consts::TAU;
use core::hint::cold_path;

use super::drive::DriveError;
use crate::encoder::RawCount;

/// Lowest and highest frequency in Hz of the modulation: below, the ripple grows and beats become audible;
/// above, the interrupts take too much of the processor, and the dead time too much of the voltage.
const FREQUENCIES: (f64, f64) = (30e3, 40e3);

/// Relative tolerance of a whole number of counts, for rounding.
const WHOLE: f64 = 1e-9;

/// The modulation's timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PwmTiming {
    /// The reload value: the timer counts up to it and down to zero in a period.
    pub counts: u16,
    /// Periods of the modulation in a period of the servo.
    pub updates: u16,
}

impl PwmTiming {
    /// The highest allowed frequency whose periods fill a period of the servo in s exactly, by a timer with this
    /// clock in Hz.
    ///
    /// # Errors
    /// If there is no such frequency.
    pub const fn of(period: f64, clock: f64) -> Result<Self, DriveError> {
        let wanted = period * clock / 2.0;
        // All casts round positive numbers down; NaN and numbers that are too large do not count as whole.
        let halves = (wanted + 0.5) as u32;
        let is_whole = (wanted - halves as f64).abs() <= WHOLE * wanted;
        let mut updates = (period * FREQUENCIES.1 * (1.0 + WHOLE)) as u16;
        while is_whole && updates as f64 >= period * FREQUENCIES.0 * (1.0 - WHOLE) && updates > 0 {
            let counts = halves / updates as u32;
            if halves.is_multiple_of(updates as u32) && counts <= u16::MAX as u32 {
                return Ok(Self { counts: counts as u16, updates });
            }
            updates -= 1;
        }
        Err(DriveError::Period {
            period,
            lowest: FREQUENCIES.0,
            highest: FREQUENCIES.1,
            nearest: nearest(period, clock),
        })
    }

    /// A period of the modulation in s, as a part of a period of the servo in s.
    pub const fn instant(&self, period: f64) -> f64 {
        period / self.updates as f64
    }

    /// No voltage: all phases at half.
    pub(super) const fn no_voltage(self) -> Duties {
        Duties([self.counts / 2; 3])
    }

    /// A voltage from U to V, as the difference of their compare values, symmetric about half, rounded to the
    /// nearest.
    #[inline(always)]
    pub(super) const fn between_two(self, difference: f32) -> Duties {
        // The cast rounds a positive number down.
        let high = (difference + (self.counts as f32 + 0.5)) as u32;
        let above = high >> 1;
        let below = self.counts as u32 - (high - above);
        Duties([above as u16, below as u16, self.counts / 2])
    }
}

/// The longest possible period that a timer can fill, at most `period` and at least one period of the
/// modulation.
const fn nearest(period: f64, clock: f64) -> f64 {
    let updates = whole(period * FREQUENCIES.1 * (1.0 + WHOLE)).max(1.0);
    let least = whole(clock / 2.0 / FREQUENCIES.1) + 1.0;
    let most = whole(clock / 2.0 / FREQUENCIES.0);
    let counts = whole(period * clock / 2.0 / updates).max(least).min(most);
    2.0 * updates * counts / clock
}

/// A positive number, rounded down.
const fn whole(number: f64) -> f64 {
    number as u32 as f64
}

/// The samples of one instant of the modulation, in the middle of the low sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Counts of the currents of the phases U and V.
    pub currents: [u16; 2],
    /// Count of the supply.
    pub bus: u16,
    /// Count of the temperature.
    pub temperature: u16,
    /// The encoder's counter.
    pub position: RawCount,
}

/// Compare values of the phases U, V and W: the high side conducts while the timer is below. A brushed motor is
/// between U and V, and W is at half.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Duties(pub [u16; 3]);

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
