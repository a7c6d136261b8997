//! The modes of a knob as shapes and as tables: those that are known from open-source haptic knobs.

use core::f64::consts::TAU;

use super::mode_table::{ModeTable, ProfileMode};
use super::shape::Shape;

/// A mode of a knob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Its name.
    pub name: &'static str,
    /// The shapes whose sum it is; none for a freely turning knob.
    pub shapes: &'static [Shape],
}

/// All modes as shapes; [`KNOB_MODES`] are their tables.
pub const MODES: [Mode; 11] = [
    Mode { name: "unbounded", shapes: &[] },
    Mode { name: "bounded 0 to 10", shapes: &[Shape::end_stops(0.0, 10.0 * TENTH, STOP)] },
    Mode {
        name: "many turns, light detents",
        shapes: &[Shape::detents(36, 0.01), Shape::end_stops(0.0, 2.0 * TAU, STOP)],
    },
    Mode {
        name: "on and off",
        shapes: &[Shape::bistable(30.0 * DEGREE, 0.06), Shape::end_stops(-ON, ON, STOP)],
    },
    Mode { name: "return to centre", shapes: &[Shape::centre(60.0 * DEGREE, 0.05)] },
    Mode {
        name: "return to centre, with detents",
        shapes: &[Shape::centre(60.0 * DEGREE, 0.05), Shape::detents(24, 0.02)],
    },
    Mode { name: "fine steps", shapes: &[Shape::end_stops(0.0, 255.0 * DEGREE, STOP)] },
    Mode {
        name: "fine steps with detents",
        shapes: &[Shape::detents(360, 0.005), Shape::end_stops(0.0, 255.0 * DEGREE, STOP)],
    },
    Mode {
        name: "coarse steps, strong",
        shapes: &[Shape::detents(44, 0.08), Shape::end_stops(0.0, 31.0 / 44.0 * TAU, STOP)],
    },
    Mode {
        name: "coarse steps, weak",
        shapes: &[Shape::detents(44, 0.01), Shape::end_stops(0.0, 31.0 / 44.0 * TAU, STOP)],
    },
    Mode {
        name: "magnetic places",
        shapes: &[
            Shape::magnet(14.0 * DEGREE, MAGNET, 0.05),
            Shape::magnet(70.0 * DEGREE, MAGNET, 0.05),
            Shape::magnet(147.0 * DEGREE, MAGNET, 0.05),
            Shape::magnet(161.0 * DEGREE, MAGNET, 0.05),
            Shape::end_stops(0.0, 217.0 * DEGREE, STOP),
        ],
    },
];

macro_rules! tables {
    ($($mode:literal: $table:ident, $knots:literal;)*) => {
        $(static $table: ModeTable<$knots> = ModeTable::of(MODES[$mode].shapes);)*

        /// The tables of [`MODES`], by the same numbers: 1.5 KB of flash in a program that selects among
        /// them, and as much for their descriptions.
        pub static KNOB_MODES: [ProfileMode; MODES.len()] =
            [$($table.named(MODES[$mode].name)),*];
    };
}

// As many knots as the narrowest straight piece of each mode needs; the magnets' angles are not on knots.
tables! {
    0: UNBOUNDED, 8;
    1: BOUNDED, 8;
    2: LIGHT_DETENTS, 16;
    3: SWITCH, 64;
    4: CENTRE, 16;
    5: CENTRE_DETENTS, 64;
    6: FINE, 8;
    7: FINE_DETENTS, 16;
    8: COARSE_STRONG, 16;
    9: COARSE_WEAK, 16;
    10: MAGNETS, 512;
}

const DEGREE: f64 = TAU / 360.0;
/// A tenth of the range that a hand turns through without letting go.
const TENTH: f64 = 10.0 * DEGREE;
/// The end stop of a switch, beyond its two positions.
const ON: f64 = 42.0 * DEGREE;
/// The range of a magnet's pull.
const MAGNET: f64 = 6.0 * DEGREE;
/// Stiffness in N m/rad of the end stops.
const STOP: f64 = 15.0;

#[cfg(test)]
mod tests;
