//! The reference of scene files, `SCENE.md`, as a text.

use super::example;
use super::key::{self, Key, Presence};
use super::kind;
use super::shape;

const INTRODUCTION: &str = "\
# Scene files

A scene file is TOML, or JSON of the same shape. This is every key, with what its value must be, what
counts where it is left out, and an example. All numbers are in SI units. A key that is not here is an
error. `haptic schema --reference` prints this page, of the table that the program reads files by.

`haptic schema --example TYPE` prints a scene file to start from, with every key explained; below is that
of a damper wall. `haptic schema > scene.schema.json` writes a JSON schema, with which an editor completes
and checks keys: for an editor with Taplo (Even Better TOML), put `#:schema ./scene.schema.json` into the
first line.

Bounds here are about what a number can mean. Whether a scene with these numbers is safe is the
certificate's question: a negative stiffness is a bad spring, not a bad file.
";

/// The reference in Markdown.
pub fn markdown() -> String {
    let mut text = INTRODUCTION.to_owned();
    for table in key::ALL.iter().filter(|key| has_keys(key) || **key == &key::NAME) {
        let keys: Vec<&Key> =
            key::ALL.iter().filter(|key| key.table() == table.path).copied().collect();
        if **table == key::NAME {
            text += "\n## At the top\n\n";
            text += &rows(&[&key::NAME]);
            continue;
        }
        text += &format!("\n## {}\n\n{}{}\n\n", heading(table), table.doc, absent(table));
        if **table == key::ENVIRONMENT {
            text += &types(
                kind::ALL.iter().map(|it| (it.name, it.needed, it.keys().collect(), it.doc)),
            );
        }
        if **table == key::SHAPE {
            text += &types(
                shape::ALL.iter().map(|it| (it.name, it.needed, it.keys().collect(), it.doc)),
            );
        }
        text += &rows(&keys);
    }
    let wall = example::toml("damper-wall").unwrap_or_default();
    text + "\n## Example\n\n```toml\n" + &wall + "```\n"
}

fn has_keys(table: &Key) -> bool {
    key::ALL.iter().any(|key| key.table() == table.path)
}

/// The heading of a table, `[device]`, or of a list of tables, `[[device.mass]]`.
fn heading(table: &Key) -> String {
    match table.bound {
        key::Bound::Other(key::Form::Tables, _) => format!("`[[{}]]`", table.path),
        _ => format!("`[{}]`", table.path),
    }
}

fn absent(table: &Key) -> String {
    match table.presence {
        Presence::Optional(without) => format!(" Left out: {without}."),
        _ => String::new(),
    }
}

fn rows(keys: &[&Key]) -> String {
    let mut text = "| key | must be | left out | |\n|---|---|---|---|\n".to_owned();
    for key in keys {
        let example = match key.example {
            "" => format!("`{}`", key.name()),
            value => format!("`{} = {value}`", key.name()),
        };
        let without = match key.presence {
            Presence::Needed => "an error".to_owned(),
            Presence::Default(value) => value.to_string(),
            Presence::Optional(without) => without.to_owned(),
        };
        text += &format!("| {example} | {} | {without} | {} |\n", key.requirement(), key.doc);
    }
    text
}

/// Name, required keys, all keys with the required ones first, and description of a type.
type Row = (&'static str, &'static [&'static Key], Vec<&'static Key>, &'static str);

fn types(kinds: impl Iterator<Item = Row>) -> String {
    let mut text = "| `type` | must have | may have | |\n|---|---|---|---|\n".to_owned();
    for (name, needed, keys, doc) in kinds {
        let names = |keys: &[&Key]| {
            keys.iter().map(|key| format!("`{}`", key.name())).collect::<Vec<_>>().join(", ")
        };
        let (needed, optional) = (names(needed), names(&keys[needed.len()..]));
        text += &format!("| `{name}` | {needed} | {optional} | {doc} |\n");
    }
    text + "\nEach key is an error with the types that do not have it.\n\n"
}
