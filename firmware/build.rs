//! Linker scripts of the programs that run on a board: the firmware's own, those of its harness, and tests. The
//! libraries and host builds need none.

use std::env;
use std::path::Path;

/// Also for a package with a program of a scene outside of this one.
pub fn main() {
    // Without this line, the script would run after a change of any file of the package.
    println!("cargo:rerun-if-changed=Cargo.toml");
    // Used by the tests on a board.
    println!("cargo:rustc-check-cfg=cfg(rust_analyzer)");
    if env::var_os("CARGO_CFG_TARGET_OS").is_none_or(|os| os != "none") {
        return;
    }
    let manifest = env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
    // All boards share the memory map in the workspace's root; without it (the library as a
    // dependency) nothing is linked here.
    let mut roots = Path::new(&manifest).ancestors().skip(1).take(2);
    let Some(root) = roots.find(|root| root.join("firmware/memory.x").exists()) else { return };
    println!("cargo:rerun-if-changed={}", root.join("memory.x").display());
    // Arguments only for this package's own programs, so that a program that depends on the library uses its
    // own map.
    let any = |features: &[&str]| {
        features.iter().any(|name| env::var_os(format!("CARGO_FEATURE_{name}")).is_some())
    };
    let mut arguments = vec![format!("-L{}", root.display()), "--nmagic".into()];
    // Before the script that would otherwise take its sections.
    let measured = root.join("firmware/src/board/qemu/measured.x");
    println!("cargo:rerun-if-changed={}", measured.display());
    if any(&["LOG", "EMULATED"]) {
        arguments.push(format!("-T{}", measured.display()));
    }
    let harness = root.join("firmware/src/board/qemu/harness.x");
    println!("cargo:rerun-if-changed={}", harness.display());
    if any(&["EMULATED"]) {
        arguments.push(format!("-T{}", harness.display()));
    }
    // A server of the harness certifies any scene with all its remedies, unlike a board: its stack uses RAM
    // that the emulated board has and the smallest board lacks.
    if any(&["EMULATED"]) {
        arguments.extend([
            "--defsym=_stack_end=0x20000000 + 22K".into(),
            "--defsym=_stack_start=0x20000000 + 128K".into(),
        ]);
    }
    arguments.push("-Tlink.x".into());
    if any(&["STM32"]) {
        arguments.push("-Tdefmt.x".into());
    }
    // A package of tests has only tests.
    let tests = any(&["EMBEDDED_TEST"]);
    if tests {
        arguments.push("-Tembedded-test.x".into());
    }
    for argument in &arguments {
        println!("cargo:rustc-link-arg-{}={argument}", if tests { "tests" } else { "bins" });
    }
}
