//! Foreign crates: nothing for a board comes with the library alone, a program for a board needs nothing else, and
//! a program that links only if no tick can panic.

use std::path::Path;
use std::process::{Command, Output};

use analysis::toolchain::{Tools, prepare, probe};
use tempfile::TempDir;

/// A copy of `foreign/NAME` away from the workspace, with the workspace's versions of everything.
fn copy(name: &str) -> TempDir {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = here.parent().expect("the workspace is above");
    let from = here.join("foreign").join(name);
    let to = tempfile::tempdir().expect("a temporary folder");
    let manifest = std::fs::read_to_string(from.join("Cargo.toml")).expect("the manifest");
    let firmware = root.join("firmware");
    let manifest =
        manifest.replace("../../../firmware", firmware.to_str().expect("a path in UTF-8"));
    std::fs::write(to.path().join("Cargo.toml"), manifest).expect("a writable folder");
    std::fs::copy(root.join("Cargo.lock"), to.path().join("Cargo.lock")).expect("the lock file");
    let copied = |name: &str| {
        let (from, to) = (from.join(name), to.path().join(name));
        std::fs::create_dir_all(to.parent().expect("a folder")).expect("a writable folder");
        std::fs::copy(from, to).is_ok()
    };
    let rest = ["src/lib.rs", "src/main.rs", "src/control.rs", "build.rs", ".cargo/config.toml"];
    assert!(rest.into_iter().filter(|name| copied(name)).count() > 0, "there is no source");
    to
}

fn cargo(folder: &TempDir, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO"))
        .args(arguments)
        .arg("--offline")
        .current_dir(folder.path())
        // Kept from run to run and shared, so that the library is built once.
        .env("CARGO_TARGET_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("foreign"))
        .env_remove("RUSTFLAGS")
        // Would outweigh what a foreign crate's manifest says of its profile.
        .env_remove("CARGO_PROFILE_DEV_CODEGEN_UNITS")
        .output()
        .expect("cargo starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn no_executor_no_logger_and_no_hardware_come_with_the_library() {
    for target in ["all", "thumbv7em-none-eabihf"] {
        let output = Command::new(env!("CARGO"))
            // Not offline: other targets than the host's have packages that may never have been built here.
            .args(["tree", "--package", "haptic-servo", "--edges", "normal,build"])
            .args(["--target", target])
            .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
            .output()
            .expect("cargo starts");
        let tree = text(&output.stdout);
        assert!(output.status.success() && tree.contains("fixed"), "{}", text(&output.stderr));
        for unwanted in ["embassy", "cortex-m", "defmt", "stm32", "semihosting"] {
            assert!(!tree.contains(unwanted), "{unwanted} in\n{tree}");
        }
    }
}

/// A program for a board, from nothing but the library and its linker map.
#[test]
#[ignore = "builds for minutes"]
fn a_scene_of_another_crate_runs_on_a_board() {
    let folder = copy("on_a_board");
    let map = Path::new(env!("CARGO_MANIFEST_DIR")).join("../memory.x");
    std::fs::copy(map, folder.path().join("memory.x")).expect("the linker's map");
    let toolchain = prepare(Tools::Compiler);
    let toolchain = toolchain.unwrap_or_else(|error| panic!("{error}"));
    let built = toolchain.build_foreign(folder.path(), "knob");
    let program = built.unwrap_or_else(|error| panic!("{error}"));
    let memory = toolchain.memory().unwrap();
    assert!(program.sizes.text > 0 && program.sizes.flash() <= memory.flash);
    // The servo's interrupt is where its board fetches without a wait.
    assert!(program.sizes.fast > 0 && program.sizes.fast <= memory.fast);
    let elf = std::fs::read(&program.path).unwrap();
    assert_eq!(probe::chip(&elf).unwrap(), "STM32G474RETx");
}

/// `no-panic` makes every path that unwinds call a function that does not exist.
#[test]
#[ignore = "builds for minutes"]
fn no_tick_can_panic() {
    let folder = copy("panic_free");
    let output = cargo(&folder, &["run"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let output = cargo(&folder, &["build", "--bin", "control"]);
    let said = text(&output.stderr);
    assert!(!output.status.success() && said.contains("panic in function `control`"), "{said}");
}
