//! The error of an encoder over the angle, where it is simulated.

/// The angle in rad that an encoder of this linearity shows, with the steepest error of one period in a turn.
pub fn shown(angle: f64, linearity: f64) -> f64 {
    if linearity == 0.0 { angle } else { angle + linearity * angle.sin() }
}
