//! Currents and voltages of three phases as vectors: at rest, and turning with the magnets.
//!
//! Clarke's transformation keeps the amplitude: the vector of three phases has the amplitude of one phase.

use core::hint::cold_path;

use super::sample::Duties;
use super::sine_table::sine_and_cosine;
use super::timing::PwmTiming;

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
