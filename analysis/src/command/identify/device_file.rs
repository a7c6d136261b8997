//! The measured device in a file that exists: of a device, or of a scene.

use std::f64::consts::TAU;
use std::path::Path;

use crate::command::status::CommandError;
use crate::file::{self, Format};

/// The text of a file with this table `[device]` in place of its own.
///
/// # Errors
/// If the file is not valid, if it states another encoder than that of the record, or if it has no such table to
/// replace.
pub fn replaced(path: &Path, table: &str, counts_per_turn: f64) -> Result<String, CommandError> {
    let name = path.display().to_string();
    let failed =
        |why: String| CommandError::Failed(format!("{name}: {why}; nothing was changed").into());
    let unreadable = |source| CommandError::Unwritable { path: path.to_owned(), source };
    let text = std::fs::read_to_string(path).map_err(unreadable)?;
    let step = file::load_device(&name)?.transducers.encoder_step;
    let stated = step.map(|step| (TAU / step).round());
    if let Some(stated) = stated.filter(|stated| (stated - counts_per_turn).abs() > 0.5) {
        let counts = format!("{stated} counts a turn, and the record is of {counts_per_turn}");
        return Err(failed(format!("the file states {counts}")));
    }
    let text = with_table(&text, table);
    text.filter(|text| file::parse_device(&name, Format::Toml, text).is_ok()).ok_or_else(|| {
        failed("the file has no table [device] that could be replaced: name a new file".into())
    })
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
