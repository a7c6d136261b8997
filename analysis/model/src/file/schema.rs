//! The JSON schema of a scene file, for editors: they complete keys, show their meaning, and
//! underline values out of bounds. Rules on several keys are left to the reader of the file.

use haptic_servo::parameter::Range;
use serde_json::{Map, Value, json};

use super::key::{self, Bound, Form, Key, Presence};
use super::kind;
use super::shape;

/// The schema, of draft 7, which is the latest that editors of TOML know.
pub fn json() -> Value {
    let mut schema = table("");
    schema["$schema"] = "http://json-schema.org/draft-07/schema#".into();
    schema["title"] = "Haptic scene".into();
    schema
}

/// The table of that path.
fn table(path: &str) -> Value {
    let keys = key::ALL.iter().filter(|key| key.table() == path).copied();
    match path {
        "environment" => one_of(kind::ALL.iter().map(|kind| {
            let keys = [&key::TYPE].into_iter().chain(kind.keys());
            of_kind(&key::TYPE, kind.name, kind.doc, object(keys, |key| needs(kind.needed, key)))
        })),
        "environment.shape" => one_of(shape::ALL.iter().map(|kind| {
            let keys = [&key::SHAPE_TYPE].into_iter().chain(kind.keys());
            let keys = object(keys, |key| needs(kind.needed, key));
            of_kind(&key::SHAPE_TYPE, kind.name, kind.doc, keys)
        })),
        // A spring needs a stiffness, and a matched coupling takes none.
        "coupling" => {
            let mut schema = object(keys, |_| false);
            let matched = json!({ "const": super::scene::MATCHED });
            let spring = json!({
                "required": [key::COUPLING_STIFFNESS.name()],
                "properties": { key::COUPLING_TYPE.name(): { "not": matched } },
            });
            let matched = json!({
                "required": [key::COUPLING_TYPE.name()],
                "properties": {
                    key::COUPLING_TYPE.name(): matched,
                    key::COUPLING_STIFFNESS.name(): false,
                },
            });
            schema["oneOf"] = json!([spring, matched]);
            schema
        }
        // Inertia and damping are those of a rigid body, a chain's masses have their own, and a file has all.
        "device" => {
            let mut schema = object(keys, |_| false);
            let body = [key::INERTIA.name(), key::DEVICE_DAMPING.name()];
            schema["type"] = json!(["object", "string"]);
            schema["oneOf"] = json!([
                { "type": "object", "required": body },
                { "type": "object", "required": [key::MASS.name()] },
                { "type": "string" },
            ]);
            schema
        }
        "servo" => {
            let mut schema = object(keys, |_| false);
            let either = [key::PERIOD.name(), key::RATE.name()];
            schema["oneOf"] = either.map(|key| json!({ "required": [key] })).into_iter().collect();
            schema
        }
        _ => object(keys, |key| key.presence == Presence::Needed),
    }
}

fn one_of(kinds: impl Iterator<Item = Value>) -> Value {
    json!({ "oneOf": kinds.collect::<Vec<_>>() })
}

fn needs(needed: &[&Key], key: &Key) -> bool {
    *key == key::TYPE || *key == key::SHAPE_TYPE || needed.contains(&key)
}

/// The table of a type, by the key that names it.
fn of_kind(type_key: &Key, name: &str, doc: &str, mut schema: Value) -> Value {
    schema["properties"][type_key.name()] = json!({ "const": name });
    schema["description"] = doc.into();
    schema
}

fn object(keys: impl Iterator<Item = &'static Key>, is_needed: impl Fn(&Key) -> bool) -> Value {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for key in keys {
        properties.insert(key.name().to_owned(), property(key));
        if is_needed(key) {
            required.push(key.name());
        }
    }
    json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn property(key: &Key) -> Value {
    let mut schema = match key.bound {
        Bound::Number(Range::Finite) => json!({ "type": "number" }),
        Bound::Number(Range::Positive) => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Bound::Number(Range::NotNegative) => json!({ "type": "number", "minimum": 0 }),
        Bound::Number(Range::Fraction) => {
            json!({ "type": "number", "minimum": 0, "exclusiveMaximum": 1 })
        }
        Bound::Number(Range::Share) => json!({ "type": "number", "minimum": 0, "maximum": 1 }),
        Bound::Number(Range::Whole(least, most)) => {
            json!({ "type": "integer", "minimum": least, "maximum": most })
        }
        Bound::Other(form, _) => match form {
            Form::Text => json!({ "type": "string" }),
            Form::OneOf(words) => json!({ "enum": words }),
            Form::Boolean => json!({ "type": "boolean" }),
            Form::Numbers => json!({ "type": "array", "items": { "type": "number" } }),
            Form::Pairs => {
                let pair = json!({
                    "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2
                });
                json!({ "type": "array", "minItems": 2, "items": pair })
            }
            Form::Sections => {
                let section = json!({
                    "type": "array", "items": { "type": "number" }, "minItems": 6, "maxItems": 6
                });
                json!({ "type": "array", "minItems": 1, "items": section })
            }
            Form::Roots => {
                let complex = json!({
                    "type": "array", "items": { "type": "number" }, "minItems": 1, "maxItems": 2
                });
                let root = json!({ "anyOf": [{ "type": "number" }, complex] });
                json!({ "type": "array", "maxItems": 8, "items": root })
            }
            Form::Time => {
                let time = json!({ "type": "number", "minimum": 0 });
                let range = json!({
                    "type": "array", "items": time, "minItems": 2, "maxItems": 2
                });
                json!({ "anyOf": [time, range] })
            }
            Form::Table => table(key.path),
            Form::TablesOrOne => {
                let one = table(key.path);
                json!({ "oneOf": [one, { "type": "array", "minItems": 1, "items": one }] })
            }
            Form::Tables => json!({ "type": "array", "minItems": 1, "items": table(key.path) }),
        },
    };
    let unit = if key.unit.is_empty() { String::new() } else { format!(" In {}.", key.unit) };
    schema["description"] = format!("{}{unit}", key.doc).into();
    if let Presence::Default(value) = key.presence {
        schema["default"] = value.into();
    }
    schema
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The schema of a key, by its path.
    fn of<'s>(schema: &'s Value, path: &str) -> &'s Value {
        path.split('.').filter(|name| !name.is_empty()).fold(schema, |at, name| {
            let at = if at["items"].is_object() { &at["items"] } else { at };
            match at["oneOf"].as_array() {
                Some(kinds) if at["properties"].is_null() => {
                    let has = kinds.iter().find(|kind| kind["properties"][name].is_object());
                    &has.unwrap_or(&Value::Null)["properties"][name]
                }
                _ => &at["properties"][name],
            }
        })
    }

    #[test]
    fn every_key_is_in_it_with_its_words() {
        let schema = json();
        for key in key::ALL.iter().filter(|key| ![&key::TYPE, &key::SHAPE_TYPE].contains(key)) {
            let words = of(&schema, key.path)["description"].as_str();
            assert!(words.is_some_and(|words| words.starts_with(key.doc)), "{}", key.path);
        }
        assert_eq!(of(&schema, "servo.period")["exclusiveMinimum"], 0);
        assert_eq!(of(&schema, "environment.delay")["maximum"], 8);
    }
}
