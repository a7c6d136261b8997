//! The servers on the emulated board: requests come by the pipe `counts`, replies go by `codes`.

pub mod bench;
pub mod certify;
pub mod servo;
