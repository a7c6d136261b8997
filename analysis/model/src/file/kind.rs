//! The types of environment, and which keys each takes.

use haptic_servo::environment::{Coefficients, Environment, Knots, Profile, Rational, Shape, Wall};

use super::key::{self, Key};

/// A type of environment.
#[derive(Debug)]
pub struct Kind {
    /// Its name in the file.
    pub name: &'static str,
    /// Description.
    pub doc: &'static str,
    /// The keys that it must have besides `type`.
    pub needed: &'static [&'static Key],
    /// The keys that it may have.
    pub optional: &'static [&'static Key],
    /// The environment before its numbers are set.
    pub blank: Environment,
    /// Values of its example, where the keys' own examples would not certify.
    pub values: &'static [(&'static Key, &'static str)],
}

/// The optional keys of a wall besides stiffness, damping and delay. The delay is required, because a
/// forgotten delay is not accounted for.
const OF_A_WALL: &[&Key] = &[&key::FILTER, &key::FACE, &key::ONE_SIDED];

const ZERO: Coefficients = match Coefficients::new(&[0.0]) {
    Some(zero) => zero,
    None => panic!("one coefficient fits"),
};

const BLANK: Environment =
    Environment::Rational(Rational { numerator: ZERO, denominator: ZERO, delay: 0, unit_zeros: 0 });

/// All types, in the order of the documentation.
pub const ALL: &[Kind] = &[
    Kind {
        name: "delayed-spring",
        doc: "A spring without a damper.",
        needed: &[&key::STIFFNESS, &key::DELAY_SAMPLES],
        optional: &[],
        blank: Environment::DelayedSpring(Wall::spring(0.0, 0)),
        values: &[],
    },
    Kind {
        name: "damper-wall",
        doc: "A wall: spring and damper, everywhere or behind a face.",
        needed: &[&key::STIFFNESS, &key::DAMPING, &key::DELAY_SAMPLES],
        optional: OF_A_WALL,
        blank: Environment::DamperWall(Wall::spring(0.0, 0)),
        values: &[],
    },
    Kind {
        name: "free-mode",
        doc: "Free motion, with the device's own damping cancelled as far as the residual.",
        needed: &[&key::RESIDUAL],
        optional: &[&key::DELAY_SAMPLES],
        blank: Environment::FreeMode { residual: 0.0, delay: 0 },
        values: &[],
    },
    Kind {
        name: "free-mode-wall",
        doc: "Free motion with a wall in it.",
        needed: &[&key::RESIDUAL, &key::STIFFNESS, &key::DAMPING, &key::DELAY_SAMPLES],
        optional: OF_A_WALL,
        blank: Environment::FreeModeWall { residual: 0.0, wall: Wall::spring(0.0, 0) },
        values: &[(&key::STIFFNESS, "5.0"), (&key::DAMPING, "0.003")],
    },
    Kind {
        name: "rational",
        doc: "Any rational transfer function from position to torque.",
        needed: &[&key::NUMERATOR, &key::DENOMINATOR],
        optional: &[&key::DELAY_SAMPLES, &key::UNIT_ZEROS],
        blank: BLANK,
        values: &[],
    },
    Kind {
        name: SECTIONS,
        doc: "A rational transfer function as a product of second-order sections.",
        needed: &[&key::SECTIONS],
        optional: &[&key::DELAY_SAMPLES],
        blank: BLANK,
        values: &[],
    },
    Kind {
        name: ZEROS_POLES_GAIN,
        doc: "A rational transfer function by its zeros, its poles and a gain.",
        needed: &[&key::ZEROS, &key::POLES, &key::GAIN],
        optional: &[&key::DELAY_SAMPLES],
        blank: BLANK,
        values: &[],
    },
    Kind {
        name: PROFILE,
        doc: "A torque profile: torque over angle in straight lines, for detents, end stops and textures.",
        needed: &[&key::DELAY_SAMPLES],
        optional: &[
            &key::DAMPING,
            &key::KNOTS,
            &key::KNOTS_PERIOD,
            &key::PROFILE_TORQUE,
            &key::COUNT,
            &key::CENTRE,
            &key::FROM,
            &key::TO,
            &key::STIFFNESS,
            &key::CELLS,
            &key::RESIDUAL,
            &key::WALL,
            &key::SHAPE,
        ],
        blank: Environment::Profile(Profile::<16, 1>::of(&DETENT).as_any()),
        values: &[],
    },
];

/// The type of second-order sections.
pub const SECTIONS: &str = "sections";
/// The type of zeros, poles and gain.
pub const ZEROS_POLES_GAIN: &str = "zeros-poles-gain";
/// The type with shapes.
pub const PROFILE: &str = "profile";

static DETENT: Knots<16> = Knots::of(&[Shape::detents(1, 1.0)]);

impl Kind {
    /// The type of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|kind| kind.name == name)
    }

    /// The type that a file has for an environment; `None` for stated environments and for torque profiles.
    pub fn of(environment: &Environment) -> Option<&'static Self> {
        let name = match environment {
            // In a file, a spring with a face is a wall without damping.
            Environment::DelayedSpring(Wall { one_sided: false, face: 0.0, .. }) => {
                "delayed-spring"
            }
            Environment::DelayedSpring(_) | Environment::DamperWall(_) => "damper-wall",
            Environment::FreeMode { .. } => "free-mode",
            Environment::FreeModeWall { .. } => "free-mode-wall",
            Environment::Rational(_) => "rational",
            Environment::Stated(_) | Environment::Profile(_) | Environment::Composed(_) => {
                return None;
            }
        };
        Self::find(name)
    }

    /// Its keys, first those that it must have.
    pub fn keys(&self) -> impl Iterator<Item = &'static Key> {
        self.needed.iter().chain(self.optional).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_is_in_the_sentence_and_every_key_of_an_environment_in_a_type() {
        for kind in ALL {
            assert!(key::TYPE.requirement().contains(&format!("\"{}\"", kind.name)));
        }
        for key in key::ALL.iter().filter(|key| key.table() == "environment") {
            let is_used = ALL.iter().any(|kind| kind.keys().any(|other| other == *key));
            assert!(is_used || **key == key::TYPE, "{}", key.path);
        }
    }
}
