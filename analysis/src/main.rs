//! The `haptic` program; see [`analysis::command`].

use std::process::ExitCode;

use analysis::command::{Arguments, execute};

fn main() -> ExitCode {
    execute(Arguments::of_program())
}
