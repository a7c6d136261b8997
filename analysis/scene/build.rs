//! Selects the scene: the program in `firmware/src/bin` with the name in `HAPTIC_SCENE`, or for a board the file
//! with that path.

use std::path::Path;
use std::{env, fs};

/// What a board's program is linked with.
#[path = "../../firmware/build.rs"]
mod firmware;

/// The scene of a build without `HAPTIC_SCENE`, such as that of a whole workspace.
const DEFAULT: &str = "damper_wall";

fn main() {
    firmware::main();
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=HAPTIC_SCENE");
    let scene = env::var("HAPTIC_SCENE").unwrap_or_else(|_| DEFAULT.into());
    let folder = |variable| env::var(variable).expect("cargo names the package's folders");
    let programs = Path::new(&folder("CARGO_MANIFEST_DIR")).join("../../firmware/src/bin");
    // An absolute path replaces the folder.
    let file = programs.join(&scene).with_extension("rs");
    println!("cargo:rerun-if-changed={}", file.display());
    let stem = file.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
    let is_board = env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none");
    // A board calls itself by the name of its program's file.
    let module = if is_board { "program" } else { &stem };
    let mut text = format!(
        "#[allow(dead_code, missing_docs, unexpected_cfgs, unused_attributes)]\n\
         #[path = {file:?}]\n\
         mod {module};\n"
    );
    if is_board {
        println!("cargo:rustc-env=CARGO_BIN_NAME={stem}");
    } else {
        let has_phase = fs::read_to_string(&file).is_ok_and(|text| text.contains("type Output ="));
        let mode = if has_phase { format!(", {module}::Output") } else { String::new() };
        text += &format!(
            "\nfn program() -> analysis::program::Program {{\n    \
             analysis::program!({module}{mode})\n}}\n"
        );
    }
    let out = Path::new(&folder("OUT_DIR")).join("scene.rs");
    fs::write(out, text).expect("cargo's folder can be written to");
}
