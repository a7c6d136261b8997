//! The published cases of scenes whose torque lags: verdicts, and indices at the port to 24 digits.

use analysis::file::{self, Format};
use analysis::verdict::{Verdict, VerdictReport, judge};
use haptic_servo::scene::Scene;
use serde_json::{Value, json};
use tests::exact::{Q, of_decimal, q};

/// Width of an index relative to its magnitude.
const TOLERANCE: f64 = 1e-9;

/// The case as a scene file has it.
fn scene_file(case: &Value) -> Value {
    let mut scene = json!({
        "name": case["id"],
        "device": {
            "inertia": 2.2e-5,
            "damping": case["b"],
            "actuator_lag": case["actuator_lag"],
            "sensor_lag": case["sensor_lag"],
        },
        "servo": { "period": case["T"], "output_delay": case["output_delay"] },
        "environment": case["environment"],
    });
    if case["K"].is_number() {
        scene["coupling"] = json!({ "stiffness": case["K"] });
    }
    scene
}

/// The published cases.
fn published() -> Value {
    serde_json::from_str(include_str!("../../data/lag.json")).expect("JSON")
}

fn read(scene: &Value) -> Scene {
    let read = file::parse("lag.json", Format::Json, &scene.to_string());
    read.unwrap_or_else(|error| panic!("{error}")).scene
}

/// All of them as scenes.
pub fn scenes() -> Vec<Scene> {
    let read = |case: &Value| read(&scene_file(case));
    published()["cases"].as_array().expect("a list").iter().map(read).collect()
}

fn judged(scene: &Value) -> VerdictReport {
    judge("a case", &read(scene))
}

/// The verdict on a wall of 8 N m/rad with these lags of amplifier and sensor and this delay, and its index
/// at the port.
fn certified_wall(actuator: &Value, sensor: &Value, delay: &Value) -> (f64, f64) {
    let report = judged(&json!({
        "name": "wall",
        "device": {
            "inertia": 2.2e-5, "damping": 0.022, "actuator_lag": actuator, "sensor_lag": sensor,
        },
        "servo": { "period": 0.001, "output_delay": delay },
        "environment": { "type": "damper-wall", "stiffness": 8, "damping": 0.002, "delay": 1 },
    }));
    assert_eq!(report.verdict, Verdict::Certified, "{}", report.message);
    let port = report.alpha_port.expect("it lags");
    (port.lo.expect("an index"), port.hi.expect("an index"))
}

/// The fault in the answer to a case; empty if there is none.
fn complaints(case: &Value) -> Vec<String> {
    let found = judged(&scene_file(case));
    let mut wrong = Vec::new();
    let wanted = if case["accept"] == true { Verdict::Certified } else { Verdict::Rejected };
    if found.verdict != wanted {
        wrong
            .push(format!("{}: {} and not {wanted}: {}", case["id"], found.verdict, found.message));
    }
    let lags = ["output_delay", "actuator_lag", "sensor_lag"];
    if case["schur"] == true && lags.iter().any(|key| case[*key] != 0.0) {
        let alpha: Q = of_decimal(case["alpha_port"].as_str().expect("digits")).expect("a decimal");
        match found.alpha_port.map(|port| (port.lo, port.hi)) {
            Some((Some(lo), Some(hi))) => {
                let encloses = q(lo) <= alpha && alpha <= q(hi);
                if !encloses || hi - lo > TOLERANCE * hi.abs() {
                    let wanted = &case["alpha_port"];
                    wrong.push(format!("{}: {wanted} in {lo:e} to {hi:e}", case["id"]));
                }
            }
            other => wrong.push(format!("{}: index {other:?}", case["id"])),
        }
    }
    wrong
}

/// A range of lags that begins with none has an index above those of all lags in it.
#[test]
fn a_range_that_begins_at_zero_holds_all_of_its_lags() {
    for delay in [0.0, 2.5e-4] {
        let none = json!(0);
        let range = certified_wall(&json!([0, 1.2e-4]), &none, &json!([delay, 3e-4]));
        for lag in [1e-9, 1e-6, 1e-5, 6e-5, 1.2e-4] {
            let one = certified_wall(&json!(lag), &none, &json!(3e-4));
            assert!(one.0 <= range.1, "{lag}");
        }
    }
}

/// Amplifier and sensor of the same time constant.
#[test]
fn equal_lags_are_decided_like_those_beside_them() {
    let with = |sensor: f64| certified_wall(&json!(2e-4), &json!(sensor), &json!(1e-4));
    let equal = with(2e-4);
    assert!(equal.1 - equal.0 <= TOLERANCE * equal.1, "{equal:?}");
    let [below, above] = [1.998e-4, 2.002e-4].map(with);
    assert!(below.1 < equal.0 && equal.1 < above.0, "{below:?} {equal:?} {above:?}");
}

/// Where nothing lags the matched coupling is the standard one.
#[test]
fn a_matched_coupling_without_latency_has_the_verdict_of_the_standard_one() {
    let wall = |coupling: Value, stiffness: f64| {
        judged(&json!({
            "name": "wall",
            "device": { "inertia": 2.2e-5, "damping": 0.022 },
            "servo": { "period": 0.001 },
            "coupling": coupling,
            "environment": {
                "type": "damper-wall", "stiffness": stiffness, "damping": 0.01, "delay": 1,
            },
        }))
    };
    for (stiffness, verdict) in [(23.99, Verdict::Certified), (24.01, Verdict::Rejected)] {
        let matched = wall(json!({ "type": "matched" }), stiffness);
        let standard = wall(json!({ "stiffness": 44.0 }), stiffness);
        assert_eq!((matched.verdict, standard.verdict), (verdict, verdict), "{}", matched.message);
        assert!(matched.alpha_port.is_some() && standard.alpha_port.is_none());
    }
}

#[test]
fn every_published_case_has_its_verdict_and_its_index() {
    let published = published();
    let cases = published["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 60);
    let wrong: Vec<String> = cases.iter().flat_map(complaints).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
