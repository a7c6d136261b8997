//! Tables of torque profiles that board and host both have: the request of a scene does not contain a table of
//! knots, but its index among these.

use haptic_servo::environment::{Knots, Profile, Shape};

/// Detents without ends, of any torque and number.
pub static DETENTS: Knots<16> = Knots::of(&[Shape::detents(24, 0.05)]);

/// Detents between end stops, as in the program `knob`: without ends, the knots' sum would be made zero.
pub static STOPPED: Knots<16> =
    Knots::of(&[Shape::detents(24, 0.05), Shape::end_stops(-2.618, 2.618, 15.0)]);

/// Detents and a magnet a turn, in 64 knots.
pub static MAGNET: Knots<64> = Knots::of(&[Shape::detents(4, 0.05), Shape::magnet(0.0, 0.3, 0.03)]);

const TABLES: [Profile; 3] =
    [Profile::of(&DETENTS, 1), Profile::of(&STOPPED, 1), Profile::of(&MAGNET, 1)];

/// The index of a profile's table; `None` for another table.
pub fn index_of(profile: &Profile) -> Option<usize> {
    TABLES.iter().position(|table| table.units() == profile.units())
}

/// A profile with the table of such an index.
pub fn from_index(index: usize) -> Option<Profile> {
    TABLES.get(index).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn detents_of_another_torque_and_number_have_the_same_table() {
        static OTHERS: Knots<16> = Knots::of(&[Shape::detents(120, 0.25)]);
        static KNOB: Knots<16> =
            Knots::of(&[Shape::detents(36, 0.01), Shape::end_stops(0.0, 9.0, 3.0)]);
        assert_eq!(index_of(&Profile::of(&OTHERS, 2)), Some(0));
        // By how its knots are rounded it has the one or the other table.
        assert_eq!(index_of(&Profile::of(&KNOB, 1)), Some(0));
        assert_eq!(index_of(&Profile::of(&STOPPED, 1)), Some(1));
        assert!(from_index(3).is_none());
    }
}
