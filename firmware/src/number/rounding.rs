//! How a value is rounded to a format.

/// Which of its two neighbours in a format a value becomes, by magnitude: the same for both signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// The nearer one.
    Nearest,
    /// The one nearer to zero, for the scales of encoder and DAC: a controller whose torque is
    /// scaled down keeps its certificate. For `L` of the controller `C`, `Re L' > -delta` means
    /// that `1/L` lies outside of a disk whose edge passes through zero (theory, section 4.1), and
    /// a division by a scale below 1 moves it away from zero.
    Inward,
    /// The one farther from zero, for the coupling's compliance: a coupling softer than written is
    /// safe behind the same rule, a stiffer one is not (theory, section 4).
    Outward,
}
