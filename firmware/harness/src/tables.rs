//! Tables of torque profiles that board and host both have: a table of knots does not go with the words of a
//! scene, but its place among these does.

use firmware::environment::{AnyProfile, Ends, Knots, Profile, Shape};

/// Detents, as scene files and the program `knob` have them.
pub static DETENTS: Knots<16> = Knots::of(&[Shape::detents(24, 0.05)]);

/// Detents and a magnet a turn, in 64 knots.
pub static MAGNET: Knots<64> = Knots::of(&[Shape::detents(4, 0.05), Shape::magnet(0.0, 0.3, 0.03)]);

const TABLES: [AnyProfile; 2] =
    [Profile::<16, 1>::of(&DETENTS).as_any(), Profile::<64, 1>::of(&MAGNET).as_any()];

/// The place of a profile's table, and whether it has ends; `None` for another table.
pub fn index_of(profile: &AnyProfile) -> Option<usize> {
    let is_same = |table: &AnyProfile| table.units() == profile.units();
    let index = TABLES.iter().position(is_same)?;
    Some(2 * index + usize::from(profile.ends.is_some()))
}

/// The profile of such a place, whose numbers are still to be set.
pub fn from_index(index: usize) -> Option<AnyProfile> {
    let mut profile = *TABLES.get(index / 2)?;
    profile.ends = (index % 2 == 1).then_some(Ends { from: 0.0, to: 0.0, stiffness: 0.0 });
    Some(profile)
}
