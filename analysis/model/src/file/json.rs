//! JSON text to a [`Node`].

use jsonc_parser::ast::{self, ObjectPropName};
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};

use super::faults::{Faults, Read, all};
use super::problem::{Fault, Problem};
use super::tree::{Entry, Node, Span, Value};

/// The grammar of RFC 8259 and nothing on top.
const STRICT: ParseOptions = ParseOptions {
    allow_comments: false,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

pub fn parse(text: &str, faults: &Faults) -> Read<Node> {
    let parsed = parse_to_ast(text, &CollectOptions::default(), &STRICT).map_err(|error| {
        let range = error.range();
        let problem = Problem::syntax("JSON", &error.kind().to_string());
        faults.report(Fault { span: range.start..range.end, problem })
    })?;
    match parsed.value {
        Some(value) => node(value, faults),
        None => Err(faults.report(Fault { span: 0..0, problem: Problem::Empty })),
    }
}

fn span(value: &impl Ranged) -> Span {
    let range = value.range();
    range.start..range.end
}

fn node(value: ast::Value<'_>, faults: &Faults) -> Read<Node> {
    let span = span(&value);
    let value = match value {
        ast::Value::StringLit(text) => Value::Text(text.value.into_owned()),
        ast::Value::NumberLit(number) => Value::Number(number.value.parse().unwrap_or(f64::NAN)),
        ast::Value::BooleanLit(boolean) => Value::Boolean(boolean.value),
        ast::Value::NullKeyword(_) => Value::Other("null"),
        ast::Value::Array(list) => {
            Value::List(all(list.elements.into_iter().map(|element| node(element, faults)))?)
        }
        ast::Value::Object(object) => table(object, faults)?,
    };
    Ok(Node { span, value })
}

fn table(object: ast::Object<'_>, faults: &Faults) -> Read<Value> {
    let mut names = std::collections::HashSet::new();
    let entries = object.properties.into_iter().map(|property| {
        let span = match &property.name {
            ObjectPropName::String(name) => span(name),
            ObjectPropName::Word(name) => span(name),
        };
        let name = property.name.into_string();
        let node = node(property.value, faults);
        if !names.insert(name.clone()) {
            return Err(faults.report(Fault { span, problem: Problem::duplicate(&name) }));
        }
        Ok(Entry { name, span, node: node? })
    });
    all(entries).map(Value::Table)
}
