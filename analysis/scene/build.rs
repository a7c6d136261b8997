//! Selects the scene: the program in `firmware/src/bin` with the name in `HAPTIC_SCENE`.

use std::path::Path;
use std::{env, fs};

/// The scene of a build without `HAPTIC_SCENE`, such as that of a whole workspace.
const DEFAULT: &str = "damper_wall";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=HAPTIC_SCENE");
    let name = env::var("HAPTIC_SCENE").unwrap_or_else(|_| DEFAULT.into());
    let folder = |variable| env::var(variable).expect("cargo names the package's folders");
    let programs = Path::new(&folder("CARGO_MANIFEST_DIR")).join("../../firmware/src/bin");
    let file = programs.join(&name).with_extension("rs");
    let text = format!(
        "#[allow(dead_code, missing_docs, unexpected_cfgs)]\n\
         #[path = {file:?}]\n\
         mod {name};\n\n\
         fn program() -> analysis::program::Program {{\n    analysis::program!({name})\n}}\n"
    );
    let out = Path::new(&folder("OUT_DIR")).join("scene.rs");
    fs::write(out, text).expect("cargo's folder can be written to");
}
