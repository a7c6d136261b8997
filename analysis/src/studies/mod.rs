//! Studies and measurements: the costs and errors of methods, number formats and device models.
//! None of them is needed to certify, simulate or run a scene, and no lower layer uses them; the
//! charts and the commands show the results.

pub mod bench;
pub(crate) mod error;
pub mod failures;
pub(crate) mod model;
pub mod number_format;
pub mod tradeoff;
