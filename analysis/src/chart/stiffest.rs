//! The stiffest certified wall at the handle over the rate, a curve for each structure.

use super::*;
use crate::design::stiffest::{Found, Structure, Wall};
use crate::quantity::significant;

/// Room above and below the curves, as a factor.
const ROOM: f64 = 1.3;

fn place(wall: &Wall) -> (f64, f64) {
    (wall.scene.timing.period.recip(), wall.felt)
}

/// Draws the curves of a search; a cross marks the wall that was found.
pub fn stiffest(title: &str, found: &Found) -> Result<Picture, ChartError> {
    let rates = span(found.walls.iter().map(|wall| place(wall).0));
    let felt = span(found.walls.iter().chain([&found.best]).map(|wall| wall.felt));
    if rates.start >= rates.end || felt.start <= 0.0 {
        return Err(ChartError::TooFewPoints);
    }
    let axes = Axes::new(
        (Axis::logarithmic(rates.start / ROOM..rates.end * ROOM), "rate (Hz)"),
        (Axis::logarithmic(felt.start / ROOM..felt.end * ROOM), "felt stiffness (N m/rad)"),
    );
    let is_there =
        |structure: &Structure| found.walls.iter().any(|wall| wall.structure == *structure);
    let structures = || Structure::ALL.into_iter().filter(is_there).enumerate();
    let curves = structures()
        .map(|(row, structure)| (Sample::Line(Stroke::of(row, 2)), structure.name().to_owned()));
    let (rate, stiffness) = place(&found.best);
    let [rate_in_words, stiffness_in_words] = [rate, stiffness].map(|value| significant(value, 3));
    let best = format!("found: {stiffness_in_words} N m/rad at {rate_in_words} Hz");
    let legends = vec![Legend::new(2, curves.chain([Legend::scene(true, &best)]))];
    Page { title, width: WIDTH, heights: &[HEIGHT], legends }.draw(|areas| {
        let panel = Panel::new(&areas[0], axes)?;
        for (row, structure) in structures() {
            let walls = found.walls.iter().filter(|wall| wall.structure == structure);
            panel.curve(Stroke::of(row, 2), walls.map(place))?;
        }
        panel.mark(Mark::SCENE, (rate, stiffness))
    })
}
