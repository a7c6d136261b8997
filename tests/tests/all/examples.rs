//! The examples of the library run, and print what `docs/library.md` shows.

use std::process::Command;

use haptic_servo::servo::{Servo, Transducers};

// Its own simulation is its own.
#[allow(dead_code)]
#[path = "../../../firmware/examples/verify_only.rs"]
mod verify_only;

const GUIDE: &str = include_str!("../../../docs/library.md");

/// The block of text behind the marker of an example.
fn shown(name: &str) -> &'static str {
    let (_, rest) = GUIDE.split_once(&format!("<!-- {name} -->\n```text\n")).expect("a marker");
    rest.split_once("```").expect("the block ends").0
}

#[test]
fn each_prints_what_the_guide_shows() {
    for name in ["certify", "verify_only", "servo_on_host"] {
        let output = Command::new(env!("CARGO"))
            // Of all default members, for which it is built already.
            .args(["run", "--quiet", "--example", name])
            .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
            .output()
            .expect("cargo starts");
        let (said, error) = (output.stdout.as_slice(), String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success(), "{name}: {error}");
        assert_eq!(String::from_utf8_lossy(said), shown(name), "{name}");
    }
}

/// What the foreign loop computes by itself is the law that was certified.
#[test]
fn somebody_elses_loop_computes_the_certified_law() {
    let transducers = Transducers::of(61_440.0, 1.0);
    let mut servo: Servo<_, f64> = Servo::new(&verify_only::CERTIFIED, &transducers).unwrap();
    let mut foreign = verify_only::ControlLoop::default();
    let mut largest = 0.0_f64;
    for tick in 0..2000 {
        let angle = 0.03 * (f64::from(tick) / 40.0).sin();
        // The servo gives the coupling's torque, of which the motor has the opposite.
        let (expected, torque) = (-servo.tick_at(angle).unwrap(), foreign.update(angle as f32));
        let off = (f64::from(torque) - expected).abs();
        assert!(off < 1e-6, "tick {tick}: {torque}, not {expected}");
        largest = largest.max(expected.abs());
    }
    assert_eq!(largest, 0.3);
}
