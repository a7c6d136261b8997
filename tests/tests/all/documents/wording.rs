//! Text is plain technical English: a noun of the field in the place of a paraphrase.

use super::{files, regex};

/// Files with text.
const EXTENSIONS: [&str; 7] = ["css", "html", "js", "md", "py", "rs", "toml"];

/// Between two words of a comment: spaces, or the end of a line and the begin of the next.
const GAP: &str = r"(?:\s|//[/!]?|#|\*)+";

/// Paraphrases, by their first and second word.
const PARAPHRASES: [(&str, Option<&str>); 5] = [
    ("what", Some("is")),
    ("one", Some("that")),
    ("ones", Some("that")),
    ("whoever", None),
    ("somebody", None),
];

fn found(text: &str) -> Vec<String> {
    let word = |(first, second): (&str, Option<&str>)| {
        let rest = second.map(|second| format!("{GAP}{second}")).unwrap_or_default();
        regex(&format!(r"(?i)\b{first}{rest}\b"))
    };
    let hits = PARAPHRASES.into_iter().flat_map(|phrase| {
        word(phrase).find_iter(text).map(|hit| hit.as_str().to_owned()).collect::<Vec<_>>()
    });
    hits.collect()
}

#[test]
fn no_text_paraphrases() {
    let own = file!().rsplit('/').next().expect("a name");
    let mut seen = 0;
    for (path, text) in files("", &EXTENSIONS).iter().filter(|(path, _)| !path.ends_with(own)) {
        assert_eq!(found(text), [""; 0], "{path}");
        seen += 1;
    }
    assert!(seen > 500, "only {seen} files");
}

#[test]
fn paraphrases_are_found_over_line_ends_too() {
    let text =
        "/// The code; What\n/// is flashed. // One that runs. Somebody or // whoever: what it is.";
    assert_eq!(found(text), ["What\n/// is", "One that", "whoever", "Somebody"]);
}
