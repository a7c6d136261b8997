//! Linker scripts of the programs that run on a board. The library and host builds need none.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // The tests on a board ask for it, which is no mistake.
    println!("cargo:rustc-check-cfg=cfg(rust_analyzer)");
    if env::var_os("CARGO_CFG_TARGET_OS").is_none_or(|os| os != "none") {
        return;
    }
    let manifest = env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
    let Some(root) = Path::new(&manifest).parent() else { return };
    // All boards share the map in the workspace's root; a package without it (the library taken
    // by somebody else) links nothing here.
    let map = root.join("memory.x");
    if !map.exists() {
        return;
    }
    println!("cargo:rerun-if-changed={}", map.display());
    // Arguments of this package's own programs, so that a program that depends on the library
    // finds its own map and not this one.
    let has = |feature| env::var_os(feature).is_some();
    let mut arguments = vec![format!("-L{}", root.display()), "--nmagic".into(), "-Tlink.x".into()];
    if has("CARGO_FEATURE_LOG") || has("CARGO_FEATURE_STM32") {
        arguments.push("-Tdefmt.x".into());
    }
    for argument in &arguments {
        println!("cargo:rustc-link-arg-bins={argument}");
        println!("cargo:rustc-link-arg-tests={argument}");
    }
    if has("CARGO_FEATURE_ON_TARGET") {
        println!("cargo:rustc-link-arg-tests=-Tembedded-test.x");
    }
}
