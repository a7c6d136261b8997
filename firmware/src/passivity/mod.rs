//! The passivity mathematics: interval arithmetic, polynomials on the unit circle, and the index.

pub mod interval;
