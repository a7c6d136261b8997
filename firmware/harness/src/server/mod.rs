//! The emulated board's answers: questions come by the pipe `counts`, answers go by `codes`.

pub mod judge;
pub mod player;
pub mod trial;
