//! The `haptic` program; see [`analysis::command`].

use std::process::ExitCode;

fn main() -> ExitCode {
    analysis::command::execute(analysis::command::Arguments::of_program())
}
