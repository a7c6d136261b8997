//! Outward-rounded interval arithmetic in `f64`, usable in `const fn`.

/// A closed interval of reals that encloses a value; `lo <= hi`, never NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

impl Interval {
    /// Lower end.
    pub const fn lo(self) -> f64 {
        self.lo
    }
    /// Upper end.
    pub const fn hi(self) -> f64 {
        self.hi
    }
}
