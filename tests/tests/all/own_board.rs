//! A board that is not in the firmware: its program builds and fits, and what has to be written for it is
//! short. What it does on a chip is among the virtual board's tests.

use std::fs;
use std::path::Path;

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
