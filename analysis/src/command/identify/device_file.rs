//! The measured device in a file that exists: of a device, or of a scene.

use std::f64::consts::TAU;
use std::path::Path;

use toml_edit::{DocumentMut, Item, TomlError, Value};

use crate::command::status::CommandError;
use crate::file::{self, Format};

/// The text of a file with this table `[device]` in place of its own.
///
/// # Errors
/// If the file is not valid, if it states another encoder than that of the record, or if it has no such table to
/// replace.
pub fn replaced(path: &Path, table: &str, counts_per_turn: f64) -> Result<String, CommandError> {
    let text = checked(path, counts_per_turn)?;
    let text = with_table(&text, table);
    let is_valid = |text: &String| is_valid(path, text);
    text.filter(is_valid).ok_or_else(|| {
        unchanged(path, "the file has no table [device] that could be replaced: name a new file")
    })
}

/// Checks that a file can take a measured device, or numbers of it, before a motor moves for minutes.
///
/// # Errors
/// As for [`replaced`], or for [`with_numbers`].
pub fn check(path: &Path, takes_numbers: bool, counts_per_turn: f64) -> Result<(), CommandError> {
    match takes_numbers {
        true => checked(path, counts_per_turn).map(drop),
        false => {
            replaced(path, "[device]\ninertia = 1.0\ndamping = 1.0\n", counts_per_turn).map(drop)
        }
    }
}

/// A number of a device's file.
pub struct Number {
    /// Its table.
    pub table: &'static str,
    /// Its key.
    pub key: &'static str,
    /// The number, or a list, as TOML.
    pub value: String,
    /// A comment behind it.
    pub comment: String,
}

/// The text of a file with these numbers in it, in place of its own.
///
/// # Errors
/// If the file is not valid, or if it states another encoder than that of the record.
pub fn with_numbers(
    path: &Path,
    numbers: &[Number],
    counts_per_turn: f64,
) -> Result<String, CommandError> {
    edited(path, &checked(path, counts_per_turn)?, numbers)
}

/// A text of this file with these numbers in it.
///
/// # Errors
/// If it is not TOML.
pub fn edited(path: &Path, text: &str, numbers: &[Number]) -> Result<String, CommandError> {
    let failed = |error: TomlError| unchanged(path, &error.to_string());
    let mut document: DocumentMut = text.parse().map_err(failed)?;
    for Number { table, key, value, comment } in numbers {
        let mut value: Value = value.parse().map_err(failed)?;
        let entry = document.entry(table).or_insert_with(toml_edit::table);
        let Some(of) = entry.as_table_like_mut() else {
            return Err(unchanged(path, &format!("`{table}` is not a table")));
        };
        // There is no comment within the braces of an inline table.
        let old = of.get(key).and_then(Item::as_value).map(|old| old.decor().clone());
        *value.decor_mut() = old.unwrap_or_default();
        if !entry.is_inline_table() && !comment.is_empty() {
            value.decor_mut().set_suffix(format!(" # {comment}"));
        }
        entry[key] = Item::Value(value);
    }
    Ok(document.to_string())
}

/// The text of a file with a device and the encoder of the record.
fn checked(path: &Path, counts_per_turn: f64) -> Result<String, CommandError> {
    let unreadable = |source| CommandError::Unwritable { path: path.to_owned(), source };
    let text = std::fs::read_to_string(path).map_err(unreadable)?;
    let document: Option<DocumentMut> = text.parse().ok();
    if let Some(device) = document.as_ref().and_then(|keys| keys.get("device")?.as_str()) {
        let why = format!("its device is that of `{device}`: name that file");
        return Err(unchanged(path, &why));
    }
    let step = file::load_device(&path.display().to_string())?.transducers.encoder_step;
    let stated = step.map(|step| (TAU / step).round());
    match stated.filter(|stated| (stated - counts_per_turn).abs() > 0.5) {
        Some(stated) => {
            let counts = format!("{stated} counts a turn, and the record is of {counts_per_turn}");
            Err(unchanged(path, &format!("the file states {counts}")))
        }
        None => Ok(text),
    }
}

fn is_valid(path: &Path, text: &str) -> bool {
    file::parse_device(&path.display().to_string(), Format::Toml, text).is_ok()
}

fn unchanged(path: &Path, why: &str) -> CommandError {
    CommandError::Failed(format!("{}: {why}; nothing was changed", path.display()).into())
}

/// The text with another table of the device, and with all but that table and its tables. A comment directly
/// above another table stays.
fn with_table(text: &str, table: &str) -> Option<String> {
    let is_table = |line: &&str| line.trim_start().starts_with('[');
    let is_device = |line: &&str| {
        let name = line.trim_start().trim_start_matches('[').trim_start();
        let rest = name.strip_prefix("device").map(str::trim_start);
        is_table(line) && rest.is_some_and(|rest| rest.starts_with([']', '.']))
    };
    let lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().position(is_device)?;
    let (before, old) = lines.split_at(first);
    let end = old.iter().position(|line| is_table(line) && !is_device(line)).unwrap_or(old.len());
    let (old, behind) = old.split_at(end);
    let comment = old.iter().rev().take_while(|line| line.trim_start().starts_with('#')).count();
    let kept = if behind.is_empty() { &[] } else { &old[old.len() - comment..] };
    let joined = |lines: &[&str]| lines.iter().flat_map(|line| [line, "\n"]).collect::<String>();
    let separator = if behind.is_empty() { "" } else { "\n" };
    Some(joined(before) + table + separator + &joined(kept) + &joined(behind))
}

#[cfg(test)]
mod tests {
    use super::with_table;

    #[test]
    fn only_the_table_of_the_device_is_replaced() {
        let text =
            "# Mine.\n[device]\ninertia = 1 # guessed\n\n# The motor.\n[limits]\nfull_scale = 2\n";
        let kept = "# Mine.\n[device]\nx = 2\n\n# The motor.\n[limits]\nfull_scale = 2\n";
        assert_eq!(with_table(text, "[device]\nx = 2\n").unwrap(), kept);
        assert_eq!(with_table(kept, "[device]\nx = 2\n").unwrap(), kept);
        let chain = "[limits]\n[ device ]\n[[device.mass]]\n# none\n[device.link]\n# none\n";
        assert_eq!(with_table(chain, "[device]\n").unwrap(), "[limits]\n[device]\n");
        assert_eq!(with_table("device.inertia = 2\n[devices]\n", ""), None);
    }
}
