//! The legend below a Nyquist plot.

use super::super::legend::Sample;
use super::{BOUND, CRITICAL, Line, NyquistScene, lines};
use crate::nyquist::{critical_lines, words};
use crate::quantity::{shortened, significant};

/// Longest name in the legend, in letters.
const LONGEST_NAME: usize = 48;

/// Of each scene its curves and its bound, of which only the first line of words has a sample; then the lines
/// that are not to be crossed.
pub(super) fn entries(scenes: &[NyquistScene]) -> impl Iterator<Item = (Sample, String)> {
    let is_single = scenes.len() == 1;
    let of = |(index, (scene, lines)): (usize, (&NyquistScene, Vec<Line<'_>>))| {
        let name = match is_single {
            true => String::new(),
            false => format!("{}: {}: ", index + 1, shortened(&scene.name, LONGEST_NAME)),
        };
        let curves = lines.into_iter().map(|(stroke, curve)| {
            (Sample::Line(stroke), words::curve(&name, scene, curve, is_single))
        });
        let sample = scene.bound.map_or(Sample::Nothing, |_| Sample::Line(BOUND));
        let bound = words::bound(&name, scene).map(|words| (sample, words));
        curves.chain(bound).collect::<Vec<_>>()
    };
    let mut entries: Vec<_> = scenes.iter().zip(lines(scenes)).enumerate().flat_map(of).collect();
    if let Some(first) = entries.first_mut().filter(|_| is_single) {
        first.1.insert(0, words::HALVES.to_owned());
    }
    let rows = entries.into_iter().flat_map(|(sample, words)| {
        let samples = std::iter::once(sample).chain(std::iter::repeat(Sample::Nothing));
        samples.zip(words)
    });
    let critical = |(line, name): (f64, &str)| {
        (Sample::Line(CRITICAL), format!("critical line, {name} = {}", significant(line, 4)))
    };
    rows.chain(critical_lines(scenes).into_iter().map(critical))
}
