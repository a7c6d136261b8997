//! The programs that are flashed, on the virtual board: that package's own tests, once what it is
//! built with is there.
//!
//! They are not among those that `cargo test` builds by itself, because a library in C is: without
//! cmake there would be no tests at all.

use std::process::Command;

use analysis::toolchain::{Tools, prepare};

#[test]
fn what_is_flashed_does_what_was_promised_of_it() {
    prepare(Tools::CompilerAndVirtualBoard, |step| eprintln!("{step}")).unwrap();
    let status = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["test", "--package", "virtual-board"])
        .status()
        .unwrap();
    assert!(status.success(), "the virtual board's tests: {status}");
}
