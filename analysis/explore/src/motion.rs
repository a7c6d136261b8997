//! The motion of a scene in a hand, certified or not, as computed by `haptic simulate`.

use std::path::Path;

use haptic_model::file::SceneFile;
use haptic_model::file::simulation::HandTorque;
use haptic_model::hand::HandTrajectory;
use haptic_model::simulation::Experiment;
use haptic_model::simulation::plant::Plant;
use haptic_model::simulation::torque_signal::TorqueSignal;
use haptic_model::trace::Trace;
use haptic_model::worst_hand;
use serde_json::json;

use crate::PageResult;
use crate::scene_text::read;

/// Largest number of samples of a default push.
const MOST: f64 = 40_000.0;
/// Smallest number of samples of it, also for the slowest servo.
const LEAST: f64 = 50.0;
/// The end of that push in s.
const END: f64 = 3.5;
/// Angle in rad beyond which a hand does not follow; the end of the drawing of such a push.
const FARTHEST: f64 = 4.0;
/// The same for a scene file's simulation: 160 000 turns.
const RUN_AWAY: f64 = 1e6;
/// Duration in s of the motion in a hand in which the scene oscillates, and its initial torque in N m.
const SHAKEN: f64 = 0.5;
const TAP: f64 = 1e-3;
/// Largest number of samples of a scene file's simulation: more do not improve a picture, and the page would
/// not respond.
const LONGEST: usize = 2_000_000;

/// A run of the scene: that of its `[simulation]`, or otherwise a push by a typical hand; of a rejected
/// scene, in the hand with the strongest oscillation, if one is found. The request is the scene, optionally
/// after `typical` and a line feed: then that hand is not searched, which takes longer than a frame.
///
/// Numbers: time in s, angle in rad and coupling torque in N m, column by column.
pub fn motion(text: &str, numbers: &mut Vec<f64>) -> PageResult {
    let (is_typical, text) = match text.strip_prefix("typical\n") {
        Some(text) => (true, text),
        None => (false, text),
    };
    let file = read(text).map_err(|error| error.to_string())?;
    let run = match (&file.simulation, is_typical || file.scene.certify().is_ok()) {
        (Some(_), _) => asked_for(&file)?,
        (None, true) => pushed(&file)?,
        (None, false) => match shaken(&file) {
            Some(run) => run,
            None => pushed(&file)?,
        },
    };
    let trace = &run.trace;
    for column in [&trace.time, &trace.position, &trace.torque] {
        numbers.extend(column);
    }
    Ok(json!({
        "samples": trace.time.len(),
        "what": run.what,
        "torque_limit": file.scene.torque_limit,
        "face": trace.face,
        "lost": trace.lost,
    })
    .to_string())
}

/// A run and its description.
struct Run {
    what: String,
    trace: Trace,
}

/// The scene file's simulation.
fn asked_for(file: &SceneFile) -> Result<Run, String> {
    if let Some(simulation) = &file.simulation {
        if let HandTorque::File(name) = &simulation.torque {
            let name = name.display();
            return Err(format!("the torques are in the file {name}, which a page cannot read"));
        }
        if simulation.samples > LONGEST {
            let samples = simulation.samples;
            return Err(format!("{samples} samples are too many for a page: at most {LONGEST}"));
        }
    }
    let trace = Trace::simulated(file, Path::new("")).map_err(|error| error.to_string())?;
    let trace = trace.until(|value| value.abs() <= RUN_AWAY);
    Ok(Run { what: "the scene's own [simulation]".to_owned(), trace })
}

/// The push that demonstrates an environment, without release.
fn pushed(file: &SceneFile) -> Result<Run, String> {
    let path = HandTrajectory::for_environment(&file.scene.environment);
    let hand = file.hand.unwrap_or(path.hand);
    let period = file.scene.timing.period;
    let samples = (END / period).clamp(LEAST, MOST) as usize;
    // The set-point acts through the hand's spring and damper.
    let torque = |k: usize| {
        let (now, next) =
            (path.position(k as f64 * period), path.position((k + 1) as f64 * period));
        0.5 * hand.stiffness * (now + next) + hand.damping * (next - now) / period
    };
    let held = Experiment {
        plant: Plant::of(&file.chain).with_hand(hand),
        samples,
        hand_torque: TorqueSignal::Held((0..samples).map(torque).collect()),
        ..Experiment::at_rest(file)
    };
    // Without release, which would be another loop.
    let what = path.description.split(" and ").next().unwrap_or_default();
    run(file, &held, what.to_owned())
}

/// The hand in which a rejected scene oscillates most, after a tap; `None` if none is found.
fn shaken(file: &SceneFile) -> Option<Run> {
    let found = worst_hand::search(&file.scene, &file.chain).ok()?;
    if !found.oscillates {
        return None;
    }
    let samples = (SHAKEN / file.scene.timing.period).clamp(LEAST, MOST) as usize;
    let tapped = Experiment {
        plant: worst_hand::plant(&file.chain, 1.0, &found.worst.hand),
        samples,
        hand_torque: TorqueSignal::Held(vec![TAP]),
        ..Experiment::at_rest(file)
    };
    let what = format!(
        "after a tap, in the passive hand in which it oscillates most, at {} Hz",
        haptic_model::quantity::significant(found.worst.frequency, 3)
    );
    run(file, &tapped, what).ok()
}

fn run(file: &SceneFile, experiment: &Experiment, what: String) -> Result<Run, String> {
    let experiment = Experiment {
        encoder_step: file.encoder_step,
        friction: file.friction.unwrap_or(0.0),
        ..experiment.clone()
    };
    let trace = Trace::of(file, &experiment).map_err(|error| error.to_string())?;
    Ok(Run { what, trace: trace.until(|value| value.abs() <= FARTHEST.max(TAP)) })
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use haptic_model::simulation::{Integration, simulate};

    use crate::test_scenes::{FREE_MODE, LATE_WALL, PROFILE, WALL};

    fn moved(text: &str) -> (Value, Vec<Vec<f64>>) {
        let mut numbers = Vec::new();
        let answer: Value = serde_json::from_str(&motion(text, &mut numbers).unwrap()).unwrap();
        let samples = answer["samples"].as_u64().unwrap() as usize;
        assert_eq!(numbers.len(), 3 * samples);
        let columns = numbers.chunks_exact(samples).map(<[f64]>::to_vec).collect();
        (answer, columns)
    }

    #[test]
    fn a_simulation_that_is_asked_for_is_that_of_the_program() {
        let mut scene: Value = serde_json::from_str(WALL).unwrap();
        scene["simulation"] = serde_json::json!({ "samples": 300, "position": 0.001 });
        let (answer, columns) = moved(&scene.to_string());
        let file = read(&scene.to_string()).unwrap();
        let experiment = Experiment::of(&file, Path::new("")).unwrap();
        let motion = simulate(&experiment, Integration::default()).unwrap();
        assert_eq!((&columns[1], &columns[2]), (&motion.position, &motion.torque));
        assert!(answer["what"].as_str().unwrap().contains("[simulation]"));
    }

    #[test]
    fn a_push_into_a_wall_is_held_by_the_hand_and_the_wall() {
        let (answer, columns) = moved(WALL);
        assert_eq!(answer["lost"], Value::Null);
        // At 1.6 s the hand holds still at 0.12 rad: its spring and the wall behind its coupling share it.
        let rest = 6.0 * 0.12 / (6.0 + 1.0 / (1.0 / 22.0 + 1.0 / 44.0));
        let (angle, torque) = (columns[1][1600], columns[2][1600]);
        assert!((angle / rest - 1.0).abs() < 1e-3, "{angle} {rest}");
        assert!((torque / (6.0 * (0.12 - rest)) - 1.0).abs() < 1e-3, "{torque}");
        for scene in [LATE_WALL, PROFILE, FREE_MODE] {
            let (answer, columns) = moved(scene);
            assert!(columns[1].iter().any(|angle| angle.abs() > 0.05), "{answer}");
        }
    }

    #[test]
    fn a_rejected_scene_shakes() {
        let rejected = WALL.replace("\"delay\": 1", "\"delay\": 2");
        assert!(read(&rejected).unwrap().scene.certify().is_err());
        let (answer, columns) = moved(&rejected);
        assert!(answer["what"].as_str().unwrap().contains("oscillates"), "{answer}");
        let largest = |half: &[f64]| half.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let (first, second) = columns[1].split_at(columns[1].len() / 2);
        assert!(largest(second) > 2.0 * largest(first), "{answer}");
        // The same without looking for a hand.
        let (typical, _) = moved(&format!("typical\n{rejected}"));
        assert!(!typical["what"].as_str().unwrap().contains("oscillates"));
    }

    #[test]
    fn a_page_reads_no_file_and_computes_no_hour() {
        let mut scene: Value = serde_json::from_str(WALL).unwrap();
        scene["simulation"] = serde_json::json!({ "samples": 10, "torque_file": "a.csv" });
        let refusal = motion(&scene.to_string(), &mut Vec::new()).unwrap_err();
        assert!(refusal.contains("a.csv"), "{refusal}");
        scene["simulation"] = serde_json::json!({ "samples": 90_000_000 });
        let refusal = motion(&scene.to_string(), &mut Vec::new()).unwrap_err();
        assert!(refusal.contains("90000000"), "{refusal}");
    }
}
