use std::path::Path;

use haptic_servo::scene::{Device, Latency, Scene};

use super::advice::JudgedModel;
use super::*;
use crate::chain::{Link, Mass};
use crate::file::{self, Format, Purpose};
use crate::simulation::{Experiment, Integration, Trajectory, simulate};
use crate::{stability, verdict};

/// A knob on a shaft of steel, at an amplifier that is fast, in a hand.
const STIFF: &str = r#"
name = "stiff shaft"
device = { actuator_lag = 2e-6, mass = [
    { inertia = 1.4e-5, damping = 0.022 }, { inertia = 0.8e-5 },
], link = [{ stiffness = 9000.0, damping = 0.01 }] }
servo = { period = 0.001 }
coupling = { stiffness = 44.0 }
environment = { type = "damper-wall", stiffness = 22.0, damping = 0.01, delay = 1 }
simulation = { samples = 1000, position = 0.001 }
human = { inertia = 1e-4, damping = 0.02, stiffness = 6.0 }
"#;

/// Two masses on a soft link, in front of a spring that is about as stiff as can be.
const SOFT: &str = r#"
name = "soft link"
device = { mass = [
    { inertia = 0.02, damping = 0.5 }, { inertia = 0.03 },
], link = [{ stiffness = 700.0, damping = 0.1 }] }
servo = { period = 0.001 }
environment = { type = "delayed-spring", stiffness = 337.0, delay = 1 }
simulation = { samples = 1000, position = 0.001 }
"#;

/// A rigid device at a spring that only a prompt amplifier holds: `b / (T/2)` is 1000, and
/// `b / (T/2 + lag)` is 500.
const LAGGING: &str = r#"
name = "lagging"
device = { inertia = 0.05, damping = 0.5, actuator_lag = 0.0005 }
servo = { period = 0.001 }
environment = { type = "damper-wall", stiffness = 700.0, damping = 0.0, delay = 0 }
simulation = { samples = 1000, position = 0.001 }
"#;

fn parse(text: &str) -> SceneFile {
    file::parse_for(Purpose::Simulate, "scene.toml", Format::Toml, text).unwrap()
}

fn advice(text: &str, bound: f64) -> Advice {
    advise(&parse(text), Path::new(""), bound).unwrap()
}

fn judged<'a>(advice: &'a Advice, model: &str) -> &'a JudgedModel {
    advice.models.iter().find(|judged| judged.model == model).unwrap()
}

/// Largest difference of two columns, as a share of the largest value of the second.
fn off(column: &[f64], full: &[f64]) -> f64 {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let difference = largest(&mut (0..full.len()).map(|k| column[k] - full[k]));
    difference / largest(&mut full.iter().copied())
}

#[test]
fn a_rigid_device_in_its_hand_is_enough_for_a_stiff_shaft() {
    let advice = advice(STIFF, 0.01);
    assert_eq!(advice.enough, "rigid, hand");
    assert_eq!(advice.left_out, ["a mass", "the amplifier's lag"]);
    assert!(advice.no_certificate.is_none());
    // Against two machines that are put together by hand.
    let file = parse(STIFF);
    let run = Experiment::of(&file, Path::new("")).unwrap();
    let hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 6.0 };
    let scene = Scene { latency: Latency::NONE, ..run.scene };
    let motion = |plant: Plant| -> Trajectory {
        simulate(
            &Experiment { plant: plant.with_hand(hand), scene, ..run.clone() },
            Integration::default(),
        )
        .unwrap()
    };
    let rigid = motion(Plant::rigid(Device { inertia: 2.2e-5, damping: 0.022, passivity: None }));
    let masses = [Mass { inertia: 1.4e-5, damping: 0.022 }, Mass { inertia: 0.8e-5, damping: 0.0 }];
    let full = motion(
        Plant::chain(&masses, &[Link { stiffness: 9000.0, damping: 0.01 }]).with_actuator_lag(2e-6),
    );
    let found = judged(&advice, "rigid, hand").deviation;
    assert!((found.angle - off(&rigid.position, &full.position)).abs() < 1e-9, "{found:?}");
    assert!((found.torque - off(&rigid.torque, &full.torque)).abs() < 1e-9, "{found:?}");
    assert!(found.angle > 1e-4);
}

#[test]
fn the_bound_decides() {
    assert_eq!(advice(STIFF, 0.005).enough, "2 masses, hand");
    assert_eq!(advice(STIFF, 1e-6).enough, "2 masses, hand, lag");
    let strict = advice(STIFF, 1e-6).message;
    assert!(strict.contains("nothing may be left out"), "{strict}");
    assert!(strict.contains("without the hand: critical stiffness"), "{strict}");
}

#[test]
fn a_second_mass_changes_whether_the_loop_is_stable() {
    let advice = advice(SOFT, 1.0);
    let [rigid, full] = ["rigid", "2 masses"].map(|model| judged(&advice, model));
    assert_eq!(rigid.result.stability, stability::StabilityVerdict::Unstable);
    assert_eq!(full.result.stability, stability::StabilityVerdict::Stable);
    assert_eq!((advice.enough.as_str(), &advice.left_out), ("2 masses", &Vec::new()));
    assert!(rigid.beyond.contains(&"unstable and not stable".to_owned()), "{rigid:?}");
    // The limit of theory, section 4.1 at full damping: b > K T (n + 1/2), nearly stability's.
    let limit = rigid.result.critical_stiffness.unwrap();
    assert!((limit - 0.5 / 0.0015).abs() < 0.01 * limit, "{limit}");
}

/// The second mass's damper does not reach the motor by a link that has none of its own: `delta`
/// is 0.3, which is not more than `K T (n + 1/2)` = 0.375; rigid it is 0.5, which is.
#[test]
fn a_second_mass_changes_the_certificate() {
    let masses = "{ inertia = 0.02, damping = 0.3 }, { inertia = 0.03, damping = 0.2 }";
    let apart = SOFT
        .replace("{ inertia = 0.02, damping = 0.5 }, { inertia = 0.03 }", masses)
        .replace("stiffness = 700.0, damping = 0.1", "stiffness = 90000.0")
        .replace("337.0", "250.0");
    let advice = advice(&apart, 1.0);
    let [rigid, full] = ["rigid", "2 masses"].map(|model| judged(&advice, model));
    assert_eq!((rigid.result.delta, full.result.delta), (Some(0.5), Some(0.3)));
    assert_eq!(rigid.result.certificate, Some(verdict::Verdict::Certified));
    assert_eq!(full.result.certificate, Some(verdict::Verdict::Rejected));
    assert_eq!(advice.enough, "2 masses");
}

#[test]
fn a_lag_changes_whether_the_loop_is_stable() {
    let advice = advice(LAGGING, 1.0);
    assert_eq!(advice.enough, "rigid, lag");
    let [prompt, late] = ["rigid", "rigid, lag"].map(|model| judged(&advice, model));
    for (judged, limit) in [(prompt, 1000.0), (late, 500.0)] {
        let found = judged.result.critical_stiffness.unwrap();
        assert!((found - limit).abs() < 0.01 * limit, "{found}");
    }
    assert_eq!(prompt.result.stability, stability::StabilityVerdict::Stable);
    assert_eq!(late.result.stability, stability::StabilityVerdict::Unstable);
    // The lag is the controller's: the same passivity, and another certificate.
    assert_eq!((late.result.delta, prompt.result.delta), (Some(0.5), Some(0.5)));
    assert_eq!(late.result.certificate, Some(verdict::Verdict::Rejected));
}

#[test]
fn what_was_measured_holds_for_every_model() {
    let measured = SOFT.replace("device = {", "device = { passivity = 0.4,");
    for judged in advice(&measured, 0.01).models {
        assert_eq!(judged.result.delta, Some(0.4), "{}", judged.model);
    }
}

#[test]
fn a_file_with_nothing_to_leave_out_says_so() {
    let rigid = LAGGING.replace(", actuator_lag = 0.0005", "");
    let advice = advice(&rigid, 0.01);
    assert_eq!(advice.models.len(), 1);
    assert_eq!(advice.message, "rigid is all that the file describes");
}

#[test]
fn models_grow_and_end_with_the_fullest() {
    let fullest = Model { masses: 2, hand: true, lag: true };
    let models: Vec<String> = fullest.up_to().iter().map(ToString::to_string).collect();
    let grown = [
        "rigid",
        "rigid, hand",
        "rigid, lag",
        "rigid, hand, lag",
        "2 masses",
        "2 masses, hand",
        "2 masses, lag",
        "2 masses, hand, lag",
    ];
    assert_eq!(models, grown);
    let rigid = Model { masses: 1, hand: false, lag: false };
    assert_eq!(rigid.up_to(), [rigid]);
    assert_eq!(rigid.lacks(fullest), ["a mass", "the hand", "the amplifier's lag"]);
    assert!(fullest.lacks(fullest).is_empty());
}
