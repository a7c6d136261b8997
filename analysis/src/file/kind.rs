//! The types of environment, and which keys each takes.

use super::key::{self, Key};

/// A type of environment.
#[derive(Debug)]
pub struct Kind {
    /// Its name in the file.
    pub name: &'static str,
    /// What it is, in words.
    pub doc: &'static str,
    /// The keys that it must have besides `type`.
    pub needed: &'static [&'static Key],
    /// The keys that it may have.
    pub optional: &'static [&'static Key],
    /// Values of its example, where those of the keys' would not certify.
    pub values: &'static [(&'static Key, &'static str)],
}

/// What a wall may have besides stiffness, damping and delay. It must say its delay, because a delay
/// that is forgotten is one that is not accounted for.
const OF_A_WALL: &[&Key] = &[&key::FILTER, &key::FACE, &key::ONE_SIDED];

/// All types, in the order of the documentation.
pub const ALL: &[Kind] = &[
    Kind {
        name: "delayed-spring",
        doc: "A spring without a damper.",
        needed: &[&key::STIFFNESS, &key::DELAY_SAMPLES],
        optional: &[],
        values: &[],
    },
    Kind {
        name: "damper-wall",
        doc: "A wall: spring and damper, everywhere or behind a face.",
        needed: &[&key::STIFFNESS, &key::DAMPING, &key::DELAY_SAMPLES],
        optional: OF_A_WALL,
        values: &[],
    },
    Kind {
        name: "free-mode",
        doc: "Free motion, with the device's own damping cancelled as far as the residual.",
        needed: &[&key::RESIDUAL],
        optional: &[&key::DELAY_SAMPLES],
        values: &[],
    },
    Kind {
        name: "free-mode-wall",
        doc: "Free motion with a wall in it.",
        needed: &[&key::RESIDUAL, &key::STIFFNESS, &key::DAMPING, &key::DELAY_SAMPLES],
        optional: OF_A_WALL,
        values: &[(&key::STIFFNESS, "5.0"), (&key::DAMPING, "0.003")],
    },
    Kind {
        name: "rational",
        doc: "Any rational transfer function from position to torque.",
        needed: &[&key::NUMERATOR, &key::DENOMINATOR],
        optional: &[&key::DELAY_SAMPLES, &key::UNIT_ZEROS],
        values: &[],
    },
];

impl Kind {
    /// The type of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|kind| kind.name == name)
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
