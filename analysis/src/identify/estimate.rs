//! An estimate, with its confidence interval.

/// Confidence of all intervals.
pub const CONFIDENCE: f64 = 0.95;

/// A number with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Estimate {
    /// The same of a number that may be larger or smaller by this part of it.
    pub fn within_part(self, part: f64) -> Self {
        let Self { lo, hi, .. } = self;
        Self { lo: lo - part * lo.abs(), hi: hi + part * hi.abs(), ..self }
    }

    /// Whether the interval leaves out 0.
    pub fn is_significant(&self) -> bool {
        self.lo > 0.0 || self.hi < 0.0
    }
}
