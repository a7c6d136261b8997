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

/// The wall with one line replaced; the message must start with the file and the line.
fn refused(line: &str, replacement: &str, place: &str, words: &[&str]) {
    let text = WALL.replacen(line, replacement, 1);
    assert_ne!(text, WALL, "{line} is not in the file");
    let message = toml(&text).expect_err(&text).to_string();
    assert!(message.starts_with(&format!("scene.toml:{place}: ")), "{message}");
    for word in words {
        assert!(message.contains(word), "{word:?} is not in {message:?}");
    }
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

#[test]
fn a_bad_time_is_named_with_its_line_value_and_bound() {
    let servo = |keys: &str, place: &str, words: &[&str]| {
        refused("period = 0.001", &format!("period = 0.001\n{keys}"), place, words);
    };
    let device = |keys: &str, place: &str, words: &[&str]| {
        refused("damping = 0.022", &format!("damping = 0.022\n{keys}"), place, words);
    };
    let bound = "0 s or more";
    for bad in ["-1e-6", "nan", "inf", "-inf", "1e999"] {
        servo(&format!("output_delay = {bad}"), "7:16", &["`servo.output_delay`", bad, bound]);
        servo(&format!("output_jitter = {bad}"), "7:17", &["`servo.output_jitter`", bad, bound]);
        device(&format!("actuator_lag = {bad}"), "5:16", &["`device.actuator_lag`", bad, bound]);
        device(
            &format!("sensor_lag = [0, {bad}]"),
            "5:18",
            &["`device.sensor_lag[1]`", bad, bound],
        );
        device(
            &format!("actuator_response = [0, {bad}]"),
            "5:25",
            &["`device.actuator_response[1]`", bad, bound],
        );
    }
    servo("output_delay = \"5 us\"", "7:16", &["is a string", bound]);
    servo("output_delay = [1e-6]", "7:16", &["[1e-6]", "[least, most]"]);
    servo("output_delay = [1e-6, 2e-6, 3e-6]", "7:16", &["[least, most]"]);
    servo("output_delay = [2e-6, 1e-6]", "7:16", &["[2e-6, 1e-6]", "ends before it begins"]);
    servo("output_delay = 0.0081", "7:16", &["0.0081", "8 times `servo.period` = 0.001 s"]);
    servo("output_delay = [0, 0.0081]", "7:16", &["0.0081", "8 times"]);
    device("actuator_lag = 0.11", "5:16", &["0.11", "100 times `servo.period` = 0.001 s"]);
    device("sensor_lag = 0.11", "5:14", &["0.11", "100 times"]);
    let response = "actuator_response = ";
    device(&format!("{response}[2e-4, 1e-4]"), "5:21", &["ends before it begins"]);
    device(
        &format!("{response}[0, 1.1e-3]"),
        "5:21",
        &["[0, 1.1e-3]", "is more than `servo.period` = 0.001 s"],
    );
    for lag in ["actuator_lag", "sensor_lag"] {
        let both = format!("{lag} = 1e-4\n{response}[0, 1e-4]");
        device(&both, "6:21", &["stands beside `device.actuator_lag` or `device.sensor_lag`"]);
    }
    let least = "more than the least `servo.output_delay` = 0.000004 s";
    let late = format!("{least} and `servo.period`");
    servo("output_delay = [4e-6, 9e-6]\noutput_jitter = 1.1e-3", "8:17", &["1.1e-3", &late]);
    servo("output_jitter = 1.1e-3", "7:17", &["`servo.output_delay` = 0 s and"]);
    servo("count_jitter = -1e-6", "7:16", &["`servo.count_jitter`", "-1e-6", bound]);
    servo("count_jitter = 1.1e-3", "7:16", &["is more", "`servo.output_delay` = 0 s and"]);
    let both = "output_jitter = 2e-4\ncount_jitter = ";
    let together = "`servo.output_jitter` = 0.0002 s are together";
    servo(&format!("{both}9e-4"), "8:16", &["9e-4", together, "more than the least"]);
    servo(&format!("{both}3e-4"), "8:16", &["3e-4", together, "not below 0.0005 s"]);
    servo(&format!("output_delay = [0, 2e-4]\n{both}2e-4"), "9:16", &["not below 0.0004 s"]);
    let of_a_lag = WALL
        .replacen("damping = 0.022", "damping = 0.022\nactuator_lag = [1e-4, 2e-4]", 1)
        .replacen("period = 0.001", &format!("period = 0.001\n{both}1e-4"), 1);
    let error = toml(&of_a_lag).unwrap_err().to_string();
    assert!(error.contains("a lag of which only a range is known"), "{error}");
    assert!(
        toml(&WALL.replacen("period = 0.001", "period = 0.001\noutput_delay = 0.008", 1)).is_ok()
    );
}

#[test]
fn an_amplifier_in_updates_has_a_lag_and_a_delay_of_whole_updates() {
    let text = |device: &str, servo: &str| {
        WALL.replacen("damping = 0.022", &format!("damping = 0.022\n{device}"), 1).replacen(
            "period = 0.001",
            &format!("period = 0.001\n{servo}"),
            1,
        )
    };
    let updates = "actuator_lag = 8e-5\nactuator_updates = 3";
    let read = toml(&text(updates, "output_delay = 3.33333333333e-4")).unwrap();
    let exactly = TimeRange::exactly;
    let expected = Latency {
        output_delay: exactly(3.333_333_333_33e-4),
        actuator_lag: exactly(8e-5),
        actuator_updates: 3,
        ..Latency::NONE
    };
    assert_eq!(read.scene.latency, expected);
    assert_eq!(read.scene.latency.output_delay.middle() as f32, (1e-3 / 3.0) as f32);
    let refused = |device: &str, servo: &str, place: &str, words: &[&str]| {
        let message = toml(&text(device, servo)).expect_err(device).to_string();
        assert!(message.contains(&format!("scene.toml:{place}: ")), "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    let whole = "a whole number from 0 to 65535";
    for bad in ["-1", "0.5", "65536", "1e9"] {
        let words = ["`device.actuator_updates`", bad, whole];
        refused(&format!("actuator_updates = {bad}"), "", "5:20", &words);
    }
    refused(
        updates,
        "output_delay = 3.4e-4",
        "9:16",
        &[
            "`servo.output_delay` = 3.4e-4 is not a whole number of updates",
            "`device.actuator_updates` = 3 in a period",
            "the nearest is 1: 0.0003333",
        ],
    );
    refused(updates, "output_delay = [3e-4, 4e-4]", "9:16", &["has to be known exactly"]);
    refused(updates, "worst_period = 0.002", "9:16", &["0.002 s, which may not be missed"]);
    let lag = "needs a `device.actuator_lag` that is greater than 0";
    refused("actuator_updates = 3", "", "5:20", &[lag]);
    refused("actuator_lag = [0, 1e-5]\nactuator_updates = 3", "", "6:20", &[lag]);
    let sensor = format!("sensor_lag = 1e-5\n{updates}");
    refused(&sensor, "", "7:20", &["stands beside `device.sensor_lag`"]);
    assert!(toml(&text("actuator_updates = 0", "worst_period = 0.002")).is_ok());
}

#[test]
fn a_matched_coupling_takes_no_stiffness_and_a_spring_needs_one() {
    let refused = |keys: &str, words: &[&str]| {
        let text = WALL.replacen("stiffness = 44.0", keys, 1);
        let message = toml(&text).expect_err(&text).to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    refused("type = \"matched\"\nstiffness = 44.0", &["scene.toml:9:13", "takes no stiffness"]);
    refused("type = \"spring\"", &["`coupling.stiffness` is missing"]);
    refused("", &["`coupling.stiffness` is missing"]);
    refused("type = \"damper\"", &["scene.toml:8:8", "\"spring\" or \"matched\""]);
    refused("type = 3\nstiffness = 44.0", &["scene.toml:8:8", "`coupling.type` = 3"]);
    let spring = WALL.replacen("stiffness = 44.0", "type = \"spring\"\nstiffness = 44.0", 1);
    assert_eq!(toml(&spring).unwrap(), toml(WALL).unwrap());
}

#[test]
fn without_a_coupling_the_connection_is_rigid() {
    let rigid = WALL.replace("[coupling]\nstiffness = 44.0\n", "");
    assert_eq!(toml(&rigid).unwrap().scene.coupling, Coupling::Rigid);
}

#[test]
fn a_bad_number_is_named_with_its_line_value_and_bound() {
    let positive = "a finite number greater than 0";
    refused("period = 0.001", "period = 0", "6:10", &["`servo.period` = 0 ", positive, " s"]);
    refused("period = 0.001", "period = -1e-3", "6:10", &["-1e-3", positive]);
    refused("period = 0.001", "period = nan", "6:10", &["nan", positive]);
    refused("period = 0.001", "period = inf", "6:10", &["inf", positive]);
    refused("period = 0.001", "period = 1e999", "6:10", &["1e999", positive]);
    refused("period = 0.001", "period = \"1 ms\"", "6:10", &["\"1 ms\" is a string", positive]);
    refused("inertia = 2.2e-5", "inertia = 0.0", "3:11", &["`device.inertia`", "kg m^2"]);
    refused("damping = 0.022", "damping = -0.022", "4:11", &["`device.damping`", "or more"]);
    refused("stiffness = 44.0", "stiffness = 0", "8:13", &["`coupling.stiffness`", positive]);
    let delay = "a whole number from 0 to 8";
    refused("delay = 1", "delay = 9", "13:9", &["`environment.delay` = 9", delay]);
    refused("delay = 1", "delay = 0.5", "13:9", &["0.5", delay]);
    refused("delay = 1", "delay = -1", "13:9", &["-1", delay]);
    refused("delay = 1", "delay = true", "13:9", &["true is true or false", delay]);
    refused(
        "delay = 1",
        "delay = 1\nfilter = 1.0",
        "14:10",
        &["`environment.filter`", "less than 1"],
    );
    refused(
        "period = 0.001",
        "period = 0.001\nworst_period = 0.0005",
        "7:16",
        &["shorter", "0.001"],
    );
    refused(
        "damping = 0.022",
        "damping = 0.022\npassivity = 0.22",
        "5:13",
        &["`device.passivity` = 0.22", "more than `device.damping` = 0.022 N m s/rad"],
    );
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

#[test]
fn negative_springs_and_dampers_are_the_certificates_to_judge() {
    for (line, negative) in
        [("stiffness = 22.0", "stiffness = -22"), ("damping = 0.01", "damping = -1")]
    {
        assert!(toml(&WALL.replacen(line, negative, 1)).is_ok(), "{negative}");
    }
}

#[test]
fn a_missing_key_is_named_with_the_line_of_its_table() {
    refused("name = \"delayed wall\"\n", "", "1:1", &["`name` is missing"]);
    refused("inertia = 2.2e-5\n", "", "2:1", &["`device.inertia` is missing", "kg m^2"]);
    refused("period = 0.001\n", "", "5:1", &["`servo.period` is missing"]);
    refused("delay = 1\n", "", "9:1", &["`environment.delay` is missing", "from 0 to 8"]);
    refused("[servo]\nperiod = 0.001\n", "", "1:1", &["`servo` is missing"]);
    refused("type = \"damper-wall\"\n", "", "9:1", &["`environment.type`", "\"free-mode\""]);
}

#[test]
fn an_unknown_key_is_named_with_what_was_meant() {
    refused("period =", "perod =", "6:1", &["`servo.perod`", "`period` is"]);
    refused(
        "delay = 1",
        "delay = 1\ncolour = 3",
        "14:1",
        &["`environment.colour`", "its keys are type"],
    );
    refused("delay = 1", "delay = 1\n[colour]", "14:2", &["`colour`"]);
    refused("\"damper-wall\"", "\"wall\"", "10:8", &["\"wall\"", "\"damper-wall\""]);
    let spring = WALL.replace("damper-wall", "delayed-spring");
    assert!(toml(&spring).unwrap_err().to_string().contains("a delayed-spring [environment]"));
}

#[test]
fn a_key_is_set_once() {
    refused("period = 0.001", "period = 0.001\nperiod = 0.001", "7:1", &["`period`", "twice"]);
    let twice = FULL.replacen("\"name\"", "\"name\": 1, \"name\"", 1);
    assert!(json(&twice).unwrap_err().to_string().contains("twice"));
}

#[test]
fn polynomials_are_bounded() {
    let with = |numerator: &str, denominator: &str, zeros: u32| {
        let text = format!(
            r#"{{"name": "r", "device": {{"inertia": 1, "damping": 1}}, "servo": {{"period": 1}},
            "environment": {{"type": "rational", "numerator": {numerator},
            "denominator": {denominator}, "unit_zeros": {zeros}}}}}"#
        );
        json(&text).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(with("[0]", "[1]", 0), Ok(()));
    assert_eq!(with("[1,2,3,4,5,6,7,8,9]", "[0,0,1]", 0), Ok(()));
    assert!(with("[]", "[1]", 0).unwrap_err().contains("1 to 9 finite numbers"));
    assert!(with("[1]", "[0,0]", 0).unwrap_err().contains("`environment.denominator`"));
    assert!(with("[1,2,3,4,5,6,7,8,9,10]", "[1]", 0).unwrap_err().contains("numerator"));
    assert!(with("[1, \"a\"]", "[1]", 0).unwrap_err().contains("numerator[1]"));
    assert!(with("[1, 1e999]", "[1]", 0).unwrap_err().contains("numerator[1]"));
    assert!(with("[1,2]", "[1]", 8).unwrap_err().contains("unit_zeros"));
    // Zeros at a denominator's end are delay, of at most eight samples.
    assert_eq!(with("[1]", "[1,2,3,4,5,6,7,8,9,0,0,0,0,0,0,0,0]", 0), Ok(()));
    for denominator in ["[1,2,3,4,5,6,7,8,9,0,0,0,0,0,0,0,0,0]", "[1,2,3,4,5,6,7,8,9,10]"] {
        assert!(with("[1]", denominator, 0).unwrap_err().contains("zeros at its end are delay"));
    }
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
fn the_report_shows_the_line() {
    let error = toml(&WALL.replace("period = 0.001", "period = 0")).unwrap_err();
    let report = error.report(false);
    assert!(report.contains("6 | period = 0") && report.contains('^'), "{report}");
}

#[test]
fn everything_that_is_wrong_is_said_at_once_from_the_top() {
    let text = r#"nme = "wall"
[device]
inertia = -1
colour = "red"
[servo]
perod = 0.001
[environment]
type = "wall"
stifness = 3
delay = 1
[simulation]
samples = 0
torque_sine = { amplitude = "much" }
[humans]
"#;
    let error = toml(text).unwrap_err();
    let said = error.to_string();
    let lines: Vec<&str> = said.lines().collect();
    for (line, (place, words)) in lines.iter().zip([
        ("1:1", "`nme`"),
        ("2:1", "`device.damping` is missing"),
        ("3:11", "`device.inertia` = -1"),
        ("4:1", "`device.colour`"),
        ("6:1", "`servo.perod`"),
        ("8:8", "\"wall\""),
        ("9:1", "`environment.stifness`"),
        ("12:11", "`simulation.samples` = 0"),
        ("13:15", "`simulation.torque_sine.omega` is missing"),
        ("13:29", "\"much\" is a string"),
        ("14:2", "`humans`"),
    ]) {
        let is_said = line.starts_with(&format!("scene.toml:{place}: ")) && line.contains(words);
        assert!(is_said, "{place} {words}: {line}\n{said}");
    }
    assert_eq!(lines.len(), 11, "{said}");
    assert_eq!(error.report(false).matches("error:").count(), 11);
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

#[test]
fn a_file_without_a_place_is_named_without_one() {
    let said = |name: &str| file::load(name).unwrap_err().to_string();
    assert_eq!(said(""), "the name of the file is empty; `-` is standard input");
    assert!(said("no.toml").starts_with("no.toml: the file cannot be read"), "{}", said("no.toml"));
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

#[test]
fn what_schema_prints_as_an_example_certifies() {
    for name in file::example::names() {
        let example = crate::common::haptic(&["schema", "--example", name]).stdout;
        let judged = crate::common::haptic_reading(&["certify", "-"], &example);
        assert_eq!(judged.status.code(), Some(0), "{name}: {judged:?}");
    }
    let schema = crate::common::answer(&crate::common::haptic(&["schema"]));
    assert_eq!(schema["properties"]["servo"]["required"][0], "period");
    let unknown = crate::common::haptic(&["schema", "--example", "wall"]);
    assert!(crate::common::complaint(unknown).contains("damper-wall"));
}
