//! The modes of a knob, selected by the program over the wire of a board that is a thread.

use std::process::Output;

use crate::common::{haptic, read, root};
use crate::readme::block;
use crate::wire::{Rig, text};
use analysis::board_sim::Pacing;
use analysis::link::RequestResult;
use analysis::program::knob_modes;
use haptic_servo::certificate::{Parameter, certify_in};
use haptic_servo::environment::{KNOB_MODES, MODES, Profile, Shape};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Scene};
use haptic_servo::servo::Latched;

/// A board with the knob, which a hand holds at 50 degrees.
fn knob() -> Rig {
    Rig::holding("knob_modes", 61_440 * 50 / 360, Pacing::Unthrottled)
}

fn tune(rig: &Rig, arguments: &[&str]) -> Output {
    rig.haptic(&[&["tune"], arguments].concat())
}

#[test]
fn tune_selects_a_mode_and_lists_them_by_name() {
    let rig = knob();
    let output = tune(&rig, &["mode=3"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let printed = text(&output.stdout);
    assert!(printed.contains("mode=3"), "{printed}");
    // The guide shows the list.
    assert!(printed.contains(&block("docs/knob-modes.md", "modes")), "{printed}");
    for (number, mode) in KNOB_MODES.iter().enumerate() {
        assert!(printed.contains(&format!("{number:2}  {}\n", mode.name)), "{printed}");
    }
    // Where there are no modes there is no list.
    assert!(!text(&haptic(&["tune", "--help"]).stdout).contains("unbounded"));
}

#[test]
fn every_mode_is_selected_after_every_other() {
    let rig = knob();
    let mut link = rig.link();
    assert_eq!(link.arm().unwrap(), RequestResult::Done);
    for step in 1..KNOB_MODES.len() {
        for place in 0..KNOB_MODES.len() {
            let mode = (step * place % KNOB_MODES.len()) as f64;
            let set = link.set([(Parameter::Mode, mode)].into_iter().collect()).unwrap();
            assert_eq!(set, RequestResult::Done, "{mode}");
            assert!(link.parameters().unwrap().values.contains(&(Parameter::Mode, mode)));
        }
    }
    let described = link.description().unwrap().scene;
    let profile = described.environment.profile().unwrap();
    let modes = profile.modes.unwrap();
    assert_eq!((modes.mode, modes.count as usize), (1.0, KNOB_MODES.len()));
    let ends = profile.ends.unwrap();
    assert!((ends.to.to_degrees() - 100.0).abs() < 1e-9, "{ends:?}");
}

#[test]
fn a_mode_that_there_is_not_is_refused_by_name_value_and_bound() {
    let rig = knob();
    for (value, shown) in [("99", "99"), ("-1", "-1"), ("1.5", "1.5")] {
        let output = tune(&rig, &[&format!("mode={value}")]);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        assert_eq!(
            text(&output.stderr).trim_end(),
            format!("rejected: the mode is {shown}, and must be a whole number from 0 to 10")
        );
        assert!(text(&output.stdout).contains("mode=0"), "{output:?}");
    }
    let output = tune(&rig, &["stiffness=3"]);
    let said = text(&output.stderr);
    assert!(said.contains("no stiffness; it has coupling.stiffness, torque_limit, mode"), "{said}");
}

/// The host has no table of another mode: the message states this, and what to do.
#[test]
fn another_mode_is_refused_with_numbers_that_it_is_not_certified_with() {
    let of = |mode: f64, stiffness: f64| Scene {
        environment: Profile::of_modes(&KNOB_MODES, 1).selecting(mode).unwrap().alone(),
        coupling: Coupling::Spring { stiffness },
        ..knob_modes::SCENE
    };
    // A softer coupling suits a knob that turns freely, and not strong detents.
    let passes = |mode, stiffness| {
        let data = of(mode, stiffness);
        certify_in(&data, Format::F32)
            .is_ok_and(|assessment| assessment.renders_in::<Latched>(&data).is_ok())
    };
    let stiffness = (1..440).map(|tenth| 0.1 * f64::from(tenth));
    let stiffness =
        stiffness.into_iter().find(|&stiffness| passes(0.0, stiffness) && !passes(8.0, stiffness));
    let stiffness = stiffness.expect("a coupling that mode 8 is too steep for");
    let rig = knob();
    let set = |name: &str, value: f64| format!("{name}={value}");
    let soft = set("coupling.stiffness", stiffness);
    assert_eq!(tune(&rig, &[&soft]).status.code(), Some(0));
    for arguments in
        [&["mode=8"][..], &["mode=8", "torque_limit=0.5"], &["mode=8", "torque_limit=5"]]
    {
        let output = tune(&rig, arguments);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let said = text(&output.stderr);
        assert!(said.starts_with("mode 8 is not certified with the other numbers"), "{said}");
        assert!(said.contains("the board alone has its table"), "{said}");
    }
    // With the numbers of the program every mode can be selected again.
    assert_eq!(tune(&rig, &["coupling.stiffness=44"]).status.code(), Some(0));
    // A refusal that does not depend on the mode has its own reason.
    for mode in ["mode=0", "mode=1"] {
        for (change, part) in [
            ("torque_limit=5", "above the DAC's full scale"),
            ("torque_limit=-1", "the torque limit is -1 N m"),
        ] {
            let said = text(&tune(&rig, &[mode, change]).stderr);
            assert!(said.contains(part), "{mode} {change}: {said}");
        }
    }
    assert_eq!(tune(&rig, &["mode=8"]).status.code(), Some(0));
}

/// The guide's table has the numbers of the shapes.
#[test]
fn the_guide_describes_the_modes_that_there_are() {
    let guide = read(root().join("docs/knob-modes.md"));
    for (number, mode) in MODES.iter().enumerate() {
        let start = format!("| {number} | {} |", mode.name);
        let row = guide.lines().find(|line| line.starts_with(&start));
        let row = row.unwrap_or_else(|| panic!("no row of mode {number}, {}", mode.name));
        for shape in mode.shapes {
            let parts = match *shape {
                Shape::Detents { count, torque, .. } => {
                    vec![format!("| {count} |"), format!("{torque} N m |")]
                }
                Shape::Centre { stiffness, .. } => vec![format!("{stiffness} N m/rad")],
                Shape::Bistable { distance, torque } => {
                    vec![
                        format!("{:.0} degrees", distance.to_degrees()),
                        format!("| {torque} N m |"),
                    ]
                }
                Shape::Magnet { angle, width, torque } => vec![
                    format!("{:.0}", angle.to_degrees()),
                    format!("{:.0} degrees away", width.to_degrees()),
                    format!("| {torque} N m |"),
                ],
                Shape::EndStops { stiffness, .. } => {
                    assert_eq!(stiffness, 15.0);
                    vec![]
                }
                other => panic!("{other:?}"),
            };
            assert!(parts.iter().all(|part| row.contains(part)), "{row}: {parts:?}");
        }
    }
    assert!(guide.contains("push back with 15 N m/rad"));
}
