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
