//! Every citation of the theory in the sources leads somewhere in `firmware/THEORY.md`, and what
//! that says is implemented in a file is cited there.

use std::collections::BTreeSet;

use super::{read, regex, root, sources, table};

const THEORY: &str = "firmware/THEORY.md";

/// Something that can be cited, in the words of a citation.
type Anchor = String;

/// The text without what makes it a comment, so that a citation may go over the end of a line.
fn prose(source: &str) -> String {
    regex(r"\n\s*//[/!]?").replace_all(source, "\n").into_owned()
}

/// The numbers of "17 to 19", "6, 8 and 9".
fn numbers(list: &str) -> Vec<String> {
    let range = regex(r"^(\d+)\s+to\s+(\d+)$");
    if let Some(ends) = range.captures(list) {
        let [first, last] = [1, 2].map(|i| ends[i].parse::<u32>().expect("digits"));
        return (first..=last).map(|number| number.to_string()).collect();
    }
    regex(r"\d+(\.\d+)?").find_iter(list).map(|number| number.as_str().to_owned()).collect()
}

/// What a text cites. Sections without the word theory are the theory's, too.
fn citations(text: &str) -> Vec<Anchor> {
    let list = r"(\d+(?:\.\d+)?(?:(?:,\s*|\s+and\s+|\s+to\s+)\d+(?:\.\d+)?)*)";
    let mut found = Vec::new();
    for (kind, word) in [
        ("section", r"(?i)\bsections?\s+"),
        ("section", r"(?i)\btheory\s+"),
        ("equation", r"(?i)\b(?:equations?|conditions?)\s+"),
        ("step", r"(?i)\bsection\s+4,\s+step\s+"),
        ("item", r"(?i)\bsection\s+6,\s+item\s+"),
    ] {
        for cited in regex(&format!("{word}{list}")).captures_iter(text) {
            found.extend(numbers(&cited[1]).iter().map(|number| format!("{kind} {number}")));
        }
    }
    let assumption = regex(r"\bA(\d) of theory");
    found.extend(assumption.captures_iter(text).map(|cited| format!("assumption {}", &cited[1])));
    // Documents that are not here.
    let elsewhere = regex(r"\btheory-\w+|\btheory\.md");
    found.extend(elsewhere.find_iter(text).map(|cited| cited.as_str().to_owned()));
    found
}

/// What can be cited.
fn anchors(theory: &str) -> BTreeSet<Anchor> {
    let mut all = BTreeSet::new();
    let mut section = String::new();
    for line in theory.lines() {
        if let Some(heading) = regex(r"^##+ (\d+(?:\.\d+)?) ").captures(line) {
            heading[1].clone_into(&mut section);
            all.insert(format!("section {section}"));
        }
        if let Some(row) = regex(r"^\| (\d+) \|").captures(line) {
            all.insert(format!("equation {}", &row[1]));
        }
        if let Some(assumption) = regex(r"^(?:- )?\*\*A(\d)\*\*").captures(line) {
            all.insert(format!("assumption {}", &assumption[1]));
        }
        if let Some(step) = regex(r"^\*\*Step (\d)").captures(line).filter(|_| section == "4") {
            all.insert(format!("step {}", &step[1]));
        }
        if let Some(item) = regex(r"^(\d+)\. ").captures(line).filter(|_| section == "6") {
            all.insert(format!("item {}", &item[1]));
        }
    }
    all
}

/// The sources that cite the theory. The virtual board's cite the manuals of its chips.
fn cite_the_theory() -> Vec<(String, String)> {
    let mut all: Vec<_> = ["firmware", "analysis", "tests"].into_iter().flat_map(sources).collect();
    let is_this = |path: &str| path.ends_with("documents/theory.rs");
    all.retain(|(path, _)| !path.starts_with("analysis/virtual-board") && !is_this(path));
    for document in ["README.md", "firmware/boards.md", THEORY] {
        all.push((document.to_owned(), read(document)));
    }
    all
}

#[test]
fn every_citation_leads_somewhere() {
    let anchors = anchors(&read(THEORY));
    let (mut cited, mut dead) = (0, Vec::new());
    for (path, text) in cite_the_theory() {
        let mut all = citations(&prose(&text));
        cited += if path == THEORY { 0 } else { all.len() };
        all.retain(|cited| !anchors.contains(cited));
        dead.extend(all.iter().map(|to| format!("{path}: {to}")));
    }
    assert!(dead.is_empty(), "not in {THEORY}:\n{}", dead.join("\n"));
    assert!(cited > 150, "only {cited} citations were seen");
}

#[test]
fn a_citation_that_leads_nowhere_is_found() {
    let anchors = anchors(&read(THEORY));
    let text = "/// As it is (theory,\n    /// sections 4.1 and 4.7; equations 17 to 19, A9 of theory, \
                section 4, step 8).\n//! Theory 3.9, equation 99, and theory-lag, condition 18.";
    let mut dead = citations(&prose(text));
    dead.retain(|cited| !anchors.contains(cited));
    dead.sort();
    let all = ["assumption 9", "equation 99", "section 3.9", "section 4.7", "step 8", "theory-lag"];
    assert_eq!(dead, all);
}

/// A table that sends a reader to a file which does not know of the equation is no help.
#[test]
fn every_equation_is_cited_in_a_file_that_it_names() {
    let theory = read(THEORY);
    let rows = table(&theory, "## 11 Equations and files");
    assert_eq!(rows.len(), 71);
    for (i, row) in rows.iter().enumerate() {
        let number = (i + 1).to_string();
        assert_eq!(row[0], number, "equations are in order");
        let files = regex(r"[^\s,]+");
        let cites =
            |file: &str| citations(&prose(&read(file))).contains(&format!("equation {number}"));
        let last = row.last().expect("a cell");
        let is_cited = files.find_iter(last).any(|file| cites(file.as_str()));
        assert!(is_cited, "none of {last} cites equation {number}");
        let in_text = regex(&format!(r"\(equation {number}[,)]"));
        assert!(i < 27 || in_text.is_match(&theory), "equation {number} is only in the table");
    }
}

#[test]
fn every_file_that_it_names_exists() {
    let theory = read(THEORY);
    let paths = regex(r"`((?:firmware|analysis|tests)/[\w/.]+)`");
    let mut count = 0;
    for path in paths.captures_iter(&theory) {
        assert!(root().join(&path[1]).exists(), "there is no {}", &path[1]);
        count += 1;
    }
    assert!(count > 60, "only {count} files were seen");
}

#[test]
fn every_term_of_the_glossary_is_in_the_file_that_it_names() {
    let rows = table(&read(THEORY), "## 12 Glossary");
    // A row of its own names each group.
    let terms: Vec<_> = rows.iter().filter(|row| row.len() > 4 && !row[4].is_empty()).collect();
    assert!(terms.len() > 50, "only {} terms were seen", terms.len());
    for row in terms {
        let (names, files): (Vec<_>, Vec<_>) =
            row[4].split(", ").partition(|name| !name.contains('/'));
        assert!(!files.is_empty(), "{}: no file", row[0]);
        let texts: Vec<_> = files.iter().map(|file| read(file)).collect();
        for name in names {
            let is_there = regex(&format!(r"\b{name}\b"));
            let found = texts.iter().any(|text| is_there.is_match(text));
            assert!(found, "{}: there is no {name} in {files:?}", row[0]);
        }
    }
}
