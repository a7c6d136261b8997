//! Every fault and every kind of refusal has a section in `firmware/TROUBLESHOOTING.md`, found by
//! words that the program prints.

use super::protocol::{faults, variants};
use super::{read, regex, sources};

const DOCUMENT: &str = "firmware/TROUBLESHOOTING.md";

/// The kinds of refusals, and where they are.
const KINDS: [(&str, &str); 10] = [
    ("Rejection", "firmware/src/certificate/rejection.rs"),
    ("UndecidedReason", "firmware/src/passivity/poles.rs"),
    ("TimingError", "firmware/src/certificate/timed/mod.rs"),
    ("BuildError", "firmware/src/build_error.rs"),
    ("TuningError", "firmware/src/tuning/error.rs"),
    ("Refusal", "firmware/src/wire/message.rs"),
    ("LinkError", "analysis/client/src/error.rs"),
    ("StreamError", "analysis/client/src/stream.rs"),
    ("ServeError", "analysis/src/serve/mod.rs"),
    ("PageRefusal", "analysis/src/serve/refusal.rs"),
];

/// A section: its name, the words of the program, and the rest.
fn sections(document: &str) -> Vec<(String, String, String)> {
    let section = regex(r"(?m)^### `([^`]+)`\n\n> (.+)\n");
    let found: Vec<_> = section.captures_iter(document).collect();
    let text = |i: usize| {
        let start = found[i].get(0).expect("all of it").end();
        let end = found.get(i + 1).map_or(document.len(), |next| next.get(0).unwrap().start());
        document[start..end].to_owned()
    };
    let all = found.iter().enumerate();
    all.map(|(i, one)| (one[1].to_owned(), one[2].to_owned(), text(i))).collect()
}

#[test]
fn every_fault_and_every_kind_of_refusal_has_a_section() {
    let document = read(DOCUMENT);
    let mut wanted: Vec<_> =
        faults().into_iter().map(|(_, fault)| fault.as_str().to_owned()).collect();
    for (kind, path) in KINDS {
        let variants = variants(path, kind);
        assert!(variants.len() > 1, "{kind}: {variants:?}");
        wanted.extend(variants.into_iter().map(|(variant, _)| format!("{kind}::{variant}")));
    }
    let mut found: Vec<_> = sections(&document).into_iter().map(|(name, ..)| name).collect();
    assert_eq!(regex(r"(?m)^### ").find_iter(&document).count(), found.len());
    wanted.sort();
    found.sort();
    assert_eq!(found, wanted);
}

#[test]
fn every_section_has_a_cause_and_what_to_do() {
    for (name, _, text) in sections(&read(DOCUMENT)) {
        for part in ["**Cause.** ", "**Do.** "] {
            assert!(text.contains(part), "{name}: no {part}");
        }
    }
}

/// Users search for the message they see.
#[test]
fn the_words_that_are_quoted_are_those_of_the_program() {
    let continued = regex(r"\\\n\s+");
    let mut all = sources("firmware/src");
    for folder in ["analysis/client/src", "analysis/src/serve", "analysis/model/src/board"] {
        all.extend(sources(folder));
    }
    let all: Vec<_> = all.values().map(|text| continued.replace_all(text, "")).collect();
    for (name, words, _) in sections(&read(DOCUMENT)) {
        assert!(all.iter().any(|text| text.contains(&words)), "{name}: nothing says `{words}`");
    }
}
