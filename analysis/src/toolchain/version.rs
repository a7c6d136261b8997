//! Versions by their first two numbers.

use std::fmt;

/// The first two numbers of a version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version {
    /// The first number.
    pub major: u32,
    /// The second number; 0 if there is none.
    pub minor: u32,
}

impl Version {
    /// The oldest compiler that builds the workspace (`rust-version` in its Cargo.toml).
    pub const RUST: Self = Self { major: 1, minor: 95 };
    /// The oldest emulator with which the board was tested.
    pub const QEMU: Self = Self { major: 7, minor: 2 };

    /// The version in a line such as `rustc 1.96.0 (ac68faa20 2026-05-25)`, or of a package such as
    /// `1:7.2+dfsg-7+deb12u18`: the first word that begins with a number and a point.
    pub fn find(text: &str) -> Option<Self> {
        text.split_whitespace().find_map(Self::of_word)
    }

    fn of_word(word: &str) -> Option<Self> {
        // Debian writes an epoch before a colon.
        let word = word.rsplit_once(':').map_or(word, |(_, version)| version);
        let (major, rest) = word.split_once('.')?;
        let minor = rest.split(|c: char| !c.is_ascii_digit()).next()?;
        Some(Self { major: major.parse().ok()?, minor: minor.parse().unwrap_or(0) })
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.major, self.minor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_found_in_what_programs_print() {
        let cases = [
            ("rustc 1.96.0 (ac68faa20 2026-05-25) (built from a source tarball)", Some((1, 96))),
            ("QEMU emulator version 7.2.22 (Debian 1:7.2+dfsg-7+deb12u18+b3)", Some((7, 2))),
            ("QEMU emulator version 10.0.2", Some((10, 0))),
            ("1:7.2+dfsg-7+deb12u18+b3", Some((7, 2))),
            ("1.85.0+dfsg3-1~deb12u3", Some((1, 85))),
            ("1:14.0-55.7~deb12u1", Some((14, 0))),
            ("(none)", None),
            ("", None),
            ("..", None),
        ];
        for (text, expected) in cases {
            let expected = expected.map(|(major, minor)| Version { major, minor });
            assert_eq!(Version::find(text), expected, "{text}");
        }
    }

    #[test]
    fn ten_is_later_than_seven() {
        assert!(Version { major: 10, minor: 0 } > Version::QEMU);
        assert!(Version { major: 1, minor: 85 } < Version::RUST);
    }
}
