//! The `haptic` program; see [`analysis::command`].

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    analysis::command::execute(analysis::command::Arguments::parse())
}
