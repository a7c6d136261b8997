//! The direction of rounding to a format.

/// Selects one of a value's two neighbours in a format by magnitude, in the same way for both signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// The nearer neighbour.
    Nearest,
    /// The neighbour nearer to zero, for the scales of encoder and DAC: a controller whose torque is scaled
    /// down keeps its certificate. For `L` of the controller `C`, `Re L' > -delta` means that `1/L` lies
    /// outside a disk whose edge passes through zero (theory, section 4.1), and a division by a scale below 1
    /// moves it away from zero.
    Inward,
    /// The neighbour farther from zero, for the coupling's compliance: a softer coupling satisfies the same
    /// rule, a stiffer coupling may not (theory, section 4).
    Outward,
}
