//! The linker's scripts: of the start-up code, of the log, and the map in this folder, which the first
//! of them includes.

fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").expect("cargo names the package's folder");
    for argument in [format!("-L{here}"), "--nmagic".into(), "-Tlink.x".into(), "-Tdefmt.x".into()] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    println!("cargo:rerun-if-changed=memory.x");
}
