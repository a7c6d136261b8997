//! The handle against servos and devices that are built without it.

use haptic_model::device::{Hand, HandSetpoint, Motion};
use haptic_model::simulation::held_device::HeldDevice;
use haptic_servo::certificate::Certified;
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Scene};
use haptic_servo::scene_type::Typed;
use haptic_servo::servo::{Servo, Transducers};
use serde_json::{Value, json};

use super::{hold, motion, push, recorded, replay};
use crate::scene_text::read;

/// Numbers of a tick.
const COLUMNS: usize = 7;
const STIFFNESS: f64 = 22.0;

/// The wall of the guide, with its stiffness in N m/rad.
fn wall(stiffness: f64) -> String {
    json!({
        "name": "wall",
        "device": { "inertia": 2.2e-5, "damping": 0.022 },
        "servo": { "period": 1e-3 },
        "coupling": { "stiffness": 44.0 },
        "environment": { "type": "damper-wall", "stiffness": stiffness, "damping": 0.01, "delay": 1 },
        "limits": { "torque": 2.0 },
    })
    .to_string()
}

fn settings(scene: &str, is_checked: bool) -> String {
    json!({
        "scene": scene,
        "counts_per_turn": 61_440.0,
        "hand": { "stiffness": 6.0, "damping": 0.02, "inertia": 1e-4 },
        "is_checked": is_checked,
    })
    .to_string()
}

fn held(scene: &str, is_checked: bool) -> Value {
    serde_json::from_str(&hold(&settings(scene, is_checked), &mut Vec::new()).unwrap()).unwrap()
}

/// Text and ticks of a motion.
fn moved(ticks: u32, setpoint: f64, is_held: bool) -> (Value, Vec<[f64; COLUMNS]>) {
    let question = json!({ "ticks": ticks, "setpoint": setpoint, "is_held": is_held }).to_string();
    let mut numbers = Vec::new();
    let text = motion(&question, &mut numbers).unwrap();
    let rows = numbers.as_chunks().0.to_vec();
    assert_eq!(rows.len(), ticks as usize);
    (serde_json::from_str(&text).unwrap(), rows)
}

fn record() -> Vec<(i32, u16)> {
    let mut numbers = Vec::new();
    recorded("", &mut numbers).unwrap();
    numbers.as_chunks().0.iter().map(|&[count, code]| (count as i32, code as u16)).collect()
}

#[test]
fn the_codes_are_those_of_the_servo_that_is_compiled_for_a_board() {
    const CERTIFIED: Certified<Scene> = Scene {
        coupling: Coupling::Spring { stiffness: 44.0 },
        torque_limit: Some(2.0),
        ..Scene::of(Device::damped(2.2e-5, 0.022), 1e-3, Wall::damped(STIFFNESS, 0.01, 1).alone())
    }
    .certified();
    haptic_servo::scene_type!(Compiled: CERTIFIED);
    let certified = Typed::<Compiled>::certified();
    let transducers = Transducers {
        counts_per_turn: 61_440.0,
        counter: CounterWidth::Bits32,
        full_scale_torque: 2.0,
        largest_speed: 100.0,
    };
    let mut servo: Servo<_, f32> = Servo::new(&certified, &transducers).unwrap();
    assert_eq!(held(&wall(STIFFNESS), true)["rendering"], "certified");
    let mut rows = Vec::new();
    for (setpoint, is_held) in [(0.1, true), (0.35, true), (-0.02, true), (0.2, true), (0.2, false)]
    {
        rows.extend(moved(200, setpoint, is_held).1);
    }
    let record = record();
    let codes: Vec<u16> = record.iter().map(|tick| tick.1).collect();
    assert!(codes.iter().any(|&code| code < 1000), "{:?}", codes.iter().min());
    for (tick, &(count, code)) in record.iter().enumerate() {
        assert_eq!(servo.tick(RawCount::from(count)).code.get(), code, "tick {tick}");
    }
    let settled = record.len() - rows.len();
    for (row, &(count, code)) in rows.iter().zip(&record[settled..]) {
        assert_eq!((row[0], row[3]), (f64::from(count), f64::from(code)));
    }
    let counts: Vec<i32> = record.iter().map(|tick| tick.0).collect();
    let question =
        json!({ "scene": wall(STIFFNESS), "counts_per_turn": 61_440.0, "counts": counts });
    let mut again = Vec::new();
    replay(&question.to_string(), &mut again).unwrap();
    assert_eq!(again, codes.iter().map(|&code| f64::from(code)).collect::<Vec<_>>());
}

#[test]
fn the_device_moves_by_the_codes_and_the_hand() {
    held(&wall(STIFFNESS), true);
    let rows = moved(400, 0.3, true).1;
    let hand = Hand { inertia: 1e-4, damping: 0.02, stiffness: 6.0 };
    let device = HeldDevice::of(&read(&wall(STIFFNESS)).unwrap().scene, hand).unwrap();
    let mut state = device.at(Motion::default());
    for (tick, row) in rows.iter().enumerate() {
        assert_eq!(row[0], (state.motion().position * 61_440.0 / std::f64::consts::TAU).floor());
        let [from, to] = [tick, tick + 1].map(|tick| 0.3 * tick as f64 / 400.0);
        device.step(&mut state, (row[3] - 2048.0) * 2.0 / 1791.0, HandSetpoint { from, to });
        assert!((row[5] - to).abs() < 1e-12 && (row[6] - state.motion().position).abs() < 1e-9);
    }
    assert!(rows[399][6] > 0.03 && rows[399][2] > 0.5, "{:?}", rows[399]);
}

#[test]
fn a_refused_scene_has_no_torque_until_the_check_is_off_and_then_it_shakes() {
    let stiff = wall(120.0);
    let shown = held(&stiff, true);
    assert_eq!(shown["rendering"], "off");
    assert!(shown["refusal"].as_str().unwrap().contains("alpha = 0.07"), "{shown}");
    let (_, rows) = moved(500, 0.2, true);
    assert!(rows.iter().all(|row| row[3] == 2048.0 && row[2] == 0.0));

    assert_eq!(held(&stiff, false)["rendering"], "unchecked");
    moved(100, 0.05, true);
    let (text, rows) = moved(500, 0.05, true);
    let frequency = text["oscillation"]["frequency"].as_f64().unwrap();
    assert!(text["oscillation"]["counts"].as_f64().unwrap() > 20.0, "{text}");
    let amplitude = text["oscillation"]["amplitude"].as_f64().unwrap();
    assert!((100.0..=500.0).contains(&frequency), "{text}");
    let most = rows.iter().map(|row| row[2]).fold(0.0, f64::max);
    assert!(amplitude > 0.5 && amplitude <= 2.0 && most <= 2.0, "{text} {most}");
    let given = text["energy"]["given"].as_f64().unwrap();
    assert!(text["energy"]["got_back"].as_f64().unwrap() > given, "{text}");

    // The limit within the certificate is at rest in the same hand.
    held(&wall(STIFFNESS), true);
    moved(500, 0.05, true);
    let text = moved(500, 0.05, true).0;
    let counts = text["oscillation"]["counts"].as_f64().unwrap_or(0.0);
    assert!(counts < 3.0, "more than the steps of the encoder: {text}");
}

#[test]
fn another_scene_goes_on_where_the_device_is() {
    held(&wall(STIFFNESS), true);
    let before = moved(600, 0.2, true).1[599];
    held(&wall(0.9 * STIFFNESS), true);
    let after = moved(1, 0.2, true).1[0];
    // The servo's torque is that of the softer wall at once: its memory settled there.
    assert!((after[2] / before[2] - 0.94).abs() < 0.05, "{before:?} {after:?}");
    assert!((after[6] - before[6]).abs() < 1e-3);
    assert_eq!(after[5], before[5]);
}

#[test]
fn a_push_moves_the_hand_and_lets_go() {
    held(&wall(STIFFNESS), true);
    push("", &mut Vec::new()).unwrap();
    let (text, rows) = moved(3000, 0.0, false);
    assert_eq!((&text["is_pushing"], &text["is_held"]), (&json!(true), &json!(true)));
    assert!(rows.iter().any(|row| (row[5] - 0.12).abs() < 1e-6));
    let (text, _) = moved(3000, 0.0, false);
    assert_eq!((&text["is_pushing"], &text["is_held"]), (&json!(false), &json!(false)));
}

#[test]
fn what_is_wrong_is_named_and_changes_nothing() {
    held(&wall(STIFFNESS), true);
    let row = moved(300, 0.1, true).1[299];
    let refused = |text: String| hold(&text, &mut Vec::new()).unwrap_err();
    let good = settings(&wall(STIFFNESS), true);
    let hand = refused(good.replace("\"stiffness\":6.0", "\"stiffness\":-6.0"));
    assert!(hand.contains("-6 N m/rad must be 0 or more"), "{hand}");
    let counts = refused(good.replace("61440.0", "0.0"));
    assert!(counts.contains("0 counts a turn"), "{counts}");
    assert!(refused(good.replace("damper-wall", "damper-well")).contains("damper-well"));
    let many = json!({ "ticks": 50_001, "setpoint": 0.0, "is_held": true }).to_string();
    assert!(motion(&many, &mut Vec::new()).unwrap_err().contains("50001 ticks"));
    assert!((moved(1, 0.1, true).1[0][6] - row[6]).abs() < 1e-4);
}

/// What the hand took of a host beside a soft wall in a second, over the budget, and the part that was refused.
fn taken(law: &str, has_no_tank: bool) -> (f64, f64) {
    let mut scene: Value = serde_json::from_str(&wall(10.0)).unwrap();
    scene["environment"]["damping"] = 0.002.into();
    scene["limits"] = json!({ "torque": 1.0, "full_scale": 2.0 });
    scene["host"] =
        json!({ "energy": 0.05, "power": 0.1, "damping": 0.004, "torque": 0.5, "timeout": 0.05 });
    let mut settings: Value = serde_json::from_str(&settings(&scene.to_string(), true)).unwrap();
    settings["host"] = law.into();
    settings["has_no_tank"] = has_no_tank.into();
    let held: Value =
        serde_json::from_str(&hold(&settings.to_string(), &mut Vec::new()).unwrap()).unwrap();
    assert_eq!((&held["has_host"], &held["host_refusal"]), (&true.into(), &Value::Null), "{held}");
    assert_eq!(held["torque_limit"], 1.5);
    let (moved, _) = moved(1000, 0.05, true);
    let number = |key: &str| moved["host"][key].as_f64().unwrap();
    (number("taken") / number("budget"), number("refused"))
}

#[test]
fn a_hand_takes_no_more_than_the_budget_from_a_host_and_without_its_tank_more() {
    for law in ["pump", "square"] {
        let (with, refused) = taken(law, false);
        assert!((0.5..=1.0).contains(&with) && refused > 0.1, "{law}: {with} {refused}");
        let (without, refused) = taken(law, true);
        assert!(without > 2.0 && refused == 0.0, "{law}: {without} {refused}");
    }
    // A scene without a budget has no host.
    let mut settings: Value = serde_json::from_str(&settings(&wall(10.0), true)).unwrap();
    settings["host"] = "pump".into();
    let held = hold(&settings.to_string(), &mut Vec::new()).unwrap();
    assert!(held.contains("\"has_host\":false"), "{held}");
    assert_eq!(moved(10, 0.0, true).0["host"], Value::Null);
}
