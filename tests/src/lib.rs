//! What the tests of the whole share: an independent, exact reference for the certificate, random
//! scenes, passive hands, and the sampled loop that they close.
//!
//! No reference here uses the firmware's mathematics. It decides in rational arithmetic with
//! remainder sequences; the firmware encloses in binary intervals with Bernstein polynomials.

pub mod agreement;
pub mod exact;
pub mod floats;
pub mod hands;
pub mod index;
pub mod loops;
pub mod plant;
pub mod poly;
pub mod remainders;
pub mod replica;
pub mod rounding;
pub mod rules;
pub mod scenes;
pub mod vectors;

/// The examples of the README are tests, of this package and not of the firmware's: who has that alone
/// has no README above it.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub mod readme {}
