//! The program `haptic` with one more scene. `haptic run my_wall` builds this for `my_wall` and executes it,
//! so that a scene only needs its own file, and a scene that does not compile does not affect others.

use std::process::ExitCode;

use clap::Parser;

// The scene's file as a module, and `program()`, which returns its program.
include!(concat!(env!("OUT_DIR"), "/scene.rs"));

fn main() -> ExitCode {
    analysis::program::add(program());
    analysis::command::execute(analysis::command::Arguments::parse())
}
