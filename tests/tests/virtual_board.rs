//! The programs that are flashed, on the virtual board: that package's own tests, once what it is
//! built with is there.
//!
//! They are not among the tests that `cargo test` builds by itself, because a library in C is: a
//! machine without cmake could then build none of them.

use std::process::Command;

use analysis::toolchain::{Tools, prepare};

#[test]
fn what_is_flashed_does_what_was_promised_of_it() {
    prepare(Tools::CompilerAndVirtualBoard, |step| eprintln!("{step}")).unwrap();
    // Of the whole workspace, so that what is built already serves.
    let tests = ["test", "--workspace", "--lib", "--test", "board"];
    let status = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["test", "--package", "virtual-board"])
        .status()
        .unwrap();
    let _ = tests;
    assert!(status.success(), "the virtual board's tests: {status}");
}
