//! Whatever a file contains, it is read or refused with a place and a sentence, and nothing panics.

use proptest::prelude::*;

use super::example;
use crate::file::{self, Format};

const WALL: &str = r#"name = "wall"
device = { inertia = 2.2e-5, damping = 0.022 }
servo = { period = 0.001 }
coupling = { stiffness = 44.0 }
environment = { type = "damper-wall", stiffness = 22.0, damping = 0.01, delay = 1 }
"#;

/// A file with many keys and comments.
fn full() -> String {
    example::toml("free-mode-wall").expect("there is one of each type")
}

fn full_as_json() -> String {
    file::as_json("scene", Format::Toml, &full()).expect("an example is valid").to_string()
}

/// A scene file with a few pieces cut out, doubled, or written over.
fn mutated(text: String) -> impl Strategy<Value = String> {
    let edit = (any::<prop::sample::Index>(), 0..12_usize, ".{0,6}", any::<bool>());
    prop::collection::vec(edit, 1..6).prop_map(move |edits| {
        let mut characters: Vec<char> = text.chars().collect();
        for (at, length, new, doubles) in edits {
            let start = at.index(characters.len() + 1);
            let end = (start + length).min(characters.len());
            let old: String = characters[start..end].iter().collect();
            let new = if doubles { old.repeat(2) } else { new };
            characters.splice(start..end, new.chars());
        }
        characters.into_iter().collect()
    })
}

/// Reads a text in both formats and judges the scenes among them: nothing may panic.
fn survive(text: &str) {
    for format in [Format::Toml, Format::Json] {
        match file::parse("scene", format, text) {
            Ok(file) => drop(crate::verdict::judge(&file.name, &file.scene)),
            Err(error) => {
                assert!(error.line >= 1 && error.column >= 1);
                assert!(error.to_string().starts_with("scene:"));
                error.report(false);
            }
        }
    }
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,200}") {
        survive(&text);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        match file::text_of("scene", 1, &bytes) {
            Ok(text) => survive(text),
            Err(error) => prop_assert!(error.to_string().contains("UTF-8")),
        }
    }

    #[test]
    fn pieces_of_the_grammar_are_read_or_refused(
        pieces in prop::collection::vec(
            prop::sample::select(vec![
                "name", "=", "\"a\"", "[", "]", "[[", "]]", "{", "}", "device", ".", "inertia", "1", "-",
                "1e400", "nan", ",", ":", "\n", "environment", "type", "\"rational\"", "'", "\"\"\"", "\\u0000",
                "true", "null", "1979-05-27", "#", "\u{feff}", "é",
            ]),
            0..60,
        )
    ) {
        survive(&pieces.concat());
    }

    #[test]
    fn a_damaged_scene_is_read_or_refused(toml in mutated(full()), json in mutated(full_as_json())) {
        survive(&toml);
        survive(&json);
    }

    #[test]
    fn every_finite_number_is_read_as_it_is(value in any::<f64>().prop_filter("finite", |v| v.is_finite())) {
        let text = WALL.replace("stiffness = 22.0", &format!("stiffness = {value:?}"));
        let scene = file::parse("scene", Format::Toml, &text).unwrap().scene;
        let wall = scene.environment.wall().unwrap();
        prop_assert_eq!(wall.stiffness.to_bits(), value.to_bits());
        survive(&text);
    }
}
