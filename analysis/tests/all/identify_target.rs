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

#[test]
fn damping_is_found_whatever_the_noise_does() {
    for seed in 0..10 {
        let seed = seed.to_string();
        let arguments = ["identify", "--target", "host", "--torque-noise", "0.05", "--seed", &seed];
        let found = answer(&arguments);
        assert_near(&found, "/damping/value", DAMPING, 0.005);
        assert_near(&found, "/inertia/value", INERTIA, 0.02);
        assert_eq!(found["rigid"], true);
    }
}

#[test]
fn ten_microseconds_of_skew_are_reported_as_the_bias_that_they_are() {
    let skewed = ["identify", "--target", "host", "--skew", "1e-5"];
    let found = answer(&skewed);
    assert_eq!(found["skew_significant"], true);
    assert_near(&found, "/skew/value", 1e-5, 0.1);
    assert_near(&found, "/damping/value", DAMPING, 0.02);
    let omega = number(&found, "/disk/omega");
    let bias = DAMPING * (omega * 1e-5).cos() - INERTIA * omega * (omega * 1e-5).sin() - DAMPING;
    assert!((number(&found, "/bias") - bias).abs() < 0.1 * bias.abs(), "{}", found["bias"]);
    assert!(found["notes"][0].as_str().unwrap().contains("us late against the torque"));
    // A declared delay is not a skew.
    let declared = answer(&[&skewed[..], &["--count-delay", "1e-5"]].concat());
    assert_eq!(declared["skew_significant"], false);
    assert!(declared["notes"].as_array().unwrap().is_empty(), "{declared}");
}

#[test]
fn lag_and_delay_of_the_output_go_into_the_table() {
    let (lag, delay) = (1.2e-4, 2e-4);
    let mut file = tempfile::Builder::new().suffix(".toml").tempfile().unwrap();
    let device =
        format!("[device]\ninertia = {INERTIA}\ndamping = {DAMPING}\nactuator_lag = {lag}\n");
    std::io::Write::write_all(&mut file, device.as_bytes()).unwrap();
    let table = tempfile::NamedTempFile::new().unwrap();
    let into = table.path().to_str().unwrap();
    let late = ["identify", file.path().to_str().unwrap(), "--target", "host", "-o", into];
    let found = answer(&[&late[..], &["--output-delay", "2e-4"]].concat());
    // One record in twenty is outside; none is far.
    let holds = |path: &str, truth: f64| {
        let end = |end: &str| number(&found, &format!("{path}/{end}"));
        let more = 0.5 * (end("hi") - end("lo"));
        assert!(end("lo") - more <= truth && truth <= end("hi") + more, "{path} {found}");
        assert!(end("hi") - end("lo") < 4e-5 + 0.02 * truth, "{path} {found}");
    };
    holds("/damping", DAMPING);
    holds("/inertia", INERTIA);
    holds("/latency/actuator_lag", lag);
    holds("/latency/output_delay", delay);
    holds("/skew", lag + delay);
    assert_eq!((&found["told_apart"], &found["no_latency"]), (&true.into(), &Value::Null));
    assert_eq!(found["taken_out"]["hold"], 5e-4);
    let table = std::fs::read_to_string(table.path()).unwrap();
    let range = |key: &str| {
        let lists = table.lines().filter_map(|line| line.split_once(&format!("{key} = [")));
        let list = lists.filter_map(|(_, list)| list.split_once(']')).next().unwrap().0.to_owned();
        let ends: Vec<f64> = list.split(", ").map(|end| end.parse().unwrap()).collect();
        (ends[0], ends[1])
    };
    for (key, path) in
        [("actuator_lag", "/latency/actuator_lag"), ("output_delay", "/latency/output_delay")]
    {
        let (lo, hi) = range(key);
        let end = |end: &str| number(&found, &format!("{path}/{end}"));
        assert!(lo <= end("lo") && end("lo") <= 1.002 * lo, "{table}");
        assert!(hi >= end("hi") && end("hi") >= 0.998 * hi, "{table}");
    }
}

#[test]
fn a_device_that_is_not_rigid_is_said_to_be_none() {
    let mut file = tempfile::Builder::new().suffix(".toml").tempfile().unwrap();
    let chain = "[device]\n[[device.mass]]\ninertia = 1.1e-5\ndamping = 0.02\n\
                 [[device.mass]]\ninertia = 1.1e-5\ndamping = 0.002\n\
                 [[device.link]]\nstiffness = 2.0\ndamping = 0.001\n";
    std::io::Write::write_all(&mut file, chain.as_bytes()).unwrap();
    let path = file.path().to_str().unwrap();
    let table = tempfile::NamedTempFile::new().unwrap();
    let into = ["-o", table.path().to_str().unwrap()];
    let run = haptic(&[&["identify", path, "--target", "host", "--json"][..], &into].concat());
    assert_eq!(run.status.code(), Some(1));
    let found: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!((&found["rigid"], &found["passivity"]), (&false.into(), &Value::Null), "{found}");
    assert!(found["notes"][0].as_str().unwrap().contains("a hand that holds the far end"));
    assert!(std::fs::read_to_string(table.path()).unwrap().contains("# passivity: none"));
    let delta = number(&answer(&["device", path]), "/delta");
    let measured = number(&found, "/disk/delta");
    assert!((delta..1.1 * delta).contains(&measured), "{measured} {delta}");
}

#[test]
fn options_of_a_simulated_measurement_need_a_target() {
    for arguments in [
        &["identify"][..],
        &["identify", "r.csv"],
        &["identify", "r.csv", "--counts-per-rev", "4096", "--skew", "1e-5"],
        &["identify", "--target", "host", "--skew", "0.001"],
        &["identify", "--target", "host", "--output-delay", "0.009"],
        &["identify", "--target", "host", "--longest-lag", "0"],
        &["identify", "--target", "moon"],
    ] {
        assert_eq!(haptic(arguments).status.code(), Some(2), "{arguments:?}");
    }
}
