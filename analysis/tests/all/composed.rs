//! A wall and a canceller beside a torque profile: scene files that have them, and the commands that take
//! such a file.

use crate::common::{answer, haptic_reading, program};
use analysis::file::{self, FileError, Format, Purpose, SceneFile, parse_for, write};
use haptic_servo::environment::{Canceller, Parts, Wall};
use haptic_servo::parameter::Parameter;

const HEAD: &str = "name = \"knob\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n[servo]\n\
                    period = 0.001\n[coupling]\nstiffness = 44.0\n[environment]\ntype = \"profile\"\n";
const DETENTS: &str =
    "delay = 1\n[[environment.shape]]\ntype = \"detents\"\ncount = 24\ntorque = 0.05\n";
const STOPS: &str =
    "[[environment.shape]]\ntype = \"end_stops\"\nfrom = -2.0\nto = 2.0\nstiffness = 10.0\n";
const WALL: &str = "[environment.wall]\nstiffness = 4.0\ndelay = 2\n";
const TRAILER: &str = "[simulation]\nsamples = 300\nvelocity = 20.0\n[human]\ninertia = 1e-4\n\
                       damping = 0.02\n[limits]\nencoder_step = 0.0015339807878856412\nfull_scale = 5.0\n";

fn read(environment: &str) -> Result<SceneFile, FileError> {
    file::parse("knob.toml", Format::Toml, &format!("{HEAD}{environment}"))
}

fn sum(environment: &str) -> Parts {
    let read = read(environment).unwrap_or_else(|error| panic!("{error}\n{environment}"));
    *read.scene.environment.parts()
}

fn run(arguments: &[&str], environment: &str) -> std::process::Output {
    haptic_reading(arguments, format!("{HEAD}{environment}{TRAILER}").as_bytes())
}

#[test]
fn what_is_beside_a_profile_is_read() {
    let free = sum(&format!("residual = 0.018\n{DETENTS}"));
    assert_eq!((free.canceller, free.wall), (Some(Canceller::to(0.018)), None));
    let more = "damping = 0.001\nfilter = 0.2\nface = 1.5\none_sided = true\n";
    let all = sum(&format!("residual = 0.018\n{DETENTS}{STOPS}{WALL}{more}"));
    let profile = all.profile.unwrap();
    let wall = Wall::damped(4.0, 0.001, 2).filtered(0.2).behind(1.5);
    assert_eq!((all.wall, profile.delay, profile.torque), (Some(wall), 1, 0.05));
    assert_eq!(sum(&format!("{DETENTS}{STOPS}{WALL}")).wall, Some(Wall::damped(4.0, 0.0, 2)));
    assert_eq!(sum(DETENTS).count(), 1);
}

#[test]
fn what_is_written_reads_back_as_the_same_scene() {
    let again = |file: &SceneFile| {
        let written = write::toml(file);
        parse_for(Purpose::Simulate, "b.toml", Format::Toml, &written)
            .unwrap_or_else(|error| panic!("{error}\n{written}"))
    };
    let knots = "delay = 2\nresidual = 0.02\nfrom = -1.0\nto = 1.5\nstiffness = 4.0\nknots = [[0.0, 0.0], \
                 [0.1, 0.02], [0.3, -0.02], [0.4, 0.0]]\n";
    for environment in [
        format!("residual = 0.018\n{DETENTS}"),
        format!("residual = -0.0\ndamping = 1e-4\n{DETENTS}{STOPS}"),
        format!("{DETENTS}{STOPS}{WALL}"),
        format!(
            "torque = 0.03\nresidual = 0.018\n{DETENTS}{STOPS}{WALL}face = -0.3\none_sided = true\n"
        ),
        format!("{knots}{WALL}filter = 0.3\ndamping = 1e-30\n"),
    ] {
        let file = read(&environment).unwrap_or_else(|error| panic!("{error}\n{environment}"));
        assert_eq!(again(&file), file, "{environment}");
        for parameter in [Parameter::ProfileTorque, Parameter::Stiffness, Parameter::Residual] {
            let Some(value) = file.scene.get(parameter) else { continue };
            let scene = file.scene.with(parameter, value * 0.7 + 1e-5).unwrap();
            assert_eq!(again(&SceneFile { scene, ..file.clone() }).scene, scene, "{environment}");
        }
    }
    let json = r#"{"name": "knob", "device": {"inertia": 2.2e-5, "damping": 0.022},
        "servo": {"period": 0.001}, "coupling": {"stiffness": 44}, "environment": {"type": "profile",
        "delay": 1, "residual": 0.018, "wall": {"stiffness": 4, "delay": 2},
        "shape": [{"type": "detents", "count": 24, "torque": 0.05},
        {"type": "end_stops", "from": -2, "to": 2, "stiffness": 10}]}}"#;
    let toml = read(&format!("residual = 0.018\n{DETENTS}{STOPS}{WALL}")).unwrap();
    assert_eq!(file::parse("knob.json", Format::Json, json).unwrap(), toml);
}

#[test]
fn bad_keys_are_named_with_their_table() {
    for (wall, words) in [
        ("[environment.wall]\nstiffness = 4.0\n", "`environment.wall.delay`"),
        ("[environment.wall]\ndelay = 1\n", "`environment.wall.stiffness`"),
        ("[environment.wall]\nstiffness = 4.0\ndelay = 9\n", "`environment.wall.delay` = 9"),
        (
            "[environment.wall]\nstiffness = 4.0\ndelay = 1\nresidual = 1.0\n",
            "`environment.wall.residual`",
        ),
        ("[environment.wall]\nstiffness = nan\ndelay = 1\n", "`environment.wall.stiffness` = nan"),
    ] {
        let message = read(&format!("{DETENTS}{STOPS}{wall}")).expect_err(wall).to_string();
        assert!(message.contains(words), "{message}");
    }
}

/// `T L/2 + K T (n - 1/2) + be`, where the end stops rise more than the detents.
#[test]
fn the_verdict_adds_the_parts() {
    let all = format!("residual = 0.016\n{DETENTS}{STOPS}{WALL}");
    let certified = run(&["certify", "-", "--json"], &all);
    assert_eq!(certified.status.code(), Some(0), "{certified:?}");
    let answer_of = answer(&certified);
    let alpha = answer_of["alpha"]["hi"].as_f64().unwrap();
    let expected = 1e-3 * (5.0 + 4.0 * 1.5) + 0.006;
    assert!((alpha / expected - 1.0).abs() < 1e-9, "{alpha} {expected}");
    let refused = |environment: &str, words: &str| {
        let output = run(&["certify", "-"], environment);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8(said).unwrap().replace('\n', " ");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(words), "{said}");
    };
    refused(&all.replace("0.016", "0.005"), "residual");
    refused(
        &all.replace("delay = 1", "delay = 0"),
        "at least 1 where a wall or a canceller is beside",
    );
    refused(&format!("{DETENTS}{WALL}"), "a torque profile with end stops");
}

/// Nothing panics, and if there is no answer, the sentence gives the reason.
#[test]
fn every_command_answers_or_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let name = "sum.toml";
    let all = format!("residual = 0.016\n{DETENTS}{STOPS}{WALL}face = 0.5\none_sided = true\n");
    std::fs::write(folder.path().join(name), format!("{HEAD}{all}{TRAILER}")).unwrap();
    for (arguments, status) in [
        (&["certify", name, "--format", "f32"] as &[&str], 0),
        (&["simulate", name, "--json"], 0),
        (&["design", "largest", "torque", name], 0),
        (&["design", "largest", "stiffness", name], 0),
        (&["chart", "profile", name, "-o", "profile.svg"], 0),
        (&["chart", "trace", name, "-o", "trace.svg"], 0),
        (&["chart", "nyquist", name, "-o", "nyquist.svg"], 2),
        (&["stability", name], 2),
    ] {
        let output = program(arguments).current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {said}");
        assert!(!said.contains("panicked"), "{arguments:?}: {said}");
    }
}
