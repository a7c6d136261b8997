//! Tells the tests what this machine does not have.

use std::env;
use std::fs::OpenOptions;
use std::process::Command;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(no_terminals, no_python)");
    println!("cargo::rerun-if-changed=build.rs");
    terminals();
    python();
}

/// Not looked for again unless this file changes: each line that a terminal shows changes `/dev/pts`, and
/// all of this package would be built again.
fn terminals() {
    // A container without a devpts has the device, and an error behind it.
    if OpenOptions::new().read(true).write(true).open("/dev/ptmx").is_err() {
        println!("cargo::rustc-cfg=no_terminals");
    }
}

/// Where set-up may install Python, as root on Debian, a test that needs it has that done: nothing is
/// missing there.
fn python() {
    let is_root = || says("id", "-u").is_some_and(|id| id.trim_ascii() == b"0");
    let may_install = || is_root() && says("apt-get", "--version").is_some();
    if says("python3", "--version").is_some() || may_install() {
        return;
    }
    println!("cargo::rustc-cfg=no_python");
    // It will be written to one of these folders, or to a new folder.
    println!("cargo::rerun-if-env-changed=PATH");
    let path = env::var_os("PATH").unwrap_or_default();
    for folder in env::split_paths(&path).filter(|folder| folder.is_dir()) {
        println!("cargo::rerun-if-changed={}", folder.display());
    }
}

/// What a program prints, if it is there and content.
fn says(program: &str, argument: &str) -> Option<Vec<u8>> {
    let output = Command::new(program).arg(argument).output().ok()?;
    output.status.success().then_some(output.stdout)
}
