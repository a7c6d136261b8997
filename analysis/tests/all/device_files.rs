//! Devices in files: accepted files, refused files, and the program's messages about them.

use std::process::Output;

use crate::common::{answer, complaint, haptic_reading};
use analysis::file::{self, Format, Purpose};
use serde_json::Value;

const CHAIN: &str = r#"[device]
[[device.mass]]
inertia = 0.05
damping = 0.5
[[device.mass]]
inertia = 0.02
damping = 0.25
[[device.link]]
stiffness = 700.0
damping = 0.125
"#;

/// `b2 + b1 b12 / (b1 + b12)`.
const DELTA: f64 = 0.5 + 0.25 * 0.125 / 0.375;

const REST: &str = r#"
[servo]
period = 0.001
[coupling]
stiffness = 1000.0
[environment]
type = "delayed-spring"
stiffness = 400.0
delay = 1
"#;

fn scene() -> String {
    format!("name = \"two masses\"\n{CHAIN}{REST}")
}

fn haptic(arguments: &[&str], input: &str) -> Output {
    haptic_reading(arguments, input.as_bytes())
}

fn refused(text: &str) -> String {
    file::parse_device("d.toml", Format::Toml, text).unwrap_err().to_string()
}

#[test]
fn a_chain_has_its_closed_form() {
    let output = haptic(&["device", "--json", "-"], CHAIN);
    assert_eq!(output.status.code(), Some(0));
    let found = answer(&output);
    assert!((found["delta"].as_f64().unwrap() - DELTA).abs() < 1e-15, "{found}");
    assert_eq!((&found["omega"], &found["collocated"]), (&Value::from(0.0), &Value::from(true)));
    assert_eq!(found["reached"], "everywhere");
}

/// Equations 5 to 16 beside the closed form: 1 up to `delta` and greater above.
#[test]
fn mu_agrees_with_delta() {
    let rigid = "[device]\ninertia = 2.2e-5\ndamping = 0.022\n";
    let bent = CHAIN.replace("inertia = 0.02\n", "inertia = 0.03\n")
        + "[[device.mass]]\ninertia = 0.01\ndamping = 0.05\n\
           [[device.link]]\nstiffness = 900.0\ndamping = 0.5\n";
    for device in [rigid, CHAIN, &bent] {
        let mu = &answer(&haptic(&["device", "--json", "-"], device))["mu"];
        let [at_delta, above] = ["at_delta", "above"].map(|key| mu[key].as_f64().unwrap());
        assert!((at_delta - 1.0).abs() < 1e-7, "{mu}");
        assert!(above > 1.0 + 1e-6, "{mu}");
        let text = String::from_utf8(haptic(&["device", "-"], device).stdout).unwrap();
        assert!(text.contains("up to delta, 1.0"), "{text}");
    }
    let undamped = "[device]\ninertia = 2.2e-5\ndamping = 0.0\n";
    assert!(answer(&haptic(&["device", "--json", "-"], undamped))["mu"].is_null());
}

#[test]
fn json_is_the_same_shape() {
    let chain = r#"{"device": {"mass": [{"inertia": 0.05, "damping": 0.5},
        {"inertia": 0.02, "damping": 0.25}], "link": [{"stiffness": 700, "damping": 0.125}]}}"#;
    let found = answer(&haptic(&["device", "--json", "-"], chain));
    assert!((found["delta"].as_f64().unwrap() - DELTA).abs() < 1e-15, "{found}");
}

#[test]
fn a_scene_is_certified_with_the_passivity_of_its_chain() {
    let output = haptic(&["certify", "--json", "-"], &scene());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!((answer(&output)["delta"].as_f64().unwrap() - DELTA).abs() < 1e-14);
    let device = answer(&haptic(&["device", "--json", "-"], &scene()));
    assert_eq!(device["name"], "two masses");
    assert!((device["delta"].as_f64().unwrap() - DELTA).abs() < 1e-15);
    // Without the hand's damper only the motor's is left: 2 delta / T is below the coupling.
    let lost = scene().replace("damping = 0.25", "damping = 0.0").replace("1000.0", "1100.0");
    let rules = &answer(&haptic(&["certify", "--json", "-"], &lost))["rules"];
    assert_eq!(rules["paper"], "fail", "{rules}");
}

#[test]
fn without_passivity_the_reason_is_given_and_no_encoder_at_the_hand_is_certified() {
    for (key, word) in [("encoder = \"hand\"", "resonance"), ("actuator_lag = 0.001", "lag")] {
        let with = |text: &str| text.replace("[device]", &format!("[device]\n{key}"));
        let output = haptic(&["device", "--json", "-"], &with(CHAIN));
        assert_eq!(output.status.code(), Some(1));
        let found = answer(&output);
        assert!(found["delta"].is_null() && found["omega"].is_null());
        assert_eq!(found["collocated"], !key.contains("encoder"));
        assert!(found["message"].as_str().unwrap().contains(word), "{found}");
        let toml = with(&scene());
        if key.contains("lag") {
            // It is the controller's in a certificate: the rest of the device has its passivity.
            let judged = answer(&haptic(&["certify", "--json", "-"], &toml));
            assert!((judged["delta"].as_f64().unwrap() - DELTA).abs() < 1e-14);
            continue;
        }
        let message = complaint(haptic(&["certify", "-"], &toml));
        assert!(message.contains("<stdin>:3"), "{message}");
        let read = file::parse_for(Purpose::Simulate, "s.toml", Format::Toml, &toml).unwrap();
        let judged = analysis::verdict::judge(&read.name, &read.scene);
        assert_ne!(judged.verdict, analysis::verdict::Verdict::Certified);
    }
}

#[test]
fn a_lag_belongs_to_a_rigid_device_as_well() {
    let rigid = "[device]\ninertia = 0.05\ndamping = 0.5\n";
    assert_eq!(haptic(&["device", "-"], rigid).status.code(), Some(0));
    let lagging = format!("{rigid}actuator_lag = 0.001\n");
    let found = answer(&haptic(&["device", "--json", "-"], &lagging));
    // sqrt(b / (m lag))
    let message = found["message"].as_str().unwrap();
    assert!(found["delta"].is_null() && message.contains("100 rad/s"));
    assert!(message.contains("without it delta is 0.5 N m s/rad"), "{message}");
}

#[test]
fn errors_name_file_line_key_value_and_bound() {
    for (from, to, named) in [
        (
            "inertia = 0.05",
            "inertia = 0",
            "d.toml:3:11: `device.mass.inertia` = 0 is out of bounds; it must be a finite number greater than 0 kg m^2",
        ),
        (
            "damping = 0.25",
            "damping = -1",
            "d.toml:7:11: `device.mass.damping` = -1 is out of bounds",
        ),
        (
            "stiffness = 700.0",
            "stifness = 700.0",
            "d.toml:9:1: `device.link.stifness` is not a key of [[device.link]] number 1; `stiffness` is",
        ),
        ("inertia = 0.02\n", "", "`device.mass.inertia` is missing"),
        (
            "[device]",
            "[device]\ninertia = 1",
            "d.toml:2:11: `device.inertia` = 1 stands beside [[device.mass]]",
        ),
        (
            "[device]",
            "[device]\nencoder = \"wall\"",
            "d.toml:2:11: `device.encoder` = \"wall\" is out of bounds; it must be \"motor\" or \"hand\"",
        ),
        ("[device]", "[device]\nactuator_lag = -1", "`device.actuator_lag` = -1 is out of bounds"),
        (
            "[device]",
            "[device]\npassivity = 0.6",
            "`device.passivity` = 0.6 is more than the 0.58333",
        ),
        ("[[device.link]]\nstiffness = 700.0\ndamping = 0.125\n", "", "`device.link` is missing"),
        (
            "[[device.mass]]\ninertia = 0.02\ndamping = 0.25\n",
            "",
            "are 1 for 1 masses; there must be 0",
        ),
        (
            "stiffness = 700.0\ndamping = 0.125",
            "stiffness = 0",
            "d.toml:9:13: `device.link.stiffness` = 0 and no damping connect nothing",
        ),
    ] {
        let message = refused(&CHAIN.replacen(from, to, 1));
        assert!(message.contains(named), "{message}\n{named}");
    }
    let many = format!("[device]\n{}", "[[device.mass]]\ninertia = 1\n".repeat(11));
    assert!(refused(&many).contains("must be a list of 1 to 10 tables"));
    assert!(refused("[device]\nmass = []\n").contains("`device.mass` = [] is out of bounds"));
    assert!(refused("[device]\nmass = 1\n").contains("it must be a list of 1 to 10 tables"));
    assert!(refused("colour = 1\n").contains("`device` is missing"));
}

#[test]
fn a_measured_device_is_identified_and_its_table_is_a_device_file() {
    use analysis::identify::rig::{Excitation, Rig, Sensing};
    use haptic_servo::scene::Device;
    let device = Device { inertia: 0.05, damping: 0.5, passivity: None };
    let rig = Rig {
        device,
        actuator_lag: 0.0,
        sensing: Sensing {
            period: 1e-3,
            counts_per_turn: 61_440.0,
            torque_noise: 0.02,
            skew: 1e-5,
            output_delay: 0.0,
            seed: 7,
        },
    };
    let sine = |frequency: f64| {
        let omega = std::f64::consts::TAU * frequency;
        let amplitude = 0.02 * omega * device.damping.hypot(device.inertia * omega);
        Excitation { frequency, amplitude, duration: (20.0 / frequency).max(2.0) }
    };
    let record = rig.measure(&[1.0, 4.0, 10.0, 30.0, 60.0, 100.0].map(sine)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let rows = record.torque.iter().zip(&record.counts).enumerate();
    let rows: String = rows
        .map(|(k, (torque, counts))| format!("{:.6},{torque},{counts}\n", k as f64 * 1e-3))
        .collect();
    std::fs::write(path("rig.csv"), format!("time,torque,counts\n{rows}")).unwrap();
    let (csv, table) = (path("rig.csv"), path("device.toml"));
    let arguments = ["identify", &csv, "--counts-per-rev", "61440", "--json", "-o", &table];
    let output = haptic(&arguments, "");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let found = answer(&output);
    let damping = found["damping"]["value"].as_f64().unwrap();
    assert!((damping - 0.5).abs() < 0.01, "{found}");
    assert_eq!(found["skew_significant"], true);
    assert!((found["skew"]["value"].as_f64().unwrap() - 1e-5).abs() < 2e-6, "{found}");
    assert!(found["notes"][0].as_str().unwrap().contains("late"), "{found}");
    // The machine's passivity is that without its amplifier.
    let text = std::fs::read_to_string(&table).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with("actuator_lag = ["));
    std::fs::write(&table, lines.map(|line| format!("{line}\n")).collect::<String>()).unwrap();
    let device = answer(&haptic(&["device", "--json", &table], ""));
    assert!((device["delta"].as_f64().unwrap() - 0.5).abs() < 0.01, "{device}");
    // An invalid row is named, and an invalid option is refused.
    let text = std::fs::read_to_string(&csv).unwrap().replacen("0.006000,", "six,", 1);
    std::fs::write(&csv, text).unwrap();
    let message = complaint(haptic(&arguments[..4], ""));
    assert!(message.contains("rig.csv:8: column 1, `time`: `six`"), "{message}");
    complaint(haptic(&["identify", &csv, "--counts-per-rev", "0"], ""));
}
