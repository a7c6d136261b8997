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

/// All types, in the order of the documentation.
pub const ALL: &[ShapeKind] = &[
    ShapeKind {
        name: "detents",
        doc: "Places to rest at, evenly spaced over a turn.",
        needed: &[&key::SHAPE_COUNT, &key::SHAPE_TORQUE],
        optional: &[&key::SHAPE_CENTRE, &key::SHAPE_SNAP],
    },
    ShapeKind {
        name: "end_stops",
        doc: "A spring beyond either of two angles.",
        needed: &[&key::SHAPE_FROM, &key::SHAPE_TO, &key::SHAPE_STIFFNESS],
        optional: &[],
    },
    ShapeKind {
        name: "centre",
        doc: "A spring that pulls to zero, with end stops of its own stiffness at its width.",
        needed: &[&key::SHAPE_WIDTH, &key::SHAPE_STIFFNESS],
        optional: &[],
    },
    ShapeKind {
        name: "bistable",
        doc: "Two places to rest at, a distance to either side of zero, and a snap between them.",
        needed: &[&key::SHAPE_DISTANCE, &key::SHAPE_TORQUE],
        optional: &[],
    },
    ShapeKind {
        name: "texture",
        doc: "Ridges, to be felt rather than to rest at.",
        needed: &[&key::SHAPE_PITCH, &key::SHAPE_AMPLITUDE],
        optional: &[],
    },
    ShapeKind {
        name: "magnet",
        doc: "A place that pulls from its width on, once a turn.",
        needed: &[&key::SHAPE_WIDTH, &key::SHAPE_TORQUE],
        optional: &[&key::SHAPE_ANGLE],
    },
    ShapeKind {
        name: TABLE,
        doc: "Straight lines through knots, as `environment.knots`.",
        needed: &[&key::SHAPE_KNOTS],
        optional: &[&key::SHAPE_PERIOD],
    },
];

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
        let torque = || number(&key::SHAPE_TORQUE);
        Some(match self.name {
            "detents" => {
                let count = number(&key::SHAPE_COUNT) as u32;
                let detents =
                    Shape::Detents { count, torque: torque(), centre: number(&key::SHAPE_CENTRE) };
                let snap = number(&key::SHAPE_SNAP);
                if snap == 0.0 { detents } else { detents.snap(snap) }
            }
            "end_stops" => Shape::EndStops {
                from: number(&key::SHAPE_FROM),
                to: number(&key::SHAPE_TO),
                stiffness: number(&key::SHAPE_STIFFNESS),
            },
            "centre" => Shape::Centre {
                width: number(&key::SHAPE_WIDTH),
                stiffness: number(&key::SHAPE_STIFFNESS),
            },
            "bistable" => {
                Shape::Bistable { distance: number(&key::SHAPE_DISTANCE), torque: torque() }
            }
            "texture" => Shape::Texture {
                pitch: number(&key::SHAPE_PITCH),
                amplitude: number(&key::SHAPE_AMPLITUDE),
            },
            "magnet" => Shape::Magnet {
                angle: number(&key::SHAPE_ANGLE),
                width: number(&key::SHAPE_WIDTH),
                torque: torque(),
            },
            _ => return None,
        })
    }
}

/// The type of a shape, and its numbers by their keys; a table has knots instead.
pub fn written(shape: &Shape) -> (&'static str, Vec<(&'static Key, f64)>) {
    match *shape {
        Shape::Detents { count, torque, centre } => (
            "detents",
            vec![
                (&key::SHAPE_COUNT, f64::from(count)),
                (&key::SHAPE_TORQUE, torque),
                (&key::SHAPE_CENTRE, centre),
            ],
        ),
        Shape::SnapDetents { count, torque, centre, snap } => (
            "detents",
            vec![
                (&key::SHAPE_COUNT, f64::from(count)),
                (&key::SHAPE_TORQUE, torque),
                (&key::SHAPE_CENTRE, centre),
                (&key::SHAPE_SNAP, snap),
            ],
        ),
        Shape::EndStops { from, to, stiffness } => (
            "end_stops",
            vec![
                (&key::SHAPE_FROM, from),
                (&key::SHAPE_TO, to),
                (&key::SHAPE_STIFFNESS, stiffness),
            ],
        ),
        Shape::Centre { width, stiffness } => {
            ("centre", vec![(&key::SHAPE_WIDTH, width), (&key::SHAPE_STIFFNESS, stiffness)])
        }
        Shape::Bistable { distance, torque } => {
            ("bistable", vec![(&key::SHAPE_DISTANCE, distance), (&key::SHAPE_TORQUE, torque)])
        }
        Shape::Texture { pitch, amplitude } => {
            ("texture", vec![(&key::SHAPE_PITCH, pitch), (&key::SHAPE_AMPLITUDE, amplitude)])
        }
        Shape::Magnet { angle, width, torque } => (
            "magnet",
            vec![
                (&key::SHAPE_ANGLE, angle),
                (&key::SHAPE_WIDTH, width),
                (&key::SHAPE_TORQUE, torque),
            ],
        ),
        Shape::Table(_) => (TABLE, vec![]),
        Shape::Periodic(knots) => (TABLE, vec![(&key::SHAPE_PERIOD, span(knots))]),
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

    #[test]
    fn what_is_written_of_a_shape_is_what_it_is_read_from() {
        for kind in ALL.iter().filter(|kind| kind.name != TABLE) {
            let shape = kind.shape(|key| key.name().len() as f64).unwrap();
            let (name, numbers) = written(&shape);
            assert_eq!(name, kind.name);
            assert_eq!(numbers.len(), kind.keys().count(), "{name}");
            for (key, value) in numbers {
                assert_eq!(value, key.name().len() as f64, "{}", key.path);
            }
        }
    }
}
