//! The program `haptic` with one scene more. `haptic run my_wall` builds this for `my_wall` and hands over to
//! it, so that a scene needs no more than its own file, and a scene that does not compile does not affect
//! others.

use std::process::ExitCode;

use clap::Parser;

// The scene's file as a module, and `program()`, which makes a program of it.
include!(concat!(env!("OUT_DIR"), "/scene.rs"));

fn main() -> ExitCode {
    analysis::program::add(program());
    analysis::command::execute(analysis::command::Arguments::parse())
}
