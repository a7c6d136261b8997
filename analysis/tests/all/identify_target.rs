//! A simulated device, measured end to end: the program `identify` on the emulated board, and the
//! same sweep on this machine.

use std::path::Path;

use crate::common::haptic;
use serde_json::Value;

/// The device that the scenes' programs are certified for.
const DAMPING: f64 = 0.022;
const INERTIA: f64 = 2.2e-5;
const TICKS: u64 = 58_000;

fn answer(arguments: &[&str]) -> Value {
    let output = haptic(&[arguments, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    crate::common::answer(&output)
}

fn number(found: &Value, path: &str) -> f64 {
    found.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} of {found}"))
}

fn assert_near(found: &Value, path: &str, wanted: f64, part: f64) {
    let value = number(found, path);
    assert!((value - wanted).abs() < part * wanted, "{path} {value}");
}

/// The measured device without its amplifier, of which the passivity is that of the machine.
fn without_lag(table: &str) {
    let text = std::fs::read_to_string(table).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with("actuator_lag = ["));
    std::fs::write(table, lines.map(|line| format!("{line}\n")).collect::<String>()).unwrap();
}

#[test]
#[ignore = "builds for minutes"]
fn the_board_measures_damping_within_two_percent_and_plays_the_hosts_codes() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (record, table, picture) = (path("r.csv"), path("device.toml"), path("r.svg"));
    let found = answer(&["identify", "--target", "qemu", "--record", &record, "-o", &table]);
    assert_eq!(found["measured"]["codes_equal"], TICKS, "{}", found["measured"]);
    assert_eq!(found["measured"]["difference"], Value::Null);
    assert_near(&found, "/damping/value", DAMPING, 0.02);
    assert_near(&found, "/inertia/value", INERTIA, 0.02);
    assert!(number(&found, "/passivity") <= 1.001 * DAMPING);
    assert_eq!(found["skew_significant"], false);
    assert_eq!(found["responses"].as_array().unwrap().len(), 20);
    // The host plays the same, so all that it finds is the same.
    let mut host = answer(&["identify", "--target", "host"]);
    host["measured"] = found["measured"].clone();
    assert_eq!(host, found);
    // The record can be read again, drawn, and its table certified with.
    let again = answer(&["identify", &record, "--counts-per-rev", "61440", "--settle", "0"]);
    assert_near(&again, "/damping/value", number(&found, "/damping/value"), 1e-9);
    without_lag(&table);
    assert_near(&answer(&["device", &table]), "/delta", DAMPING, 0.02);
    let drawn =
        haptic(&["chart", "identify", &record, "--counts-per-rev", "61440", "-o", &picture]);
    assert!(drawn.status.success(), "{drawn:?}");
    let svg = std::fs::read_to_string(Path::new(&picture)).unwrap();
    for words in ["Measured: r", "radius 1/(2 delta) = ", "b = 0.0", "m = 2.", "kg m^2"] {
        assert!(svg.contains(words), "{words}");
    }
}

/// From slow turns over the file of the device to a scene that opposes the cogging on the emulated board. The
/// codes of the turns are compared on a virtual board.
#[test]
#[ignore = "builds for minutes"]
fn a_turned_motor_s_cogging_is_opposed_on_a_board() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (device, scene) = (path("knob.toml"), path("scene.toml"));
    let text = "[device]\ninertia = 3e-5\ndamping = 0.001\nfriction = 0.003\n\
                cogging = { torque = 0.005, count = 84 }\nactuator_lag = 8e-5\n\
                [encoder]\ncounts_per_turn = 16384.0\nage = [0.0, 1e-5]\nnoise = 2.0\n\
                [limits]\ntorque = 0.15\nfull_scale = 0.2\n";
    let truth = path("truth.toml");
    for file in [&device, &truth] {
        std::fs::write(file, text).unwrap();
    }
    let found = answer(&["identify", &truth, "--target", "host", "--turns", "-o", &device]);
    for (quantity, truth) in [
        ("/friction", 0.003),
        ("/damping", 0.001),
        ("/inertia", 3e-5),
        ("/cogging/harmonics/0/amplitude", 0.005),
    ] {
        let [lo, hi] = ["lo", "hi"].map(|end| number(&found, &format!("{quantity}/{end}")));
        assert!(lo <= truth && truth <= hi, "{quantity}: {truth} is not in {lo} to {hi}");
    }
    assert_eq!(found["cogging"]["harmonics"][0]["count"], 84);
    let text = "name = \"knob\"\ndevice = \"knob.toml\"\n[servo]\nrate = 1000.0\n[environment]\n\
                type = \"delayed-spring\"\nstiffness = 0.1\ndelay = 1\n";
    std::fs::write(&scene, text).unwrap();
    let certified = answer(&["certify", &scene]);
    let assumed = certified["assumptions"].to_string();
    assert!(assumed.contains("opposes 100 % of the learnt cogging"), "{certified}");
    let ran = answer(&["run", &scene, "--target", "qemu", "--ticks", "3000"]);
    assert_eq!((&ran["codes_equal"], &ran["difference"]), (&3000.into(), &Value::Null), "{ran}");
    // A torque that cogging and friction together hold moves the device where the cogging is opposed.
    let without = std::fs::read_to_string(&device).unwrap().replace("share = 1.0", "share = 0.0");
    std::fs::write(path("without.toml"), without).unwrap();
    let swing = |device: &str| {
        let (other, pushed) = (path("other.toml"), text.replace("knob.toml", device));
        let torque = "samples = 4000\ntorque_sine = { amplitude = 0.006, omega = 6.0 }\n";
        std::fs::write(&other, pushed + "[simulation]\n" + torque).unwrap();
        let moved = answer(&["simulate", &other]);
        let angles = moved["position"].as_array().unwrap().iter().map(|it| it.as_f64().unwrap());
        angles.fold(0.0, |most: f64, angle| most.max(angle.abs()))
    };
    let (opposed, left) = (swing("knob.toml"), swing("without.toml"));
    assert!(opposed > 2.0 * left, "{opposed} {left}");
}

/// A shaft that turns at two speeds both ways, read by an encoder that is 80 us late, and whose error has a slope of
/// 0.01, and by one without errors.
#[test]
fn a_second_encoder_shows_linearity_and_age_for_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (record, file) = (path("both.csv"), path("knob.toml"));
    let device =
        "[device]\ninertia = 3e-5\ndamping = 0.001\n[encoder]\nage = [0.0, 1e-4] # stated\n";
    std::fs::write(&file, device).unwrap();
    let counts = ["--counts-per-rev", "16384", "--reference-per-rev", "40000"];
    let identified = |error: f64| {
        std::fs::write(&record, two_encoders(error)).unwrap();
        haptic(&[&["identify", &record, "-o", &file], &counts[..]].concat())
    };
    let refused = String::from_utf8(identified(1.5).stderr).unwrap();
    assert!(refused.contains(" and has to be less than 1"), "{refused}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), device);
    let said = String::from_utf8(identified(0.01).stdout).unwrap();
    assert!(said.contains(" s, within the 0 to 0.0001 s that the file states"), "{said}");
    let written = std::fs::read_to_string(&file).unwrap();
    for number in ["linearity = 0.010", "hysteresis = 0.0", "age = [7."] {
        assert!(written.contains(number), "{written}");
    }
}

/// A record of two encoders, of which the first is 80 us late and off by this error in rad, once in a turn.
fn two_encoders(error: f64) -> String {
    use std::f64::consts::TAU;
    let mut text = "time,counts,reference\n".to_owned();
    let (mut from, mut row) = (0.3, 0_u32);
    for speed in [6.0, -6.0, 12.0, -12.0_f64] {
        let ticks = (3.3 * TAU / speed.abs() / 1e-3) as usize;
        for tick in 0..ticks {
            let at = |time: f64| from + speed * time;
            let (time, old) = (1e-3 * tick as f64, at(1e-3 * tick as f64 - 8e-5));
            // Noise of a count, as an encoder has it.
            let noise = f64::from(row * 7919 % 1000) / 500.0 - 1.0;
            let count = |angle: f64, counts: f64| (angle / TAU * counts + noise).floor();
            let (shown, reference) = (old + error * old.sin(), at(time));
            text += &format!(
                "{},{},{}\n",
                1e-3 * f64::from(row),
                count(shown, 16_384.0),
                count(reference, 40_000.0)
            );
            row += 1;
        }
        from += speed * 1e-3 * ticks as f64;
    }
    text
}
