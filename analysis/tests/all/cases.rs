//! Cases that are written in text files, a line each, with short forms for what repeats.

/// The lines of a file of cases without its comments. `NAME := TEXT` names a text, for the lines below.
pub fn lines(text: &str) -> impl Iterator<Item = String> {
    let mut names: Vec<(&str, String)> = Vec::new();
    text.lines().filter(|line| !line.starts_with('#')).filter_map(move |line| {
        let (name, text) = line.split_once(" := ").unwrap_or(("", line));
        let text = names.iter().fold(text.to_owned(), |text, (name, is)| text.replace(name, is));
        if name.is_empty() {
            return Some(text);
        }
        names.push((name, text));
        None
    })
}

/// A line for each of its alternatives: `<a,b>` is `a` in one and `b` in the other, and `<>` is the same
/// again.
pub fn alternatives(line: &str) -> Vec<String> {
    let mut groups = line.match_indices('<').filter_map(|(start, _)| {
        let (group, _) = line[start + 1..].split_once('>')?;
        (group.contains(',') && !group.contains('<')).then_some(group)
    });
    let Some(group) = groups.next() else { return vec![line.to_owned()] };
    let with = |one: &str| line.replacen(&format!("<{group}>"), one, 1).replace("<>", one);
    group.split(',').flat_map(|one| alternatives(&with(one))).collect()
}

/// The fields of a case, which ` | ` separates; `\n` is a new line.
pub fn fields(case: &str) -> Vec<String> {
    case.split(" | ").map(|field| field.replace("\\n", "\n")).collect()
}

/// A text with changes, `FROM => TO && FROM => TO`, each at the first place.
pub fn changed(text: &str, changes: &str) -> String {
    changes.split(" && ").fold(text.to_owned(), |text, change| {
        let (from, to) = change.split_once(" =>").unwrap_or_else(|| panic!("no `=>`: {change}"));
        assert!(text.contains(from), "{from:?} is not in\n{text}");
        text.replacen(from, to.strip_prefix(' ').unwrap_or(to), 1)
    })
}

/// The words of a command line, of which some are in quotes.
pub fn words(line: &str) -> Vec<String> {
    let part = |(index, part): (usize, &str)| match index % 2 {
        0 => part.split_whitespace().map(str::to_owned).collect(),
        _ => vec![part.to_owned()],
    };
    line.split('"').enumerate().flat_map(part).collect()
}
