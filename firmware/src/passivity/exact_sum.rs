//! Sums of doubles without rounding.

use super::rounding::add_down;

/// A sum of doubles without rounding: Shewchuk's expansion, whose parts do not overlap and grow.
pub(super) struct ExactSum<const CAPACITY: usize> {
    parts: [f64; CAPACITY],
    used: usize,
    /// Whether no number and no partial sum was beyond the largest double.
    pub is_finite: bool,
}

impl<const CAPACITY: usize> ExactSum<CAPACITY> {
    /// No number.
    pub const EMPTY: Self = Self { parts: [0.0; CAPACITY], used: 0, is_finite: true };

    /// Adds a number; at most `CAPACITY` of them.
    pub const fn add(&mut self, number: f64) {
        let mut x = number;
        let mut kept = 0;
        each!(k in 0..self.used => {
            let y = self.parts[k];
            let sum = x + y;
            let y_seen = sum - x;
            let error = (x - (sum - y_seen)) + (y - y_seen);
            if error != 0.0 {
                self.parts[kept] = error;
                kept += 1;
            }
            x = sum;
        });
        self.is_finite &= x.is_finite();
        self.parts[kept] = x;
        self.used = kept + 1;
    }

    /// Adds a product with a whole number of at most 26 bits, in two parts that are exact.
    pub const fn add_product(&mut self, number: f64, whole: f64) {
        let upper = f64::from_bits(number.to_bits() >> 27 << 27);
        self.add(upper * whole);
        self.add((number - upper) * whole);
    }

    /// Whether the sum is zero: each of its parts is, since they do not overlap.
    pub const fn is_zero(&self) -> bool {
        each!(k in 0..self.used => {
            if self.parts[k] != 0.0 {
                return false;
            }
        });
        true
    }

    /// A lower bound, next to the sum.
    pub const fn rounded_down(&self) -> f64 {
        self.times_sign_rounded_down(1.0)
    }

    /// A lower bound of its negative.
    pub const fn negative_rounded_down(&self) -> f64 {
        self.times_sign_rounded_down(-1.0)
    }

    const fn times_sign_rounded_down(&self, sign: f64) -> f64 {
        let mut sum = 0.0;
        each!(k in 0..self.used => {
            sum = add_down(sum, sign * self.parts[k]);
        });
        sum
    }
}
