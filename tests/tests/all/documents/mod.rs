//! The documents and the code: what one says of the other is so.

mod architecture;
mod links;
mod protocol;
mod theory;
mod troubleshooting;
mod wording;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use regex::Regex;

/// The repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace is above").to_owned()
}

/// A file's text by its path in the repository.
fn read(path: &str) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All files below a folder of the repository with one of these extensions, by their paths in the repository,
/// with their text.
fn files(folder: &str, extensions: &[&str]) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the repository") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            let extension =
                path.extension().map(|extension| extension.to_string_lossy().into_owned());
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                folders.push(path);
            } else if extension.is_some_and(|extension| extensions.contains(&&*extension)) {
                let name = path.strip_prefix(root()).expect("below the root").display();
                found.insert(name.to_string(), fs::read_to_string(&path).expect("text"));
            }
        }
    }
    found
}

/// All Rust sources below a folder.
fn sources(folder: &str) -> BTreeMap<String, String> {
    files(folder, &["rs"])
}

/// All documents.
fn documents() -> BTreeMap<String, String> {
    files("", &["md"])
}

/// Each is compiled once: that takes longer than to search a file.
pub fn regex(pattern: &str) -> Regex {
    static COMPILED: Mutex<BTreeMap<String, Regex>> = Mutex::new(BTreeMap::new());
    let mut compiled = COMPILED.lock().expect("nobody panics below");
    let known = compiled.get(pattern).cloned();
    known.unwrap_or_else(|| {
        let new = Regex::new(pattern).expect("a regular expression");
        compiled.insert(pattern.to_owned(), new.clone());
        new
    })
}

/// The rows of the first table under a heading, cell by cell, without the quotes of code.
fn table(text: &str, heading: &str) -> Vec<Vec<String>> {
    let mut lines = text.lines().skip_while(|line| *line != heading);
    assert!(lines.next().is_some(), "there is no `{heading}`");
    let under = lines.take_while(|line| !line.starts_with('#'));
    let rows = under.skip_while(|line| !line.starts_with('|')).take_while(|l| l.starts_with('|'));
    let cells = |line: &str| {
        let cells = line.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().replace('`', "")).collect()
    };
    // Behind the names of the columns and the line under them.
    rows.skip(2).map(cells).collect()
}

/// A column of a table.
fn column(table: &[Vec<String>], number: usize) -> Vec<&str> {
    table.iter().map(|row| &*row[number]).collect()
}
