//! Detents with a snap point in scene files, and the commands' results for them.

use std::f64::consts::TAU;

use crate::common::{answer, haptic_reading, program};
use analysis::file::{self, FileError, Format, Purpose, SceneFile, parse_for, write};
use analysis::profile_curve::ProfileCurve;
use haptic_servo::parameter::Parameter;

const HEAD: &str = "name = \"knob\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n[servo]\n\
                    period = 0.001\n[coupling]\nstiffness = 44.0\n[limits]\ntorque = 1.0\n\
                    full_scale = 1.0\n[environment]\ntype = \"profile\"\n";
const SNAP: &str = "delay = 1\n[[environment.shape]]\ntype = \"detents\"\ncount = 24\ntorque = 0.1\n\
                    snap = 0.75\n";
const STOPS: &str =
    "[[environment.shape]]\ntype = \"end_stops\"\nfrom = -2.0\nto = 2.0\nstiffness = 12.0\n";
const TRAILER: &str = "[simulation]\nsamples = 400\nposition = 0.02\n";

fn text(environment: &str) -> String {
    format!("{HEAD}{environment}")
}

fn read(environment: &str) -> Result<SceneFile, FileError> {
    file::parse("knob.toml", Format::Toml, &text(environment))
}

#[test]
fn a_file_has_what_the_library_makes_of_the_shape() {
    let file = read(&format!("{SNAP}{STOPS}")).unwrap();
    let profile = file.scene.environment.profile().unwrap();
    let snap = profile.snap.unwrap();
    assert_eq!((profile.torque, profile.count, snap.snap()), (0.1, 24.0, 0.75));
    assert!((snap.pitch(&profile.layout()) - TAU / 24.0).abs() < 1e-12);
    // Its torque and its number change with those of the whole.
    let file = read(&format!("torque = 0.05\ncount = 12\n{SNAP}{STOPS}")).unwrap();
    let layout = file.scene.environment.profile().unwrap().layout();
    assert_eq!((snap.torque(&layout), snap.pitch(&layout)), (0.05, TAU / 12.0));
    assert!(
        read(&SNAP.replace("snap = 0.75\n", ""))
            .unwrap()
            .scene
            .environment
            .profile()
            .unwrap()
            .snap
            .is_none()
    );
}

#[test]
fn what_is_written_reads_back_as_the_same_scene() {
    let again = |file: &SceneFile| {
        let written = write::toml(file);
        parse_for(Purpose::Simulate, "b.toml", Format::Toml, &written)
            .unwrap_or_else(|error| panic!("{error}\n{written}"))
    };
    let texture = "[[environment.shape]]\ntype = \"detents\"\ncount = 8\ntorque = 0.01\n";
    for environment in [
        SNAP.to_owned(),
        format!("{SNAP}centre = 0.01\n{STOPS}"),
        format!("damping = 1e-3\ntorque = 0.2\ncount = 7\n{SNAP}{texture}"),
    ] {
        let file = read(&environment).unwrap_or_else(|error| panic!("{error}\n{environment}"));
        assert_eq!(again(&file), file, "{environment}");
        for parameter in [Parameter::ProfileTorque, Parameter::Stiffness, Parameter::Count] {
            let Some(value) = file.scene.get(parameter) else { continue };
            let scene = file.scene.with(parameter, 2.0 * value).unwrap();
            let changed = SceneFile { scene, ..file.clone() };
            assert_eq!(again(&changed).scene, scene, "{environment}");
        }
    }
}

#[test]
fn a_snap_point_that_makes_no_sense_is_named() {
    let refused = |environment: &str, line: usize, words: &[&str]| {
        let message = read(environment).expect_err(environment).to_string();
        assert!(message.starts_with(&format!("knob.toml:{line}:")), "{message}");
        words.iter().for_each(|word| assert!(message.contains(word), "{word}: {message}"));
    };
    let with = |snap: &str| SNAP.replace("0.75", snap);
    let key = "`environment.shape[0].snap` = ";
    for snap in ["0.5", "0.45", "11"] {
        refused(
            &with(snap),
            19,
            &[key, snap, "greater than 0.5, half-way to the next detent, and at most 10"],
        );
    }
    refused(&with("0"), 19, &[key, "greater than 0"]);
    refused(&with("\"a\""), 19, &[key, "is a string"]);
    let second = SNAP.replace("delay = 1\n", "");
    refused(
        &format!("{SNAP}{second}"),
        21,
        &["`environment.shape[1]`", "second shape with `snap`"],
    );
    let stops = format!("{STOPS}snap = 1.1\n");
    refused(
        &format!("{SNAP}{stops}"),
        25,
        &["`environment.shape[1].snap` is not a key of a end_stops"],
    );
}

fn certify(environment: &str) -> serde_json::Value {
    answer(&haptic_reading(&["certify", "-", "--json"], text(environment).as_bytes()))
}

#[test]
fn the_verdict_is_that_of_the_steepest_branch() {
    let passes = certify(&format!("{SNAP}{STOPS}"));
    assert_eq!(passes["verdict"], "certified", "{passes}");
    // `k = F n / (2 pi s)`, beside the end stops.
    let line = 0.1 * 24.0 / (TAU * 0.75);
    let bound = passes["bound"]["hi"].as_f64().unwrap();
    assert!((bound / (0.5e-3 * (line + 12.0)) - 1.0).abs() < 1e-6, "{passes}");
    let late = certify(&SNAP.replace("delay = 1", "delay = 2"));
    assert_eq!(late["verdict"], "undecided", "{late}");
    assert!(late["message"].as_str().unwrap().contains("delay of 0 or 1, a coupling"), "{late}");
    let rigid = text(SNAP).replace("[coupling]\nstiffness = 44.0\n", "");
    let rigid = answer(&haptic_reading(&["certify", "-", "--json"], rigid.as_bytes()));
    assert_eq!(rigid["verdict"], "undecided", "{rigid}");
    let outside = format!("{SNAP}centre = 0.1\n{}", STOPS.replace("2.0", "0.05"));
    let outside = certify(&outside);
    assert!(outside["message"].as_str().unwrap().contains("detent with a snap point"), "{outside}");
}

#[test]
fn the_chart_has_a_line_for_each_detent() {
    let file = read(&format!("{SNAP}{STOPS}")).unwrap();
    let curve = ProfileCurve::of(&file.scene).unwrap();
    // Seven detents on either side of the detent at zero are between the end stops.
    assert_eq!(curve.branches.len(), 15);
    let middle = &curve.branches[7];
    let reach = 0.75 * TAU / 24.0;
    for (snap, sign) in middle.snaps.iter().zip([-1.0, 1.0]) {
        assert!((snap[0] - sign * reach).abs() < 1e-9, "{snap:?}");
        assert!((snap[1] - sign * 0.1).abs() < 1e-5, "{snap:?}");
        // A quarter of a pitch on the other side of the next detent's centre.
        assert!((snap[2] + sign * 0.1 * 0.25 / 0.75).abs() < 1e-5, "{snap:?}");
    }
    assert_eq!(curve.branches[0].snaps.len(), 1);
    let line = 0.1 * 24.0 / (TAU * 0.75);
    assert!((curve.rise.slope / (line + 12.0) - 1.0).abs() < 1e-6, "{:?}", curve.rise);
    assert!((curve.certified.unwrap() / 44.0 - 1.0).abs() < 1e-3, "{:?}", curve.certified);
    let alone = ProfileCurve::of(&read(SNAP).unwrap().scene).unwrap();
    assert!((alone.rise.slope / line - 1.0).abs() < 1e-6, "{:?}", alone.rise);
    assert!((alone.certified.unwrap() / 44.0 - 1.0).abs() < 1e-3, "{:?}", alone.certified);
    assert_eq!(alone.fall.slope, 0.0);
}

/// Nothing panics, and if there is no answer, the sentence gives the reason.
#[test]
fn every_command_answers_or_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = [
        SNAP.to_owned(),
        format!("{SNAP}{STOPS}"),
        SNAP.replace("delay = 1", "delay = 0"),
        SNAP.replace("delay = 1", "delay = 2"),
    ];
    for (number, environment) in scenes.iter().enumerate() {
        let file = folder.path().join(format!("{number}.toml"));
        std::fs::write(&file, format!("{}{TRAILER}", text(environment))).unwrap();
        let name = file.to_str().unwrap();
        let commands: [&[&str]; 7] = [
            &["certify", name, "--format", "f32"],
            &["simulate", name],
            &["stability", name],
            &["worst-hand", name],
            &["chart", "profile", name, "-o", "profile.svg"],
            &["chart", "map", name, "-o", "map.svg"],
            &["design", "largest", "torque", name],
        ];
        for arguments in commands {
            let run = program(arguments).current_dir(folder.path()).output().unwrap();
            let said = String::from_utf8_lossy(&run.stderr).into_owned();
            assert!(!said.contains("panicked"), "{arguments:?}: {said}");
            let is_answer = matches!(run.status.code(), Some(0 | 1));
            assert!(
                is_answer || said.contains("no transfer function") || number == 3,
                "{arguments:?}: {said}"
            );
        }
        let drawn = std::fs::read_to_string(folder.path().join("profile.svg")).unwrap();
        assert!(drawn.contains("a detent snaps to the next one"), "{number}");
    }
}
