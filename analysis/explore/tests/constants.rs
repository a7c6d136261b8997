//! The constants that the page writes for a scene are compiled here, and are that scene to the last bit.
//!
//! `CONSTANTS=overwrite` keeps new ones in `tests/constants`.
#![cfg(not(target_os = "none"))]
// A program needs its certificate.
#![allow(dead_code)]

use std::path::Path;

use haptic_explore::{constant, presets};
use haptic_model::file::{Format, parse};
use haptic_servo::scene::Scene;

#[path = "constants/bridge.rs"]
mod bridge;
#[path = "constants/composed.rs"]
mod composed;
#[path = "constants/damped.rs"]
mod damped;
#[path = "constants/damper_wall.rs"]
mod damper_wall;
#[path = "constants/delayed_spring.rs"]
mod delayed_spring;
#[path = "constants/filtered.rs"]
mod filtered;
#[path = "constants/free_mode.rs"]
mod free_mode;
#[path = "constants/knob.rs"]
mod knob;
#[path = "constants/placed.rs"]
mod placed;
#[path = "constants/rational.rs"]
mod rational;
#[path = "constants/response.rs"]
mod response;
#[path = "constants/rigid.rs"]
mod rigid;
#[path = "constants/snap.rs"]
mod snap;
#[path = "constants/table.rs"]
mod table;
#[path = "constants/undelayed_wall.rs"]
mod undelayed_wall;

/// Scenes with what the presets have not: the keys of `[device]` beside inertia and damping, the tables
/// `[servo]` and `[coupling]`, and the rest.
const OTHERS: &[(&str, [&str; 3])] = &[
    (
        "filtered",
        [
            "passivity = 0.021",
            "period = 0.001\nworst_period = 0.0011\n[coupling]\nstiffness = 38",
            "type = \"free-mode-wall\"\nresidual = 0.018\nstiffness = 3\ndamping = 0.001\ndelay = 2\n\
             filter = 0.25\nface = 0.3\none_sided = true",
        ],
    ),
    (
        "placed",
        [
            "",
            "period = 0.0005\n[coupling]\nstiffness = 40",
            "type = \"damper-wall\"\nstiffness = 3\ndamping = 0.001\ndelay = 1\nface = -0.125",
        ],
    ),
    (
        "rational",
        [
            "",
            "period = 0.001\n[coupling]\nstiffness = 40",
            "type = \"rational\"\nnumerator = [5.0, -2.0]\ndenominator = [1.0, -0.3, 0.1, 0.0]\ndelay = 1",
        ],
    ),
    (
        "damped",
        [
            "",
            "period = 0.001\n[coupling]\nstiffness = 44",
            "type = \"profile\"\ndelay = 1\ndamping = 0.002\ntorque = 0.03\ncount = 12\n\
             [[environment.shape]]\ntype = \"detents\"\ncount = 24\ntorque = 0.05\ncentre = 0.01",
        ],
    ),
    (
        "snap",
        [
            "",
            "period = 0.001\n[coupling]\nstiffness = 44",
            "type = \"profile\"\ndelay = 1\n[[environment.shape]]\ntype = \"detents\"\ncount = 24\n\
             torque = 0.1\nsnap = 0.75\n[[environment.shape]]\ntype = \"end_stops\"\nfrom = -0.6\n\
             to = 0.6\nstiffness = 12.0",
        ],
    ),
    (
        "table",
        [
            "",
            "period = 0.001\n[coupling]\nstiffness = 44",
            "type = \"profile\"\ndelay = 1\nfrom = -0.1\nto = 0.5\nstiffness = 9\n\
             knots = [[0.0, 0.0], [0.1, 0.02], [0.3, -0.02], [0.4, 0.0]]\n[[environment.shape]]\n\
             type = \"magnet\"\nangle = 0.2\nwidth = 0.15\ntorque = 0.01",
        ],
    ),
    (
        "composed",
        [
            "",
            "period = 0.001\n[coupling]\nstiffness = 44",
            "type = \"profile\"\ndelay = 1\nresidual = 0.018\n[[environment.shape]]\ntype = \"detents\"\n\
             count = 24\ntorque = 0.02\n[[environment.shape]]\ntype = \"end_stops\"\nfrom = -1.5\nto = 1.5\n\
             stiffness = 5.0\n[environment.wall]\nstiffness = 2.0\ndamping = 0.001\ndelay = 1\nface = 1.2\n\
             one_sided = true",
        ],
    ),
    (
        "bridge",
        [
            "passivity = 0.0215\nactuator_lag = 7.957747154594767e-5\nactuator_updates = 4",
            "period = 0.0001\noutput_delay = 2.5e-5\n[coupling]\ntype = \"matched\"",
            "type = \"delayed-spring\"\nstiffness = 20\ndelay = 1",
        ],
    ),
    (
        "response",
        [
            "actuator_response = [2.0e-5, 2.5e-4]",
            "period = 0.001\noutput_delay = 6.0e-6\n[coupling]\ntype = \"matched\"",
            "type = \"delayed-spring\"\nstiffness = 2\ndelay = 1",
        ],
    ),
    ("rigid", ["", "period = 0.001", "type = \"delayed-spring\"\nstiffness = 2\ndelay = 1"]),
];

/// Whether the text is the kept one, and the scene of the file that of the kept text.
fn same(name: &str, toml: &str, kept: Scene) {
    let text =
        constant::constant(toml, &mut Vec::new()).unwrap_or_else(|why| panic!("{name}: {why}"));
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/constants/{name}.rs"));
    if std::env::var_os("CONSTANTS").is_some_and(|how| how == "overwrite") {
        std::fs::write(&file, &text).unwrap();
        return;
    }
    assert_eq!(text, std::fs::read_to_string(&file).unwrap(), "{name}");
    let scene = parse(name, Format::Toml, toml).unwrap_or_else(|error| panic!("{error}")).scene;
    assert_eq!(kept, scene, "{name}");
}

fn preset(name: &str) -> &'static str {
    presets::ALL.iter().find(|preset| preset.name == name).unwrap().toml
}

fn other(name: &str) -> String {
    let (_, [device, servo, environment]) =
        OTHERS.iter().find(|(other, _)| *other == name).unwrap();
    // No bound is known for a limited rational environment, nor a bound without a coupling.
    let limit = if ["rational", "rigid"].contains(&name) { "" } else { "[limits]\ntorque = 1.5\n" };
    format!(
        "name = \"{name}\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n{device}\n[servo]\n{servo}\n\
         {limit}[environment]\n{environment}\n"
    )
}

#[test]
fn the_constants_of_presets_are_their_scenes() {
    same("delayed_spring", preset("delayed spring"), delayed_spring::SCENE);
    same("damper_wall", preset("damper wall"), damper_wall::SCENE);
    same("free_mode", preset("free mode"), free_mode::SCENE);
    same("knob", preset("knob"), knob::SCENE);
    same("undelayed_wall", preset("undelayed wall behind a lag"), undelayed_wall::SCENE);
}

#[test]
fn the_constants_of_all_types_are_their_scenes() {
    same("filtered", &other("filtered"), filtered::SCENE);
    same("placed", &other("placed"), placed::SCENE);
    same("rational", &other("rational"), rational::SCENE);
    same("damped", &other("damped"), damped::SCENE);
    same("snap", &other("snap"), snap::SCENE);
    same("table", &other("table"), table::SCENE);
    same("composed", &other("composed"), composed::SCENE);
    same("bridge", &other("bridge"), bridge::SCENE);
    same("response", &other("response"), response::SCENE);
    same("rigid", &other("rigid"), rigid::SCENE);
    assert_eq!(OTHERS.len(), 10);
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
        let text = constant::constant(preset(name), &mut Vec::new()).unwrap();
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
    let text = constant::constant(preset("knob"), &mut Vec::new()).unwrap();
    let device = text.lines().find_map(|line| line.trim().strip_prefix("device: ")).unwrap();
    assert!(paddle.contains(device.trim_end_matches(',')), "{device}");
}
