//! Scene files: accepted files, refused files and their messages, and that nothing panics.

use std::path::Path;

use crate::common::WALL;
use analysis::file::{self, FileError, Format, Purpose, SceneFile, parse_for};
use analysis::simulation::{Experiment, Integration, simulate};
use analysis::stability::judge;
use haptic_servo::certificate::certify;
use haptic_servo::environment::{Environment, Wall};
use haptic_servo::scene::{Coupling, Latency, TimeRange};

const FULL: &str = r#"{
  "name": "everything",
  "device": {"inertia": 2.2e-5, "damping": 0.022, "passivity": 0.021},
  "servo": {"period": 1e-3, "worst_period": 2e-3},
  "coupling": {"stiffness": 20},
  "environment": {"type": "free-mode-wall", "residual": 0.01, "stiffness": 3, "damping": -0.001,
                  "delay": 2, "filter": 0.5, "face": 0.1, "one_sided": true},
  "simulation": {"samples": 10, "position": 0.1, "velocity": -1,
                 "torque_sine": {"amplitude": 1, "omega": 30, "phase": 0}},
  "human": {"inertia": 1e-4, "damping": 0, "stiffness": 2},
  "limits": {"torque": 0.5, "encoder_step": 1e-4}
}"#;

fn toml(text: &str) -> Result<SceneFile, FileError> {
    file::parse("scene.toml", Format::Toml, text)
}

fn json(text: &str) -> Result<SceneFile, FileError> {
    file::parse("scene.json", Format::Json, text)
}

#[test]
fn both_formats_say_the_same() {
    let wall = toml(WALL).unwrap();
    assert_eq!(wall.name, "delayed wall");
    assert_eq!(wall.scene.coupling, Coupling::Spring { stiffness: 44.0 });
    assert_eq!(wall.scene.environment, Wall::damped(22.0, 0.01, 1).alone());
    let same = r#"{"name": "delayed wall", "device": {"inertia": 2.2e-5, "damping": 0.022},
        "servo": {"period": 0.001}, "coupling": {"stiffness": 44}, "environment": {"type":
        "damper-wall", "stiffness": 22, "damping": 0.01, "delay": 1}}"#;
    assert_eq!(json(same).unwrap(), wall);
}

#[test]
fn every_table_is_read() {
    let full = json(FULL).unwrap();
    assert_eq!(full.scene.torque_limit, Some(0.5));
    assert_eq!(full.encoder_step, Some(1e-4));
    assert_eq!(full.scene.timing.worst_period, Some(2e-3));
    assert_eq!(full.hand.unwrap().stiffness, 2.0);
    assert_eq!(full.simulation.unwrap().samples, 10);
    let rational = WALL.replace("damper-wall", "rational").replace(
        "stiffness = 22.0\ndamping = 0.01",
        "numerator = [0, 1, -1]\ndenominator = [2, 0]\nunit_zeros = 1",
    );
    let Environment::Rational(rational) = toml(&rational).unwrap().scene.environment else {
        panic!("not rational");
    };
    assert_eq!(rational.numerator.as_slice(), [1.0, -1.0]);
    assert_eq!((rational.delay, rational.unit_zeros), (1, 1));
}

#[test]
fn times_between_count_and_torque_are_numbers_or_ranges() {
    let text = WALL
        .replacen(
            "damping = 0.022",
            "damping = 0.022\nactuator_lag = [1e-4, 2e-4]\nsensor_lag = 3e-5",
            1,
        )
        .replacen(
            "period = 0.001",
            "period = 0.001\noutput_delay = [4e-6, 6e-6]\noutput_jitter = 4e-6\ncount_jitter = 0",
            1,
        )
        .replacen("stiffness = 44.0", "type = \"matched\"", 1);
    let scene = toml(&text).unwrap().scene;
    let expected = Latency {
        output_delay: TimeRange::between(4e-6, 6e-6),
        output_jitter: 4e-6,
        actuator_lag: TimeRange::between(1e-4, 2e-4),
        sensor_lag: TimeRange::exactly(3e-5),
        ..Latency::NONE
    };
    assert_eq!((scene.latency, scene.coupling), (expected, Coupling::Matched));
    assert_eq!(toml(WALL).unwrap().scene.latency, Latency::NONE);
}

/// Not even with a lagging motor, of which a file that is only looked at has no passivity.
#[test]
fn no_device_has_more_passivity_than_damping() {
    for purpose in [Purpose::Certify, Purpose::Simulate] {
        for (lag, passivity, is_read) in [
            ("", "0.022", true),
            ("", "0.02200000000000001", false),
            ("actuator_lag = 1e-4\n", "0.022", true),
            ("actuator_lag = 1e-4\n", "0.23", false),
        ] {
            let device = format!("damping = 0.022\n{lag}passivity = {passivity}");
            let text = WALL.replacen("damping = 0.022", &device, 1);
            let read = parse_for(purpose, "scene.toml", Format::Toml, &text);
            assert_eq!(read.is_ok(), is_read, "{device}: {read:?}");
        }
    }
}

/// A file with an encoder at the hand is looked at, and never certified.
#[test]
fn a_device_without_passivity_is_not_certified() {
    let text = WALL.replacen(
        "inertia = 2.2e-5\ndamping = 0.022\n",
        "encoder = \"hand\"\n[[device.mass]]\ninertia = 0.05\ndamping = 0.5\n[[device.mass]]\n\
         inertia = 0.02\ndamping = 0.25\n[[device.link]]\nstiffness = 700.0\ndamping = 0.125\n",
        1,
    );
    assert!(toml(&text).is_err());
    let read = parse_for(Purpose::Simulate, "s.toml", Format::Toml, &text).unwrap();
    let judged = analysis::verdict::judge(&read.name, &read.scene);
    assert_ne!(judged.verdict, analysis::verdict::Verdict::Certified);
}

/// Degree six with five samples of delay, in the denominator and beside it: all results are the same.
#[test]
fn delay_in_a_denominator_is_delay() {
    let with = |denominator: &str, delay: u32| {
        let environment = format!(
            "type = \"rational\"\nnumerator = [0.6, 0.2, 0, 0, 0.1, 0, 0.1]\n\
             denominator = [{denominator}]\ndelay = {delay}"
        );
        let wall = &WALL[WALL.find("type").unwrap()..];
        let text = WALL.replace(wall, &environment) + SIMULATION;
        file::parse("scene.toml", Format::Toml, &text).unwrap()
    };
    const SIMULATION: &str = "\n[simulation]\nsamples = 200\nvelocity = 0.1\n";
    let beside = with("1, -0.2, 0, 0, 0, 0, 0.01", 5);
    let certified = certify(&beside.scene).unwrap();
    let experiment = |file: &SceneFile| Experiment::of(file, Path::new(".")).unwrap();
    let moves = |file: &SceneFile| simulate(&experiment(file), Integration::default()).unwrap();
    let stability = |file: &SceneFile| judge(&experiment(file), Integration::default()).unwrap();
    assert!(moves(&beside).torque.iter().any(|torque| *torque != 0.0));
    for (denominator, delay) in [
        ("1, -0.2, 0, 0, 0, 0, 0.01, 0, 0, 0, 0, 0", 0),
        ("1, -0.2, 0, 0, 0, 0, 0.01, 0, 0", 3),
        ("0, 1, -0.2, 0, 0, 0, 0, 0.01, 0", 4),
    ] {
        let inside = with(denominator, delay);
        assert_eq!(inside.scene.environment.delay(), 5);
        assert_eq!(certify(&inside.scene).unwrap(), certified, "{denominator}");
        assert_eq!(moves(&inside), moves(&beside), "{denominator}");
        assert_eq!(stability(&inside), stability(&beside), "{denominator}");
    }
}

#[test]
fn json_is_json_and_nothing_more() {
    for text in ["", "[1]", "nul", "{\"a\": 1,}", "{a: 1}", "{} {}", "{\"a\" 1}", "// x\n{}"] {
        assert!(json(text).is_err(), "{text}");
    }
    assert!(json(&"[".repeat(100_000)).is_err());
    assert!(toml(&format!("a = {}", "[".repeat(100_000))).is_err());
    assert!(toml(&format!("{}b = 1", "a.".repeat(100_000))).is_err());
}

#[test]
fn messages_stay_short_whatever_the_file() {
    let long = "x".repeat(1_000_000);
    let texts = [
        format!("name = \"{long}\"\n{long}"),
        format!("{long} = 1"),
        format!("[{long}]"),
        WALL.replace("22.0", &format!("\"{long}\"")),
        WALL.replace("damper-wall", &long),
        WALL.replace("delay = 1", &format!("delay = 1\n{long} = 1")),
    ];
    for text in texts {
        let error = toml(&text).unwrap_err();
        assert!(error.to_string().len() < 600 && error.report(false).len() < 1200, "{error}");
    }
}

#[test]
fn all_that_is_not_toml_or_is_there_twice_is_said() {
    let said = toml("a = \nb = 1\nb = 2\n= 3\n").unwrap_err().to_string();
    assert_eq!(said.lines().count(), 3, "{said}");
    let said = json(r#"{"a": 1, "a": 2, "b": {"c": 1, "c": 2}}"#).unwrap_err().to_string();
    assert_eq!(said.matches("twice").count(), 2, "{said}");
    let many = (0..1000).map(|i| format!("key{i} = 1\n")).collect::<String>();
    let said = toml(&many).unwrap_err().to_string();
    assert!(said.contains("and 984 more problems") && said.lines().count() == 21, "{said}");
}

/// `SCENE_REFERENCE=overwrite` writes it.
#[test]
fn the_reference_is_what_the_program_prints() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("SCENE.md");
    let printed = crate::common::haptic(&["schema", "--reference"]);
    let printed = String::from_utf8(printed.stdout).unwrap();
    if std::env::var("SCENE_REFERENCE").is_ok_and(|what| what == "overwrite") {
        std::fs::write(&path, &printed).unwrap();
    }
    assert!(crate::common::read(&path) == printed, "run with SCENE_REFERENCE=overwrite");
}
