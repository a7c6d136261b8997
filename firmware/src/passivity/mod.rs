//! The passivity mathematics, all of it `const fn` and outward rounded.
//!
//! [`interval`] with `rounding` and [`polynomial`] have the numbers; [`transfer`] has functions of `z`;
//! [`poles`] classifies their poles; [`chebyshev`] turns the real part on the circle into a series, and
//! [`bernstein`] encloses its minimum, where poles crowd from `tangent`; [`discrete`] has the tests of
//! theory, section 1.
//!
//! The larger functions are never inlined: each uses hundreds of bytes, and inlined into one another they
//! would all be on a small board's stack at once. On the target, interval operations are not inlined either,
//! because each calls several software floating-point routines anyway.

pub mod bernstein;
pub mod chebyshev;
pub mod discrete;
mod exact_sum;
mod exponential;
pub mod interval;
pub mod lagged;
pub mod poles;
pub mod polynomial;
mod rounding;
mod tangent;
pub mod transfer;
