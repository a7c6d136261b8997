//! A board that is not in the firmware: its program builds and fits, and what has to be written for it is
//! short. What it does on a chip is among the virtual board's tests.

use std::fs;
use std::path::Path;
use std::process::Command;

use analysis::toolchain::{Tools, prepare};

fn source(name: &str) -> String {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware/own-board/src");
    fs::read_to_string(package.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
#[ignore = "builds for minutes"]
fn a_board_of_another_crate_builds_and_fits() {
    let toolchain = prepare(Tools::Compiler).unwrap_or_else(|error| panic!("{error}"));
    let sizes = toolchain.build_own_board().unwrap_or_else(|error| panic!("{error}")).sizes;
    let memory = toolchain.memory().unwrap();
    assert!(sizes.text > 0 && sizes.flash() <= memory.flash, "{} bytes", sizes.flash());
    assert!(sizes.bss > 0 && sizes.ram() <= memory.ram, "{} bytes", sizes.ram());
}

#[test]
fn a_board_is_one_file_of_less_than_150_lines_without_unsafe_blocks() {
    let board = source("board.rs");
    assert!(board.lines().count() < 150, "{} lines", board.lines().count());
    for part in ["impl Hardware for", "impl Startup for", "binds = TIM6_DAC", "fn HardFault("] {
        assert!(board.contains(part), "{part}");
    }
    for name in ["board.rs", "chip.rs", "main.rs", "scene.rs", "serial.rs"] {
        assert!(!source(name).contains("unsafe {"), "{name}");
    }
}

/// Its scene is certified where it is compiled for the host, too.
#[test]
fn on_the_host_it_prints_the_certificate_of_its_scene() {
    let output = Command::new(env!("CARGO"))
        // Of all default members, for which the library is built already.
        .args(["run", "--quiet", "--bin", "own-board"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // K T / 2 + B = 0.011 + 0.01, below the 0.022 N m s/rad that the device has.
    assert!(said.starts_with("verdict        certified\n"), "{said}");
    assert!(said.contains("\nalpha, bound   [0.0209999") && said.contains(", 0.0210000"), "{said}");
}
