//! Tells the tests what this machine does not have.

use std::fs::OpenOptions;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(no_terminals)");
    println!("cargo::rerun-if-changed=build.rs");
    terminals();
}

/// Not looked for again unless this file changes: each line that a terminal shows changes `/dev/pts`, and
/// all of this package would be built again.
fn terminals() {
    // A container without a devpts has the device, and an error behind it.
    if OpenOptions::new().read(true).write(true).open("/dev/ptmx").is_err() {
        println!("cargo::rustc-cfg=no_terminals");
    }
}
