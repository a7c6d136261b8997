//! The launcher's output during a build and after it; cargo and `haptic` are scripts.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const LINE: &str = "building haptic, which takes minutes the first time\n";

/// Another process writes the file: a file that this process had open could not be run.
fn install(folder: &Path, name: &str, script: &str) {
    let draft = folder.join("draft");
    fs::write(&draft, format!("#!/bin/sh\n{script}\n")).unwrap();
    copy(&draft, &folder.join(name));
}

fn copy(from: &Path, to: &Path) {
    assert!(
        Command::new("install").args(["-m", "755"]).arg(from).arg(to).status().unwrap().success()
    );
}

/// Asks for a certificate where cargo does this.
fn ask(cargo: &str) -> Output {
    let folder = tempfile::tempdir().unwrap();
    let launcher = folder.path().join("haptic-launcher");
    copy(Path::new(env!("CARGO_BIN_EXE_haptic-launcher")), &launcher);
    install(folder.path(), "cargo", cargo);
    install(folder.path(), "haptic", "echo \"$*\"; exit 1");
    Command::new(launcher)
        .args(["certify", "--json", "a wall.toml"])
        .env("CARGO", folder.path().join("cargo"))
        .output()
        .unwrap()
}

#[test]
fn nothing_is_added_to_an_answer() {
    let output = ask("true");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "certify --json a wall.toml\n");
    assert!(output.stderr.is_empty());
}

#[test]
fn a_build_that_takes_long_is_spoken_of_and_not_in_the_answer() {
    let output = ask("sleep 3");
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "certify --json a wall.toml\n");
    assert_eq!(String::from_utf8(output.stderr).unwrap(), LINE);
}

#[test]
fn what_does_not_build_does_not_run() {
    let output = ask("echo 'error: it does not compile' >&2; exit 101");
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "error: it does not compile\n");
}
