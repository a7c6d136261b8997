//! How a value is rounded to a format.

/// Which of its two neighbours in a format a value becomes, by magnitude: the same for both signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// The nearer one.
    Nearest,
    /// The one nearer to zero. The scales of encoder and converter are rounded so, since a
    /// controller whose torque is scaled down keeps its certificate: from `L` of the controller
    /// `C`, `Re L' > -delta` is that `1/L` lies outside of a disk whose edge passes through zero
    /// (theory, section 4.1), and what a scale below 1 divides moves away from zero.
    Inward,
    /// The one farther from zero. The coupling's compliance is rounded so: a coupling that is
    /// softer than it was written is safe behind the same rule, one that is stiffer is not
    /// (theory, section 4).
    Outward,
}
