//! The map around a scene: the verdicts with other numbers, cell by cell.
//!
//! A map begins with a scene and two parameters as axes, and is then computed row by row in any order, so
//! that a picture can be coarse first.

use std::cell::RefCell;
use std::ops::Range;

use haptic_model::stability_map::plane::{Plane, parameter_of};
use haptic_model::stability_map::{Region, middle};
use haptic_servo::environment::Wall;
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::Scene;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::PageResult;
use crate::scene_text::read;

/// Largest number of cells along an axis.
const MOST: usize = 2000;

thread_local! {
    static MAP: RefCell<Option<Map>> = const { RefCell::new(None) };
}

/// The present map.
struct Map {
    plane: Plane,
    ranges: [Range<f64>; 2],
    cells: [usize; 2],
}

/// The request for a map.
#[derive(Deserialize)]
struct Question {
    /// The scene as text.
    scene: String,
    /// Keys of the two axes, if chosen.
    axes: Option<[String; 2]>,
    /// The range of each axis, if chosen.
    ranges: Option<[[f64; 2]; 2]>,
    /// Cells along each axis.
    cells: [usize; 2],
}

/// Begins a map: returns its axes and the possible axes.
pub fn begin(text: &str, _: &mut Vec<f64>) -> PageResult {
    let question: Question = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let file = read(&question.scene).map_err(|error| error.to_string())?;
    let scene = &file.scene;
    let axes = match &question.axes {
        None => Plane::usual_axes(scene),
        Some([along, up]) => [axis_of(along)?, axis_of(up)?],
    };
    if let Some(cells) = question.cells.iter().find(|cells| !(1..=MOST).contains(*cells)) {
        return Err(format!("a map has from 1 to {MOST} cells along an axis, not {cells}"));
    }
    let plane = Plane::of(&file, axes).map_err(|error| error.to_string())?;
    let ranges = match question.ranges {
        None => plane.usual_ranges(),
        Some(ranges) => ranges.map(|[from, to]| from..to),
    };
    if let Some(range) = ranges.iter().find(|range| range.is_empty()) {
        return Err(format!("an axis from {} to {} shows nothing", range.start, range.end));
    }
    let own = plane.own();
    let axis = |axis: usize| {
        let mut number = number(axes[axis]);
        number["range"] = json!([ranges[axis].start, ranges[axis].end]);
        number["value"] = json!(own[axis]);
        number["whole"] = json!(axes[axis] == Parameter::Count);
        number
    };
    let regions = Region::ALL.map(
        |region| json!({ "name": region.as_str(), "words": region.words(plane.says_stability()) }),
    );
    let answer = json!({
        "axes": [axis(0), axis(1)],
        "choice": Plane::choice(scene).into_iter().map(number).collect::<Vec<_>>(),
        "regions": regions,
        "also": also(scene, axes),
    });
    MAP.set(Some(Map { plane, ranges, cells: question.cells }));
    Ok(answer.to_string())
}

/// Computes cells of a row: the row's number and those of the columns, counted from the lowest and leftmost
/// cell. The numbers are the indices of the regions in the list that `begin` returned.
pub fn row(text: &str, numbers: &mut Vec<f64>) -> PageResult {
    let mut words = text.split(' ').map(|word| {
        word.parse::<usize>().map_err(|_| format!("`{word}` is not a number of a row or column"))
    });
    MAP.with_borrow(|map| {
        let Some(Map { plane, ranges: [along, up], cells: [columns, rows] }) = map else {
            return Err("no map has been begun".to_owned());
        };
        let row = words.next().unwrap_or(Ok(0))?;
        let row = plane.row(middle(up, row, *rows));
        for column in words {
            let region = row.region(middle(along, column?, *columns));
            numbers.push(f64::from(region as u8));
        }
        Ok(String::new())
    })
}

fn axis_of(key: &str) -> Result<Parameter, String> {
    parameter_of(key).ok_or_else(|| format!("a map cannot go along `{key}`"))
}

fn number(parameter: Parameter) -> Value {
    let (name, unit) = parameter.name_and_unit();
    json!({ "key": parameter.key(), "name": name, "unit": unit })
}

/// Further keys with values that another member of the map's scenes must have.
fn also(scene: &Scene, axes: [Parameter; 2]) -> Vec<[&'static str; 2]> {
    // A spring with a damper is a wall.
    match scene.environment.wall() {
        Some(Wall { damper: None, .. }) if axes.contains(&Parameter::Damping) => {
            vec![["environment.type", "damper-wall"]]
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scenes::{FREE_MODE, LATE_WALL, PROFILE, WALL};

    fn begun(scene: &str, axes: Option<[&str; 2]>) -> Value {
        let question = json!({ "scene": scene, "axes": axes, "cells": [12, 9] });
        serde_json::from_str(&begin(&question.to_string(), &mut Vec::new()).unwrap()).unwrap()
    }

    fn cells() -> Vec<u8> {
        let mut all = Vec::new();
        for number in 0..9 {
            let mut numbers = Vec::new();
            row(&format!("{number} 0 1 2 3 4 5 6 7 8 9 10 11"), &mut numbers).unwrap();
            all.extend(numbers.into_iter().map(|region| region as u8));
        }
        all
    }

    fn range(map: &Value, axis: usize) -> Range<f64> {
        let range = &map["axes"][axis]["range"];
        range[0].as_f64().unwrap()..range[1].as_f64().unwrap()
    }

    /// Every cell's scene as a file of its own, judged by itself.
    fn compared(scene: &str, axes: Option<[&str; 2]>) {
        let map = begun(scene, axes);
        let keys = [0, 1].map(|axis| map["axes"][axis]["key"].as_str().unwrap().to_owned());
        let (mut passed, mut failed) = (0, 0);
        for (index, region) in cells().into_iter().enumerate() {
            let values =
                [middle(&range(&map, 0), index % 12, 12), middle(&range(&map, 1), index / 12, 9)];
            let mut file: Value = serde_json::from_str(scene).unwrap();
            for (key, value) in keys.iter().zip(values) {
                let (table, name) = key.split_once('.').unwrap();
                file[table][name] = match name {
                    "count" => json!(value.round().max(1.0)),
                    _ => json!(value),
                };
            }
            let Ok(file) = read(&file.to_string()) else {
                assert_eq!(region, Region::Rejected as u8, "{values:?}");
                continue;
            };
            let certified = file.scene.certify().is_ok();
            let says = region == Region::Exact as u8 || region == Region::Paper as u8;
            assert_eq!(certified, says, "{values:?}");
            if certified { passed += 1 } else { failed += 1 }
        }
        assert!(passed > 5 && failed > 5, "{keys:?} {passed} {failed}");
    }

    #[test]
    fn cells_of_any_two_numbers_are_judged_as_their_files() {
        compared(WALL, None);
        compared(FREE_MODE, None);
        compared(PROFILE, None);
        compared(WALL, Some(["servo.period", "environment.stiffness"]));
        compared(LATE_WALL, Some(["environment.damping", "servo.output_delay"]));
        compared(LATE_WALL, Some(["coupling.stiffness", "environment.damping"]));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let ask = |question: Value| begin(&question.to_string(), &mut Vec::new()).unwrap_err();
        let cells = json!([4, 4]);
        let unknown = ask(json!({
            "scene": WALL, "axes": ["environment.residual", "servo.period"], "cells": cells
        }));
        assert!(unknown.contains("`environment.residual`") && unknown.contains("servo.period"));
        let twice =
            ask(json!({ "scene": WALL, "axes": ["servo.period", "servo.period"], "cells": cells }));
        assert!(twice.contains("must differ"), "{twice}");
        let none = ask(json!({ "scene": WALL, "axes": ["name", "servo.period"], "cells": cells }));
        assert!(none.contains("`name`"), "{none}");
        let many = ask(json!({ "scene": WALL, "cells": [9999, 1] }));
        assert!(many.contains("9999"), "{many}");
        let empty =
            ask(json!({ "scene": WALL, "cells": cells, "ranges": [[1.0, 1.0], [0.0, 1.0]] }));
        assert!(empty.contains("from 1 to 1"), "{empty}");
        assert!(row("1 2", &mut Vec::new()).unwrap_err().contains("begun"));
        begun(WALL, None);
        assert!(row("1 x", &mut Vec::new()).unwrap_err().contains("`x`"));
        assert!(row("1 -1", &mut Vec::new()).unwrap_err().contains("`-1`"));
    }
}
