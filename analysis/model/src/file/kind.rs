//! The types of environment, and which keys each takes.

use haptic_servo::environment::{
    Canceller, Coefficients, Environment, Knots, Parts, Profile, Rational, Shape, Side, Wall,
};

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

const WALL: Wall = Wall::damped(0.0, 0.0, 0);
const CANCELLER: Canceller = Canceller::to(0.0);

const BLANK: Environment =
    Environment::Rational(Rational { numerator: ZERO, denominator: ZERO, delay: 0, unit_zeros: 0 });

const fn kind(
    name: &'static str,
    doc: &'static str,
    needed: &'static [&'static Key],
    optional: &'static [&'static Key],
    blank: Environment,
) -> Kind {
    Kind { name, doc, needed, optional, blank, values: &[] }
}

/// All types, in the order of the documentation.
pub const ALL: &[Kind] = &[
    kind(
        "delayed-spring",
        "A spring without a damper.",
        &[&key::STIFFNESS, &key::DELAY_SAMPLES],
        &[],
        Wall::spring(0.0, 0).alone(),
    ),
    kind(
        "damper-wall",
        "A wall: spring and damper, everywhere or behind a face.",
        &[&key::STIFFNESS, &key::DAMPING, &key::DELAY_SAMPLES],
        OF_A_WALL,
        WALL.alone(),
    ),
    kind(
        "free-mode",
        "Free motion, with the device's own damping cancelled as far as the residual.",
        &[&key::RESIDUAL],
        &[&key::DELAY_SAMPLES],
        CANCELLER.alone(),
    ),
    Kind {
        values: &[(&key::STIFFNESS, "5.0"), (&key::DAMPING, "0.003")],
        ..kind(
            "free-mode-wall",
            "Free motion with a wall in it.",
            &[&key::RESIDUAL, &key::STIFFNESS, &key::DAMPING, &key::DELAY_SAMPLES],
            OF_A_WALL,
            Parts { canceller: Some(CANCELLER), wall: Some(WALL), ..Parts::NONE }.sum(),
        )
    },
    kind(
        "rational",
        "Any rational transfer function from position to torque.",
        &[&key::NUMERATOR, &key::DENOMINATOR],
        &[&key::DELAY_SAMPLES, &key::UNIT_ZEROS],
        BLANK,
    ),
    kind(
        SECTIONS,
        "A rational transfer function as a product of second-order sections.",
        &[&key::SECTIONS],
        &[&key::DELAY_SAMPLES],
        BLANK,
    ),
    kind(
        ZEROS_POLES_GAIN,
        "A rational transfer function by its zeros, its poles and a gain.",
        &[&key::ZEROS, &key::POLES, &key::GAIN],
        &[&key::DELAY_SAMPLES],
        BLANK,
    ),
    kind(
        PROFILE,
        "A torque profile: torque over angle in straight lines, for detents, end stops and textures.",
        &[&key::DELAY_SAMPLES],
        &[
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
        Profile::of(&DETENT, 1).alone(),
    ),
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

    /// The type that a file has for an environment, apart from the parts that may be beside every type; `None`
    /// for stated environments and for torque profiles.
    pub fn of(environment: &Environment) -> Option<&'static Self> {
        let parts = environment.parts();
        let Parts { canceller, wall, profile, .. } = parts;
        let name = match (canceller, wall, profile) {
            (None, None, None) if matches!(environment, Environment::Rational(_)) => "rational",
            // In a file, such a part stands beside a wall without stiffness.
            (None, None, None) if parts.count() > 0 => "damper-wall",
            (Some(_), None, None) => "free-mode",
            (Some(_), Some(_), None) => "free-mode-wall",
            // In a file, a spring with a face is a wall without damping.
            (None, Some(wall), None) => match (wall.damper, wall.side) {
                (None, Side::Centred | Side::Displaced(0.0)) => "delayed-spring",
                _ => "damper-wall",
            },
            _ => return None,
        };
        Self::find(name)
    }

    /// Its keys, first those that it must have.
    pub fn keys(&self) -> impl Iterator<Item = &'static Key> {
        let beside: &[&Key] =
            if matches!(self.blank, Environment::Parts(_)) { key::BESIDE } else { &[] };
        self.needed.iter().chain(self.optional).chain(beside).copied()
    }
}

/// The side of a wall by its keys: a face of 0 that it does not stop at is none.
pub const fn side(face: f64, one_sided: Option<bool>) -> Side {
    match one_sided {
        Some(true) => Side::Face(face),
        // By its bits: -0.0 is another number than 0.0.
        _ if face.to_bits() == 0 => Side::Centred,
        _ => Side::Displaced(face),
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
