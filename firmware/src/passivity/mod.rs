//! The passivity mathematics, all of it `const fn` and outward rounded.
//!
//! [`interval`] and [`polynomial`] are the numbers; [`transfer`] is a function of `z`; [`poles`]
//! settles its poles; [`chebyshev`] turns its real part on the circle into a series, [`bernstein`]
//! encloses the minimum; [`discrete`] and [`continuous`] are the tests of theory, section 1;
//! [`closed_form`] has the indices that are known by formula, to check the general test against.

pub mod bernstein;
pub mod chebyshev;
pub mod closed_form;
pub mod continuous;
pub mod discrete;
pub mod interval;
pub mod poles;
pub mod polynomial;
pub mod transfer;
