//! Tells the tests what this machine does not have.

use std::fs::OpenOptions;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(no_terminals)");
    println!("cargo::rerun-if-changed=build.rs");
    // Where it changes, a machine has begun or ceased to have them.
    println!("cargo::rerun-if-changed=/dev/pts");
    // A container without a devpts has the device, and an error behind it.
    if OpenOptions::new().read(true).write(true).open("/dev/ptmx").is_err() {
        println!("cargo::rustc-cfg=no_terminals");
    }
}
