//! Every relative link of every document leads to a file of the repository, and to a heading where it
//! names one. Lines of prose are short enough to be read beside code.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use super::{documents, regex, root};

/// The longest line of prose.
const COLUMNS: usize = 110;

/// Printed by `haptic schema --reference`, a paragraph a line.
const PRINTED: &str = "analysis/SCENE.md";

/// The lines outside of fenced blocks.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut is_code = false;
    text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// A heading as GitHub names it.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    let words: String = heading.chars().filter(kept).collect();
    words.trim().to_lowercase().replace(' ', "-")
}

/// A path without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                assert!(normal.pop(), "{} leaves the repository", path.display());
            }
            Component::CurDir => {}
            other => normal.push(other),
        }
    }
    normal
}

/// The fault of a link in a document; `None` if its target exists.
fn fault(documents: &BTreeMap<String, String>, document: &Path, link: &str) -> Option<String> {
    let (file, heading) = link.split_once('#').map_or((link, None), |(f, h)| (f, Some(h)));
    let target = match file {
        "" => document.to_owned(),
        _ => normal(&document.parent().expect("a folder").join(file)),
    };
    if !root().join(&target).exists() {
        return Some(format!("there is no {}", target.display()));
    }
    let heading = heading?;
    let Some(text) = documents.get(&*target.to_string_lossy()) else {
        return Some(format!("{} has no headings", target.display()));
    };
    let mut headings = prose(text).filter(|line| line.starts_with('#')).map(anchor);
    let is_there = headings.any(|there| there == heading);
    (!is_there).then(|| format!("{} has no heading #{heading}", target.display()))
}

#[test]
fn relative_links_lead_to_files_and_headings() {
    let documents = documents();
    let (mut count, mut dead) = (0, Vec::new());
    for (path, text) in &documents {
        let text: Vec<_> = prose(text).collect();
        for link in regex(r"\]\(([^)\s]+)\)").captures_iter(&text.join("\n")) {
            if link[1].contains("://") {
                continue;
            }
            count += 1;
            let fault = fault(&documents, Path::new(path), &link[1]);
            dead.extend(fault.map(|fault| format!("{path}: {fault}")));
        }
    }
    assert!(dead.is_empty(), "{}", dead.join("\n"));
    assert!(count > 100, "only {count} links were seen");
}

#[test]
fn a_link_that_leads_nowhere_is_found() {
    let documents = documents();
    let dead = |link| fault(&documents, Path::new("docs/build.md"), link).is_some();
    assert!(dead("boards.md") && dead("../firmware/boards.md#nowhere") && dead("#nowhere"));
    assert!(!dead("../firmware/boards.md#parts") && !dead("#a-program") && !dead("../tests"));
}

/// Tables and links cannot be broken.
#[test]
fn lines_of_prose_are_short() {
    let mut long = Vec::new();
    for (path, text) in documents() {
        if path == PRINTED {
            continue;
        }
        let lines = prose(&text).filter(|line| !line.starts_with('|') && !line.starts_with("!["));
        let too_long = lines.filter(|line| line.chars().count() > COLUMNS);
        long.extend(too_long.map(|line| format!("{path}: {line}")));
    }
    assert!(long.is_empty(), "longer than {COLUMNS}:\n{}", long.join("\n"));
}
