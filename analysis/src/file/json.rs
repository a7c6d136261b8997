//! JSON text to a [`Node`].

use jsonc_parser::ast::{self, ObjectPropName};
use jsonc_parser::common::Ranged;
use jsonc_parser::{CollectOptions, ParseOptions, parse_to_ast};

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

/// Parses one JSON value.
pub fn parse(text: &str) -> Result<Node, Fault> {
    let parsed = parse_to_ast(text, &CollectOptions::default(), &STRICT).map_err(|error| {
        let range = error.range();
        let problem = Problem::syntax("JSON", &error.kind().to_string());
        Fault { span: range.start..range.end, problem }
    })?;
    match parsed.value {
        Some(value) => node(value),
        None => Err(Fault { span: 0..0, problem: Problem::Empty }),
    }
}

fn span(value: &impl Ranged) -> Span {
    let range = value.range();
    range.start..range.end
}

fn node(value: ast::Value<'_>) -> Result<Node, Fault> {
    let span = span(&value);
    let value = match value {
        ast::Value::StringLit(text) => Value::Text(text.value.into_owned()),
        ast::Value::NumberLit(number) => Value::Number(number.value.parse().unwrap_or(f64::NAN)),
        ast::Value::BooleanLit(boolean) => Value::Boolean(boolean.value),
        ast::Value::NullKeyword(_) => Value::Other("null"),
        ast::Value::Array(list) => {
            Value::List(list.elements.into_iter().map(node).collect::<Result<_, _>>()?)
        }
        ast::Value::Object(object) => table(object)?,
    };
    Ok(Node { span, value })
}

fn table(object: ast::Object<'_>) -> Result<Value, Fault> {
    let mut names = std::collections::HashSet::new();
    let mut entries = Vec::with_capacity(object.properties.len());
    for property in object.properties {
        let span = match &property.name {
            ObjectPropName::String(name) => span(name),
            ObjectPropName::Word(name) => span(name),
        };
        let name = property.name.into_string();
        if !names.insert(name.clone()) {
            return Err(Fault { span, problem: Problem::duplicate(&name) });
        }
        entries.push(Entry { name, span, node: node(property.value)? });
    }
    Ok(Value::Table(entries))
}
