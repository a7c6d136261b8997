//! The program `haptic` with one more scene. `haptic run my_wall` builds this for `my_wall` and executes it,
//! so that a scene only needs its own file, and a scene that does not compile does not affect others.
//!
//! For a board it is the program of a scene's file outside of `firmware/src/bin`, such as
//! `haptic flash wall.toml` writes.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
use std::process::ExitCode;

#[cfg(not(target_os = "none"))]
use clap::Parser;

// The scene's file as a module, and `program()`, which returns its program.
include!(concat!(env!("OUT_DIR"), "/scene.rs"));

#[cfg(not(target_os = "none"))]
fn main() -> ExitCode {
    analysis::program::add(program());
    analysis::command::execute(analysis::command::Arguments::parse())
}
