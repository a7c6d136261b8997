//! An axis: its scale, its ticks and the number format of their labels.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;

use crate::quantity::rounded;

/// Plain digits end here.
const LONG: f64 = 1e7;
/// With fewer decades than this on an axis, 2 and 5 times a power of ten are also ticks.
const FEW: f64 = 3.0;

/// An axis. All labels of an axis have plain digits, or all have an exponent.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its name with its unit; empty if it shares the axis of the panel below.
    pub name: &'static str,
    range: Range<f64>,
    is_logarithmic: bool,
    digits: usize,
    /// A number with a smaller magnitude is a zero with a rounding error.
    zero: f64,
    is_plain: bool,
}

impl Axis {
    /// A linear axis; its labels have enough digits to distinguish them.
    pub fn linear(range: Range<f64>, name: &'static str) -> Self {
        let width = (range.end - range.start).abs();
        let largest = range.start.abs().max(range.end.abs());
        let digits = ((largest / width).log10().ceil() as usize + 2).clamp(4, 17);
        let is_plain = (1e-3..LONG).contains(&largest);
        Self { name, range, is_logarithmic: false, digits, zero: 1e-9 * width, is_plain }
    }

    pub fn logarithmic(range: Range<f64>, name: &'static str) -> Self {
        let is_plain = range.start >= 1e-4 && range.end < LONG;
        Self { name, range, is_logarithmic: true, digits: 4, zero: 0.0, is_plain }
    }

    /// The part of the axis below a value: 0 at its start, 1 at its end.
    pub fn part(&self, value: f64) -> f64 {
        let Range { start, end } = self.range;
        match self.is_logarithmic {
            true => (value / start).ln() / (end / start).ln(),
            false => (value - start) / (end - start),
        }
    }

    /// Whether a value is between its ends, or is one of them.
    pub fn holds(&self, value: f64) -> bool {
        self.range.start <= value && value <= self.range.end
    }

    /// Powers of ten, and if there are few also their multiples.
    fn decades(&self, most: usize) -> Vec<f64> {
        let [first, last] = [self.range.start, self.range.end].map(f64::log10);
        let multiples: &[f64] = if last - first < FEW { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let step = ((last - first) / most as f64).ceil().max(1.0) as i32;
        // Whole multiples of the step, so that 1 is among them.
        let first = (first.floor() as i32).div_euclid(step) * step;
        let decades = (first..=last.ceil() as i32).step_by(step as usize);
        let values =
            decades.flat_map(|decade| multiples.iter().map(move |m| m * 10_f64.powi(decade)));
        values.filter(|value| self.holds(*value)).collect()
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + (self.part(*value) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match self.is_logarithmic {
            // There are no lines between the ticks.
            _ if hint.weight().allow_light_points() => Vec::new(),
            true => self.decades(hint.max_num_points()),
            false => RangedCoordf64::from(self.range.clone()).key_points(hint),
        }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        let nearest = rounded(*value, self.digits);
        match self.is_plain {
            _ if value.abs() <= self.zero => "0".to_owned(),
            true => format!("{nearest}"),
            false => format!("{nearest:e}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use plotters::coord::ranged1d::BoldPoints;

    use super::*;

    fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
        values.iter().map(|value| axis.format_ext(value)).collect()
    }

    #[test]
    fn ticks_are_told_apart_however_small_the_numbers_or_their_range() {
        let small = Axis::linear(-3e-12..3e-12, "");
        assert_eq!(labels(&small, &[1e-12, 2e-12, 1e-28]), ["1e-12", "2e-12", "0"]);
        let narrow = labels(&Axis::linear(0.2..0.200_004, ""), &[0.200_001, 0.200_002]);
        assert_ne!(narrow[0], narrow[1]);
        assert_eq!(labels(&Axis::linear(0.0..45.0, ""), &[3.0 * 0.1]), ["0.3"]);
    }

    #[test]
    fn an_axis_writes_all_its_numbers_alike() {
        let wide = Axis::logarithmic(3.0..3e7, "");
        assert_eq!(labels(&wide, &wide.key_points(BoldPoints(9)))[..2], ["1e1", "1e2"]);
        assert_eq!(labels(&Axis::logarithmic(3.0..3e6, ""), &[10.0, 1e6]), ["10", "1000000"]);
        assert_eq!(labels(&Axis::logarithmic(1e-5..1.0, ""), &[1e-5, 0.1]), ["1e-5", "1e-1"]);
        let small = Axis::linear(0.0..2e-4, "");
        assert_eq!(labels(&small, &[0.0, 5e-5, 1.5e-4]), ["0", "5e-5", "1.5e-4"]);
        let large = Axis::linear(0.0..2e7, "");
        assert_eq!(labels(&large, &[5e6, 1e7, 1.5e7]), ["5e6", "1e7", "1.5e7"]);
    }

    #[test]
    fn a_logarithmic_axis_has_ticks_enough_to_read_it_and_no_more() {
        let ticks = |range, most| Axis::logarithmic(range, "").key_points(BoldPoints(most));
        assert_eq!(ticks(3.0..70.0, 9), [5.0, 10.0, 20.0, 50.0]);
        assert_eq!(ticks(1.0..1e4, 9), [1.0, 10.0, 100.0, 1e3, 1e4]);
        assert!((2..=9).contains(&ticks(1e-300..1e300, 9).len()));
    }
}
