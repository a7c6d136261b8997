//! A time that is known in a range.

/// A time in s that is constant, and known to lie in a range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct TimeRange {
    /// The shortest time.
    pub least: f64,
    /// The longest time.
    pub most: f64,
}

impl TimeRange {
    /// No time.
    pub const ZERO: Self = Self::exactly(0.0);

    /// An exactly known time.
    pub const fn exactly(time: f64) -> Self {
        Self { least: time, most: time }
    }

    /// A time that is known to lie between two others.
    pub const fn between(least: f64, most: f64) -> Self {
        Self { least, most }
    }

    /// The sum of this time and a following time of another range.
    pub const fn followed_by(self, next: Self) -> Self {
        if next.is_zero() {
            return self;
        }
        Self { least: self.least + next.least, most: self.most + next.most }
    }

    /// Whether the time is certainly zero.
    pub const fn is_zero(self) -> bool {
        is_zero(self.least) && is_zero(self.most)
    }

    /// Whether the time is exactly known, by its bits.
    pub const fn is_exact(self) -> bool {
        self.least.to_bits() == self.most.to_bits()
    }

    /// The series of [`Latency::trails`](crate::latency::Latency::trails) for a lag.
    pub(crate) const fn trails(self) -> usize {
        let lasts = [!is_zero(self.most), !self.is_exact() && !is_zero(self.least)];
        lasts[0] as usize + lasts[1] as usize
    }

    /// The time in the middle of the range.
    pub const fn middle(self) -> f64 {
        if self.is_exact() { self.least } else { 0.5 * (self.least + self.most) }
    }
}

/// Whether a number is zero, by its bits: a board compares doubles in software, and tests this for every
/// scene.
pub(crate) const fn is_zero(number: f64) -> bool {
    number.to_bits() << 1 == 0
}
