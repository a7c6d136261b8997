//! Linker scripts of the programs that run on a board. The library and host builds need none.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
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
    println!("cargo:rustc-link-arg-bins=-L{}", root.display());
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if ["CARGO_FEATURE_LOG", "CARGO_FEATURE_STM32"].iter().any(|f| env::var_os(f).is_some()) {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}
