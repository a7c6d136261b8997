//! The keys of a scene: the page's fields come from the same table as the reader of scene files.

use haptic_model::file::key::{self, Bound, Form, Key, Presence};
use haptic_model::file::kind::{self, Kind};
use haptic_model::file::{self, Format, shape};
use haptic_model::host::HostLaw;
use haptic_servo::parameter::Range;
use serde_json::{Map, Value, json};

use crate::PageResult;
use crate::presets::{self, Preset};

/// All keys with unit, bound, default and text; the keys of each type of environment and each shape, with a
/// value of each required key; scenes to start from; and the laws of hostile hosts.
pub fn keys(_: &str, _: &mut Vec<f64>) -> PageResult {
    let kinds = kind::ALL.iter().map(|kind| {
        let needed: Vec<_> = kind.needed.iter().map(|key| key.path).collect();
        let keys: Vec<_> = kind.keys().map(|key| key.path).collect();
        let values = values_of_kind(kind);
        json!({ "name": kind.name, "doc": kind.doc, "keys": keys, "needed": needed, "values": values })
    });
    let shapes = shape::ALL.iter().map(|kind| {
        let keys: Vec<_> = kind.keys().map(|key| key.path).collect();
        let values: Map<_, _> = kind.needed.iter().map(|key| named(key, key.example)).collect();
        json!({ "name": kind.name, "doc": kind.doc, "keys": keys, "values": values })
    });
    let presets =
        presets::ALL.iter().map(|Preset { name, toml }| json!({ "name": name, "toml": toml }));
    let keys: Vec<_> = shown().map(of).collect();
    Ok(json!({
        "keys": keys,
        "kinds": kinds.collect::<Vec<_>>(),
        "shapes": shapes.collect::<Vec<_>>(),
        "presets": presets.collect::<Vec<_>>(),
        "hosts": HostLaw::ALL.map(HostLaw::as_str),
    })
    .to_string())
}

/// The keys of which the page has fields: scenes of the page are [`file::canonical`].
fn shown() -> impl Iterator<Item = &'static Key> {
    let is_other = |key: &Key| key::RECIPROCALS.iter().any(|(other, ..)| *other == key);
    key::ALL.iter().copied().filter(move |key| !is_other(key))
}

fn of(key: &Key) -> Value {
    let (default, without) = match key.presence {
        Presence::Needed => (Value::Null, Value::Null),
        Presence::Default(value) => (json!(value), Value::Null),
        Presence::Optional(words) => (Value::Null, json!(words)),
    };
    json!({
        "path": key.path,
        "unit": key.unit,
        "form": form(key.bound),
        "needed": key.presence == Presence::Needed,
        "default": default,
        "without": without,
        "example": example(key, key.example),
        "requirement": key.requirement(),
        "doc": key.doc,
    })
}

/// The initial values of an environment of this type: those of its example.
fn values_of_kind(kind: &Kind) -> Map<String, Value> {
    let own =
        |key: &Key| kind.values.iter().find(|(other, _)| *other == key).map(|(_, value)| *value);
    let values = kind.needed.iter().map(|key| named(key, own(key).unwrap_or(key.example)));
    // Shapes, one of which a profile needs in place of a number.
    let shapes = kind.keys().filter(|key| *key == &key::SHAPE).map(|key| {
        let detents = shape::ALL.iter().take(1).map(|kind| {
            let values = kind.needed.iter().map(|key| named(key, key.example));
            let own = (key::SHAPE_TYPE.name().to_owned(), Value::from(kind.name));
            Value::Object(std::iter::once(own).chain(values).collect())
        });
        (key.name().to_owned(), detents.collect())
    });
    values.chain(shapes).collect()
}

/// A key's name in its table with a value that TOML has written.
fn named(key: &Key, written: &str) -> (String, Value) {
    (key.name().to_owned(), example(key, written))
}

/// A value that TOML has written; of a chain's masses and links, which have no example of their own, those
/// of their keys.
fn example(key: &Key, written: &str) -> Value {
    let of_keys = |number: usize| -> Value {
        let within = key::ALL.iter().filter(|inner| inner.table() == key.path);
        let values: Map<_, _> = within.map(|inner| named(inner, inner.example)).collect();
        std::iter::repeat_n(Value::Object(values), number).collect()
    };
    if *key == key::MASS {
        return of_keys(2);
    }
    if *key == key::LINK {
        return of_keys(1);
    }
    let text = format!("value = {written}");
    let value = file::as_json(key.path, Format::Toml, &text).ok();
    value.map_or(Value::Null, |value| value["value"].clone())
}

fn form(bound: Bound) -> Value {
    match bound {
        Bound::Number(Range::Whole(least, most)) => json!({ "whole": [least, most] }),
        Bound::Number(range) => json!({ "number": format!("{range:?}").to_lowercase() }),
        Bound::Other(Form::OneOf(names), _) => json!({ "one_of": names }),
        Bound::Other(form, _) => json!(format!("{form:?}").to_lowercase()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer() -> Value {
        serde_json::from_str(&keys("", &mut Vec::new()).unwrap()).unwrap()
    }

    #[test]
    fn each_type_of_environment_and_each_shape_begins_with_values_that_are_read() {
        let answer = answer();
        let of = |list: &str| answer[list].as_array().unwrap().clone();
        let scene = |environment: &Value| {
            json!({ "name": "a", "device": { "inertia": 2.2e-5, "damping": 0.022 },
                "servo": { "period": 0.001 }, "coupling": { "stiffness": 44 },
                "environment": environment })
            .to_string()
        };
        for kind in of("kinds") {
            let mut environment = kind["values"].clone();
            environment["type"] = kind["name"].clone();
            let file = crate::scene_text::read(&scene(&environment));
            let file = file.unwrap_or_else(|error| panic!("{error}"));
            assert!(file.scene.certify().is_ok(), "{environment}");
        }
        for shape in of("shapes") {
            let mut values = shape["values"].clone();
            values["type"] = shape["name"].clone();
            let environment = json!({ "type": "profile", "delay": 1, "from": -9, "to": 9,
                "stiffness": 9, "shape": [values] });
            let read = crate::scene_text::read(&scene(&environment));
            assert!(read.is_ok(), "{environment}: {}", read.unwrap_err());
        }
    }

    #[test]
    fn the_example_of_a_key_is_a_value_and_none_is_left_out() {
        let answer = answer();
        for key in answer["keys"].as_array().unwrap() {
            let is_table = key["form"] == "table" || key["path"] == "environment.shape";
            assert!(is_table || !key["example"].is_null(), "{key}");
        }
        assert_eq!(answer["keys"].as_array().unwrap().len(), shown().count());
    }
}
