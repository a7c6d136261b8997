//! The device of a scene in a file of its own: `device = "knob.toml"` in place of the table.

use std::path::{Path, PathBuf};

use super::faults::{Faults, Read, Reported};
use super::key::{self, Key, OF_DEVICE_FILE};
use super::problem::{Fault, Problem};
use super::source::{self, Format, text_of};
use super::texts::Texts;
use super::tree::{Entry, Node, Value};

/// The scene with the tables of the device file that it names, whose text is added to `texts`. A name is
/// relative to the scene's folder, or to the working folder.
pub fn merged(
    texts: &mut Texts<'_>,
    root: Node,
    folder: Option<&Path>,
    faults: &Faults,
) -> Read<Node> {
    let Node { span, value: Value::Table(mut entries) } = root else { return Ok(root) };
    let is_named = |entry: &Entry| {
        entry.name == key::DEVICE.name() && matches!(entry.node.value, Value::Text(_))
    };
    if let Some(place) = entries.iter().position(is_named) {
        let device = read(texts, &entries.remove(place).node, folder, faults)?;
        let merging = Merging { texts, faults };
        merging.all(&mut entries, device)?;
    }
    Ok(Node { span, value: Value::Table(entries) })
}

/// The keys of the device file that a scene names.
fn read(
    texts: &mut Texts<'_>,
    name: &Node,
    folder: Option<&Path>,
    faults: &Faults,
) -> Read<(usize, Vec<Entry>)> {
    let Value::Text(file) = &name.value else { return Ok((0, Vec::new())) };
    let path = folder.unwrap_or(Path::new("")).join(file);
    let shown = path.display().to_string();
    let failed = |why: String| {
        let relative = if folder.is_none() { "; it is relative to the working folder" } else { "" };
        let problem = Problem::value(key::DEVICE.path, &format!("{file:?}"), why + relative);
        faults.report(Fault { span: name.span.clone(), problem })
    };
    let bytes = source::bytes(&path).map_err(|problem| failed(format!("({shown}): {problem}")))?;
    let text = text_of(&shown, 1, &bytes).map_err(|error| failed(format!("({error})")))?;
    let start = texts.add(shown.clone(), text);
    let own = Faults::default();
    let root = source::root(Format::of(&shown, text), text, &own);
    for Fault { span, problem } in own.sorted() {
        faults.report(Fault { span: span.start + start..span.end + start, problem });
    }
    let mut root = root?;
    root.shift(start);
    match root.value {
        Value::Table(entries) => Ok((start, entries)),
        other => Err(failed(format!("is {}; a device file is a table", other.kind()))),
    }
}

/// The device file that a scene file names, if it names one.
pub fn device_file_of(scene: &str) -> Option<PathBuf> {
    let scene = Path::new(scene);
    let bytes = source::bytes(scene).ok()?;
    let own = super::unmerged(scene, &bytes)?;
    Some(scene.parent()?.join(own.get(key::DEVICE.name())?.as_str()?))
}

/// The text of a scene file for the path `to` that names the device file of the scene file `from` in place of its
/// keys; none if that names no file, or if the device or its limits were changed.
pub fn naming(text: &str, from: &str, to: &Path) -> Option<String> {
    let device = device_file_of(from)?;
    let keys = super::canonical(super::load_json(device.to_str()?).ok()?);
    let folder = std::path::absolute(to).ok()?.parent()?.canonicalize().ok()?;
    let device = device.canonicalize().ok()?;
    let name = device.strip_prefix(&folder).unwrap_or(&device).to_str()?;
    let named = without(text, &keys, &format!("{} = {name:?}", key::DEVICE.name()));
    let read = |text| super::parse_in(&folder, text).map(|file| super::write::toml(&file)).ok();
    (read(text)? == read(&named)?).then_some(named)
}

/// The lines of a scene file without those keys of another file, and with its device in one line below the name.
fn without(text: &str, keys: &serde_json::Value, device: &str) -> String {
    let mut table = "";
    let mut lines: Vec<&str> = Vec::new();
    for line in text.lines() {
        if let Some(name) = line.strip_prefix('[') {
            table = name.trim_matches(['[', ']']).split('.').next().unwrap_or_default();
        }
        let key = line.split_once(" = ").map_or("", |(key, _)| key);
        let is_of_device = table == self::key::DEVICE.name() || !keys[table][key].is_null();
        // A table of which no key is left.
        if line.starts_with('[') && lines.last().is_some_and(|last| last.starts_with('[')) {
            lines.pop();
        }
        lines.extend((!is_of_device).then_some(line));
        lines.extend((table.is_empty() && key == self::key::NAME.name()).then_some(device));
    }
    lines.pop_if(|last| last.starts_with('['));
    lines.join("\n") + "\n"
}

/// Merges the keys of a device file into those of a scene.
struct Merging<'m, 't> {
    texts: &'m Texts<'t>,
    faults: &'m Faults,
}

impl Merging<'_, '_> {
    fn all(&self, scene: &mut Vec<Entry>, (start, device): (usize, Vec<Entry>)) -> Read<()> {
        let is_device = |entry: &Entry| entry.name == key::DEVICE.name();
        if !device.iter().any(is_device) {
            let missing = " is missing: a device file has this table";
            return Err(self.wrong(start, key::DEVICE.name(), missing));
        }
        let merged: Vec<Read<()>> =
            device.into_iter().map(|entry| self.one(scene, entry)).collect();
        merged.into_iter().collect()
    }

    fn one(&self, scene: &mut Vec<Entry>, entry: Entry) -> Read<()> {
        let name = entry.name.as_str();
        if !OF_DEVICE_FILE.iter().any(|key| key.name() == name) {
            let keys = OF_DEVICE_FILE.map(Key::name).join(", ");
            let unknown = match [key::SERVO, key::ENVIRONMENT].iter().any(|key| key.name() == name) {
                true => {
                    " is of a scene file, and a device file is needed: move the tables of the device to a file"
                        .to_owned()
                }
                false => format!(" is not a key of a device file; its keys are {keys}"),
            };
            return Err(self.wrong(entry.span.start, name, &unknown));
        }
        if name == key::NAME.name() {
            return Ok(());
        }
        if name == key::DEVICE.name() && matches!(entry.node.value, Value::Text(_)) {
            let another = " is a name in a device file, which must have the table [device] itself";
            return Err(self.wrong(entry.span.start, name, another));
        }
        match scene.iter_mut().find(|other| other.name == name) {
            None => scene.push(entry),
            Some(own) => {
                if let (Value::Table(own), Value::Table(more)) =
                    (&mut own.node.value, entry.node.value)
                {
                    return self.keys(&entry.name, own, more);
                }
            }
        }
        Ok(())
    }

    /// Adds the keys of a table; a key is in one of both files.
    fn keys(&self, table: &str, own: &mut Vec<Entry>, more: Vec<Entry>) -> Read<()> {
        for entry in more {
            if let Some(twice) = own.iter().find(|own| own.name == entry.name) {
                let name = format!("{table}.{}", entry.name);
                let other = self.texts.line_of(entry.span.start);
                let both = format!(" is set here and at {other}; set it in one of both");
                return Err(self.wrong(twice.span.start, &name, &both));
            }
            own.push(entry);
        }
        Ok(())
    }

    /// Reports a key at a place.
    fn wrong(&self, start: usize, name: &str, wrong: &str) -> Reported {
        let problem = Problem::key_and(name.to_owned(), wrong);
        self.faults.report(Fault { span: start..start, problem })
    }
}
