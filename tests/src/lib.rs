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

/// How long a search is by an environment variable, if there is one of this name.
///
/// # Panics
/// If it is not a number.
pub fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|value| value.parse().unwrap_or_else(|e| panic!("{name}: {e}")))
}

/// The examples of the README are tests, of this package and not of the firmware's: who has that alone
/// has no README above it.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub mod readme {}
