//! The constants that the page writes for a scene are compiled here, and are that scene to the last bit: those
//! of presets, and of scenes with what the presets have not, which are files beside the constants.
//!
//! `program` is a whole program, which is compiled with its checks.
//!
//! `CONSTANTS=overwrite` keeps new ones in `tests/constants`.
#![cfg(not(target_os = "none"))]
// A program needs its certificate.
#![allow(dead_code)]

use std::path::Path;

use haptic_explore::presets;
use haptic_explore::scene_text::constant;
use haptic_model::file::program::program;
use haptic_model::file::{Format, parse};
use haptic_servo::scene::Scene;

macro_rules! kept {
    ($($name:ident)*) => {
        mod constants {
            $(pub mod $name;)*
        }

        /// The kept constants.
        const KEPT: &[(&str, Scene)] = &[$((stringify!($name), constants::$name::SCENE)),*];
    };
}

kept! {
    delayed_spring damper_wall free_mode knob undelayed_wall
    bridge composed damped encoder filtered placed rational response rigid snap table
    program
}

fn preset(name: &str) -> Option<&'static str> {
    presets::ALL.iter().find(|preset| preset.name == name).map(|preset| preset.toml)
}

#[test]
fn the_constants_of_scenes_are_the_scenes() {
    for (name, kept) in KEPT {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/constants");
        let of_preset = match *name {
            "undelayed_wall" => preset("undelayed wall behind a lag"),
            name => preset(&name.replace('_', " ")),
        };
        let read = || std::fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
        let toml = of_preset.map_or_else(read, str::to_owned);
        let file = parse(name, Format::Toml, &toml).unwrap_or_else(|error| panic!("{error}"));
        let text = match *name {
            "program" => {
                let transducers = file.board_transducers(None, None).unwrap();
                program(&file, &transducers, None, "program.toml")
            }
            _ => constant(&toml, &mut Vec::new()),
        };
        let text = text.unwrap_or_else(|why| panic!("{name}: {why}"));
        let path = folder.join(format!("{name}.rs"));
        if std::env::var_os("CONSTANTS").is_some_and(|how| how == "overwrite") {
            std::fs::write(&path, &text).unwrap();
            continue;
        }
        assert_eq!(text, std::fs::read_to_string(&path).unwrap(), "{name}");
        assert_eq!(without_cells(kept), without_cells(&file.scene), "{name}");
    }
}

/// A scene as text without the cells of its table: they follow from the units, and programs alone have them.
fn without_cells(scene: &Scene) -> String {
    let text = format!("{scene:?}");
    match text.split_once("cells: [") {
        Some((start, rest)) => start.to_owned() + rest.split_once(']').expect("an end").1,
        None => text,
    }
}

/// Lines of a program's scene that the constant of the preset has, too.
#[test]
fn presets_are_the_scenes_of_the_programs() {
    let programs = [
        ("delayed spring", include_str!("../../../firmware/src/bin/delayed_spring.rs")),
        ("damper wall", include_str!("../../../firmware/src/bin/damper_wall.rs")),
        ("free mode", include_str!("../../../firmware/src/bin/free_mode.rs")),
        ("knob", include_str!("../../../firmware/src/bin/knob.rs")),
    ];
    for (name, program) in programs {
        let text = constant(preset(name).unwrap(), &mut Vec::new()).unwrap();
        let of_scene = program.lines().skip_while(|line| !line.starts_with("pub const SCENE"));
        let lines: Vec<_> = of_scene
            .take_while(|line| *line != "};")
            .filter(|line| !line.contains("device: ") && !line.trim().starts_with("//"))
            .collect();
        assert!(lines.len() > 5, "{name}");
        for line in lines {
            assert!(text.lines().any(|own| own == line), "{name}: {line}\n{text}");
        }
    }
    let paddle = include_str!("../../../firmware/src/bin/paddle/mod.rs");
    let text = constant(preset("knob").unwrap(), &mut Vec::new()).unwrap();
    let device = text.lines().find_map(|line| line.trim().strip_prefix("device: ")).unwrap();
    assert!(paddle.contains(device.trim_end_matches(',')), "{device}");
}
