//! The map of torque profiles over their number of repetitions in a turn and their torque.

use super::*;
use crate::profile_curve::DetentLimits;

/// The line of the scene's own limit.
const OWN: Stroke = Stroke::solid(2);

#[derive(Clone, Debug, PartialEq)]
pub struct DetentMap {
    pub title: String,
    pub own: DetentLimits,
    pub others: Vec<DetentLimits>,
    /// Number of repetitions and torque of the scene itself.
    pub scene: (f64, f64),
    /// Range of the number of repetitions.
    pub counts: Range<f64>,
    /// Range of the torque in N m.
    pub torques: Range<f64>,
}

/// Draws a map: the certified region is white.
pub fn detents(map: &DetentMap) -> Result<Picture, ChartError> {
    if map.own.points.len() < 2 {
        return Err(ChartError::TooFewPoints);
    }
    let x = (Axis::linear(map.counts.clone()), "repetitions in a turn");
    let y = (Axis::linear(map.torques.clone()), "torque (N m)");
    let is_seen = x.0.holds(map.scene.0) && y.0.holds(map.scene.1);
    let legends = vec![Legend::new(1, legend(map, is_seen))];
    Page { title: &map.title, width: WIDTH, heights: &[HEIGHT], legends }.draw(|areas| {
        let mut panel = Panel::bare(&areas[0], Axes::new(x, y))?;
        let line = |limits: &DetentLimits| below(&limits.points, map.torques.end);
        let own = line(&map.own);
        if let (Some(first), Some(last)) = (own.first(), own.last()) {
            let above = [(last.0, map.torques.end), (first.0, map.torques.end)];
            panel.fill(FORBIDDEN, own.iter().copied().chain(above))?;
        }
        panel.grid()?;
        panel.curve(OWN, own)?;
        for (index, other) in map.others.iter().enumerate() {
            if !is_same(map, other) {
                panel.curve(Stroke::of(index + 1, 1), line(other))?;
            }
        }
        panel.mark(Mark::SCENE, map.scene)
    })
}

/// The part of a falling curve below a torque, from the crossing on.
fn below(points: &[(f64, f64)], most: f64) -> Vec<(f64, f64)> {
    let first = points.iter().position(|point| point.1 <= most).unwrap_or(points.len());
    let crossing = first.checked_sub(1).zip(points.get(first)).map(|(before, &(x, y))| {
        let (from, above) = points[before];
        (from + (x - from) * (above - most) / (above - y), most)
    });
    crossing.into_iter().chain(points[first..].iter().copied()).collect()
}

/// Whether another delay has the same limit, so that its line would hide in the other.
fn is_same(map: &DetentMap, other: &DetentLimits) -> bool {
    let mut pairs = map.own.points.iter().zip(&other.points);
    map.own.points.len() == other.points.len()
        && pairs.all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() <= 1e-3 * a.1)
}

fn legend(map: &DetentMap, is_seen: bool) -> Vec<(Sample, String)> {
    let largest = "largest torque that certifies with";
    let other = |(index, other): (usize, &DetentLimits)| match other.delay {
        delay if other.points.is_empty() => {
            (Sample::Nothing, format!("no torque certifies with a delay of {delay}"))
        }
        delay if is_same(map, other) => {
            (Sample::Line(OWN), format!("the same with a delay of {delay}"))
        }
        delay => (Sample::Line(Stroke::of(index + 1, 1)), format!("{largest} a delay of {delay}")),
    };
    let own = (Sample::Line(OWN), format!("{largest} the scene's delay, {}", map.own.delay));
    let not = (Sample::Region(Fill::Solid(FORBIDDEN)), "not certified".to_owned());
    let others = map.others.iter().enumerate().map(other);
    [own, not].into_iter().chain(others).chain([Legend::scene(is_seen, "the scene")]).collect()
}
