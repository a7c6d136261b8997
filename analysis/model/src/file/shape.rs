//! The named shapes of a torque profile, and which keys each takes.

use haptic_servo::environment::Shape;

use super::key::{self, Key};

/// A type of shape.
#[derive(Debug)]
pub struct ShapeKind {
    /// Its name in the file.
    pub name: &'static str,
    /// Description.
    pub doc: &'static str,
    /// The keys that it must have besides `type`.
    pub needed: &'static [&'static Key],
    /// The keys that it may have.
    pub optional: &'static [&'static Key],
}

/// A row a type: its name and description; the shape that it makes; the fields that it must have, and those
/// that it may have, with their keys.
macro_rules! shapes {
    ($(
        $name:ident, $doc:literal, $shape:ident:
            {$($field:ident: $key:ident $(as $whole:ty)?),*} {$($more:ident: $optional:ident),*};
    )*) => {
        /// All types, in the order of the documentation.
        pub const ALL: &[ShapeKind] = &[
            $(ShapeKind {
                name: stringify!($name),
                doc: $doc,
                needed: &[$(&key::$key),*],
                optional: &[$(&key::$optional),*],
            },)*
            ShapeKind {
                name: TABLE,
                doc: "Straight lines through knots, as `environment.knots`.",
                needed: &[&key::SHAPE_KNOTS],
                optional: &[&key::SHAPE_PERIOD],
            },
        ];

        fn of_numbers(name: &str, number: impl Fn(&Key) -> f64) -> Option<Shape> {
            Some(match name {
                $(stringify!($name) => Shape::$shape {
                    $($field: number(&key::$key) $(as $whole)?,)*
                    $($more: number(&key::$optional),)*
                },)*
                _ => return None,
            })
        }

        fn numbers_of(shape: &Shape) -> (&'static str, Vec<(&'static Key, f64)>) {
            match *shape {
                $(Shape::$shape { $($field,)* $($more,)* } => (
                    stringify!($name),
                    vec![$((&key::$key, f64::from($field)),)* $((&key::$optional, $more),)*],
                ),)*
                _ => (TABLE, vec![]),
            }
        }
    };
}

shapes! {
    detents, "Places to rest at, evenly spaced over a turn.", SnapDetents:
        {count: SHAPE_COUNT as u32, torque: SHAPE_TORQUE} {centre: SHAPE_CENTRE, snap: SHAPE_SNAP};
    end_stops, "A spring beyond either of two angles.", EndStops:
        {from: SHAPE_FROM, to: SHAPE_TO, stiffness: SHAPE_STIFFNESS} {};
    centre, "A spring that pulls to zero, with end stops of its own stiffness at its width.", Centre:
        {width: SHAPE_WIDTH, stiffness: SHAPE_STIFFNESS} {};
    bistable, "Two places to rest at, a distance to either side of zero, and a snap between them.", Bistable:
        {distance: SHAPE_DISTANCE, torque: SHAPE_TORQUE} {};
    texture, "Ridges, to be felt rather than to rest at.", Texture:
        {pitch: SHAPE_PITCH, amplitude: SHAPE_AMPLITUDE} {};
    magnet, "A place that pulls from its width on, once a turn.", Magnet:
        {width: SHAPE_WIDTH, torque: SHAPE_TORQUE} {angle: SHAPE_ANGLE};
}

/// The type that has knots instead of numbers.
pub const TABLE: &str = "table";

impl ShapeKind {
    /// The type of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|kind| kind.name == name)
    }

    /// Its keys, first those that it must have.
    pub fn keys(&self) -> impl Iterator<Item = &'static Key> {
        self.needed.iter().chain(self.optional).copied()
    }

    /// The shape of this type with these numbers, 0 for a missing number; `None` for a table, which has knots
    /// instead.
    pub fn shape(&self, number: impl Fn(&Key) -> f64) -> Option<Shape> {
        Some(match of_numbers(self.name, number)? {
            Shape::SnapDetents { count, torque, centre, snap: 0.0 } => {
                Shape::Detents { count, torque, centre }
            }
            shape => shape,
        })
    }
}

/// The type of a shape, and its numbers by their keys; a table has knots instead.
pub fn written(shape: &Shape) -> (&'static str, Vec<(&'static Key, f64)>) {
    match *shape {
        Shape::Detents { count, torque, centre } => {
            let (name, mut numbers) =
                numbers_of(&Shape::SnapDetents { count, torque, centre, snap: 0.0 });
            numbers.retain(|(key, _)| **key != key::SHAPE_SNAP);
            (name, numbers)
        }
        Shape::Periodic(knots) => (TABLE, vec![(&key::SHAPE_PERIOD, span(knots))]),
        _ => {
            let (name, mut numbers) = numbers_of(shape);
            if matches!(shape, Shape::Magnet { .. }) {
                // Its angle comes first.
                numbers.rotate_right(1);
            }
            (name, numbers)
        }
    }
}

/// From the first knot to the last one in rad.
pub fn span(knots: &[(f64, f64)]) -> f64 {
    match knots {
        [(first, _), .., (last, _)] => last - first,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_is_in_the_sentence_and_every_key_of_a_shape_in_a_type() {
        for kind in ALL {
            assert!(key::SHAPE_TYPE.requirement().contains(&format!("\"{}\"", kind.name)));
        }
        for key in key::ALL.iter().filter(|key| key.table() == key::SHAPE.path) {
            let is_used = ALL.iter().any(|kind| kind.keys().any(|other| other == *key));
            assert!(is_used || **key == key::SHAPE_TYPE, "{}", key.path);
        }
    }
}
