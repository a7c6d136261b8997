//! The passivity mathematics, all of it `const fn` and outward rounded.
//!
//! [`interval`], rounded in `rounding`, and [`polynomial`] are the numbers; [`transfer`] is a
//! function of `z`; [`poles`] settles its poles; [`chebyshev`] turns its real part on the circle
//! into a series, [`bernstein`] encloses the minimum; [`discrete`] has the tests of
//! theory, section 1.
//!
//! The larger functions are never inlined: each works on hundreds of bytes, and inlined into one
//! another they would all be on a small board's stack at once. Nor are the interval operations on
//! the target, where each is a call of several software floating-point routines anyway.

pub mod bernstein;
pub mod chebyshev;
pub mod discrete;
mod exponential;
pub mod interval;
pub mod lagged;
pub mod poles;
pub mod polynomial;
mod rounding;
pub mod transfer;
