//! The answer of a design: scenes that certify as they are written.

use std::io::{self, Write};
use std::path::Path;

use haptic_servo::scene::Coupling;
use serde::Serialize;

use super::Arguments;
use crate::chart::has_extension;
use crate::command::shared_arguments::{json, write as write_file};
use crate::command::status::{CommandError, CommandStatus};
use crate::design::{DesignLimit, SAMPLES};
use crate::file::{self, FileError, Format, SceneFile, write};
use crate::quantity::significant;

/// A result as JSON.
#[derive(Serialize)]
struct Report {
    quantity: &'static str,
    unit: &'static str,
    /// The last value that certifies; null if every value certifies, or none.
    value: Option<f64>,
    limited: bool,
    possible: bool,
    /// Other changes in the scenes.
    notes: Vec<String>,
    /// The scene that certifies; null if there are several, or none.
    scene: Option<serde_json::Value>,
    /// The scenes that certify, as TOML.
    scenes: Vec<String>,
}

/// The sought quantity: largest or smallest, its name, its unit.
pub(super) struct SoughtQuantity {
    pub which: &'static str,
    pub name: &'static str,
    pub unit: &'static str,
    pub note: Option<&'static str>,
}

impl SoughtQuantity {
    /// The result as a comment of TOML.
    fn comment(&self, found: &DesignLimit<Vec<SceneFile>>) -> String {
        let Self { which, name, unit, note } = self;
        let answer = match found {
            DesignLimit::Limit(value, _) => match (*unit, *value) {
                (SAMPLES, 1.0) => "1 sample".to_owned(),
                (SAMPLES, samples) => format!("{samples} {SAMPLES}"),
                ("", value) => value.to_string(),
                (unit, value) => last_that_certifies(value, unit),
            },
            DesignLimit::Unlimited(_) => "any value certifies".to_owned(),
            _ => "no value certifies".to_owned(),
        };
        let note = note.map_or_else(String::new, |note| format!("# {note}\n"));
        format!("# {which} {name}: {answer}\n{note}")
    }
}

/// Digits of a printed result.
const DIGITS: usize = 6;

/// A limit with few digits, and, if these are beyond it, the exact number.
fn last_that_certifies(value: f64, unit: &str) -> String {
    let short = significant(value, DIGITS);
    if short.parse() == Ok(value) {
        format!("{short} {unit}")
    } else {
        format!("{short} {unit} (the last number that certifies is {value:?})")
    }
}

/// A design's other changes of a scene, as text.
pub(super) fn changed(file: &SceneFile, designed: &SceneFile) -> Vec<String> {
    let stiffness = |file: &SceneFile| match file.scene.coupling {
        Coupling::Rigid | Coupling::Matched => None,
        Coupling::Spring { stiffness } => Some(stiffness),
    };
    let words = |stiffness: Option<f64>| {
        stiffness
            .map_or("a rigid one".to_owned(), |k| format!("{} N m/rad", significant(k, DIGITS)))
    };
    let (before, after) = (words(stiffness(file)), words(stiffness(designed)));
    let mut notes = Vec::new();
    if before != after {
        notes.push(format!(
            "{}: the coupling is {after}, the standard 2 delta/T; the file has {before}",
            file.name
        ));
    }
    let longest = |file: &SceneFile| file.scene.timing.worst_period;
    if let (Some(before), Some(after)) = (longest(file), longest(designed))
        && before != after
    {
        let (before, after) = (significant(before, DIGITS), significant(after, DIGITS));
        notes.push(format!("{}: worst_period is {after} s; the file has {before} s", file.name));
    }
    notes
}

/// Prints the result, and the scenes as files that can be certified unchanged, with the result as a comment.
/// Several scenes go into a folder.
pub(super) fn answer(
    arguments: &Arguments,
    sought: &SoughtQuantity,
    found: &DesignLimit<Vec<SceneFile>>,
    asked: &[SceneFile],
    note: Option<String>,
) -> Result<CommandStatus, CommandError> {
    let (value, files) = found.value_and_result();
    let files = files.map_or([].as_slice(), Vec::as_slice);
    let comment = sought.comment(found);
    let of_file = |(before, after)| note.iter().cloned().chain(changed(before, after)).collect();
    let notes: Vec<Vec<String>> = asked.iter().zip(files).map(of_file).collect();
    let remarks =
        |notes: &[String]| notes.iter().map(|note| format!("# note: {note}\n")).collect::<String>();
    let scenes: Vec<String> = files
        .iter()
        .zip(&notes)
        .map(|(file, notes)| format!("{comment}{}{}", remarks(notes), write::toml(file)))
        .collect();
    let possible = !scenes.is_empty();
    let notes = if possible { notes.concat() } else { note.into_iter().collect() };
    if let Some(output) = &arguments.output {
        save(output, &scenes)?;
    }
    let mut out = io::stdout().lock();
    if arguments.answer.json {
        let SoughtQuantity { name: quantity, unit, .. } = *sought;
        let scene = if let [file] = files { Some(object(file)?) } else { None };
        let limited = value.is_some();
        let report = Report { quantity, unit, value, limited, possible, notes, scene, scenes };
        json(&mut out, &report)?;
    } else if let ([scene], None) = (&scenes[..], &arguments.output) {
        write!(out, "{scene}")?;
    } else {
        write!(out, "{comment}{}", remarks(&notes))?;
        if scenes.len() > 1 && arguments.output.is_none() {
            writeln!(out, "# the {} scenes are written with --output FOLDER", scenes.len())?;
        }
    }
    out.flush()?;
    Ok(CommandStatus::of(possible))
}

/// The scene of a file as JSON, with the keys of a scene file.
pub(super) fn object(file: &SceneFile) -> Result<serde_json::Value, FileError> {
    file::as_json(&file.name, Format::Toml, &write::toml(file))
}

/// Writes one scene into a file of TOML, or each into a folder, as `design-1.toml` and so on.
fn save(output: &Path, texts: &[String]) -> Result<(), CommandError> {
    if let ([text], true) = (texts, has_extension(output, "toml")) {
        return write_file(output, text);
    }
    if texts.is_empty() {
        return Ok(());
    }
    std::fs::create_dir_all(output)?;
    for (index, text) in texts.iter().enumerate() {
        std::fs::write(output.join(format!("design-{}.toml", index + 1)), text)?;
    }
    Ok(())
}
