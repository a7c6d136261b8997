//! Files with an error: each has its place, value and bound in the message. `refused.txt` has the cases.

use analysis::file::{self, FileError, Format};

use crate::cases::{alternatives, changed, fields, lines};

/// Reads a file of a device or of a scene; returns its error.
fn error(kind: &str, text: &str) -> Option<FileError> {
    match kind {
        "chain" | "device" => file::parse_device("x.toml", Format::Toml, text).err(),
        _ => file::parse("x.toml", Format::Toml, text).err(),
    }
}

#[test]
fn bad_files_are_named_with_place_value_and_bound() {
    let mut lines = lines(include_str!("refused.txt"));
    let (mut kind, mut base, mut count) = (String::new(), String::new(), 0);
    while let Some(line) = lines.next() {
        if let Some(name) = line.strip_prefix("base ") {
            kind = name.to_owned();
            base = lines.by_ref().take_while(|line| !line.is_empty()).map(|l| l + "\n").collect();
            continue;
        }
        for case in alternatives(&line).iter().filter(|case| !case.is_empty()) {
            let case = fields(case);
            let text = match base.contains('@') {
                true => base.replace('@', &case[1]),
                false => changed(&base, &case[1]),
            };
            let said = error(&kind, &text).map_or("read".to_owned(), |error| error.to_string());
            let place = match case[0].as_str() {
                "read" => "read".to_owned(),
                place => format!("x.toml:{place}: "),
            };
            assert!(said.starts_with(&place) && !said.contains('\n'), "{place} {said}\n{text}");
            case[2..].iter().for_each(|word| assert!(said.contains(word), "{word:?}: {said}"));
            count += 1;
        }
    }
    assert!(count > 190, "{count}");
}
