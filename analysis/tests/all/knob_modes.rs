//! The modes of a knob, selected by the program over the wire of a board that is a thread.

use crate::common::board::Rig;
use crate::common::{read, root};
use crate::readme::block;
use analysis::board_sim::Pacing;
use analysis::link::RequestResult;
use analysis::lockstep::PlantIo;
use haptic_servo::certificate::Parameter;
use haptic_servo::environment::{KNOB_MODES, MODES, Shape};

/// A knob that a hand holds at 50 degrees.
struct Held;

impl PlantIo for Held {
    fn count(&mut self) -> Option<i32> {
        Some(61_440 * 50 / 360)
    }

    fn hold(&mut self, _: u16) {}
}

fn knob() -> Rig {
    Rig::start("knob_modes", Held, Pacing::Unthrottled)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn tune_selects_a_mode_and_lists_them_by_name() {
    let rig = knob();
    let output = rig.haptic(&["tune", "mode=3"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let printed = text(&output.stdout);
    assert!(printed.contains("mode=3"), "{printed}");
    // The guide shows the list.
    assert!(printed.contains(&block("docs/knob-modes.md", "modes")), "{printed}");
    for (number, mode) in KNOB_MODES.iter().enumerate() {
        assert!(printed.contains(&format!("{number:2}  {}\n", mode.name())), "{printed}");
    }
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
