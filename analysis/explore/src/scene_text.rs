//! Scenes as texts: read without a verdict, and written as a scene file.

use haptic_model::file::{self, FileError, Format, Problem, SceneFile, constant, write};
use serde::Serialize;
use serde_json::{Value, json};

use crate::PageResult;

/// The name of the text in the page's fields.
const NAME: &str = "scene";

/// The faults of a scene, each with its key and its place in the text.
#[derive(Debug, Serialize)]
pub struct Wrong {
    errors: Vec<WrongValue>,
}

/// An invalid value.
#[derive(Debug, Serialize)]
struct WrongValue {
    /// Full name with the numbers of lists; null: it belongs to no key.
    key: Option<String>,
    line: usize,
    column: usize,
    sentence: String,
}

impl Wrong {
    /// All faults.
    pub fn of(error: &FileError) -> Self {
        let each = std::iter::once(error).chain(&error.rest);
        let value = |error: &FileError| WrongValue {
            key: error.problem.key().map(ToOwned::to_owned),
            line: error.line,
            column: error.column,
            sentence: error.problem.to_string(),
        };
        Self { errors: each.map(value).collect() }
    }
}

/// The format of a text: JSON if it begins with a brace.
fn format(text: &str) -> Result<Format, FileError> {
    if text.len() as u64 > file::MAX_BYTES {
        return Err(FileError::whole(
            NAME,
            1,
            1,
            Problem::TooLong { part: "file", bound: file::MAX_BYTES },
        ));
    }
    Ok(Format::of(NAME, text))
}

/// The scene of a text.
pub fn read(text: &str) -> Result<SceneFile, FileError> {
    file::parse(NAME, format(text)?, text)
}

/// TOML or JSON: `{"scene": ..}` with all its keys, valid or not, or the error of its grammar. The page has the
/// period and the encoder's step as fields.
pub fn parse(text: &str, _: &mut Vec<f64>) -> PageResult {
    let scene = format(text).and_then(|format| file::as_json(NAME, format, text));
    let scene = scene.map(file::canonical);
    Ok(match scene {
        Ok(Value::Object(scene)) => json!({ "scene": scene }),
        Ok(_) => json!(Wrong::of(&FileError::whole(NAME, 1, 1, Problem::Empty))),
        Err(error) => json!(Wrong::of(&error)),
    }
    .to_string())
}

/// A scene as a scene file in TOML, which reads back with the same bits.
pub fn toml(text: &str, _: &mut Vec<f64>) -> PageResult {
    read(text).map(|file| write::toml(&file)).map_err(|error| error.to_string())
}

/// A scene as the constants of a program.
pub fn constant(text: &str, _: &mut Vec<f64>) -> PageResult {
    read(text).map_err(|error| error.to_string()).and_then(|file| constant::constants(&file))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;

    fn parsed(text: &str) -> Value {
        serde_json::from_str(&parse(text, &mut Vec::new()).unwrap()).unwrap()
    }

    #[test]
    fn what_is_written_reads_back_as_the_same_scene() {
        for preset in presets::ALL {
            let first = parsed(preset.toml)["scene"].to_string();
            let written = toml(&first, &mut Vec::new()).unwrap();
            assert_eq!(read(&written).unwrap(), read(preset.toml).unwrap(), "{}", preset.name);
        }
    }

    #[test]
    fn keys_and_values_that_mean_nothing_are_kept_and_what_has_no_grammar_is_named() {
        let rate = parsed("[servo]\nrate = 500\n");
        assert_eq!(rate["scene"], json!({ "servo": { "period": 0.002 } }));
        let text = "wrong = 1\n[device]\ninertia = \"heavy\"\n";
        let scene = json!({ "wrong": 1.0, "device": { "inertia": "heavy" } });
        assert_eq!(parsed(text)["scene"], scene);
        let error = &parsed("[device]\ninertia = = 1\n")["errors"][0];
        assert_eq!((&error["line"], &error["key"]), (&json!(2), &Value::Null));
        for text in ["[1, 2]", "", "{}", "{\"a\": [1, 2}"] {
            assert!(parsed(text)["errors"][0]["sentence"].is_string(), "{text}");
        }
    }
}
