//! Host side of the haptic servo.
