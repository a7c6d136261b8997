//! The modes of a knob, selected by the program over the wire of a board that is a thread.

use crate::common::board::{Rig, Still};
use crate::common::{read, root};
use crate::readme::block;
use analysis::board_sim::Pacing;
use haptic_servo::environment::{KNOB_MODES, MODES, Shape};

#[test]
fn tune_selects_a_mode_and_lists_them_by_name() {
    // A hand holds it at 50 degrees.
    let rig = Rig::start("knob_modes", Still(61_440 * 50 / 360), Pacing::Unthrottled);
    let output = rig.haptic(&["tune", "mode=3"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("mode=3"), "{printed}");
    // The guide shows the list.
    assert!(printed.contains(&block("docs/knob-modes.md", "modes")), "{printed}");
    for (number, mode) in KNOB_MODES.iter().enumerate() {
        assert!(printed.contains(&format!("{number:2}  {}\n", mode.name())), "{printed}");
    }
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
