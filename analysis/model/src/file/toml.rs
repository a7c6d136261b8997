//! TOML text to a [`Node`].

use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

use super::faults::{Faults, Read};
use super::problem::{Fault, Problem};
use super::tree::{Entry, Node, Value};

/// Parses a TOML document; its top is always a table. All syntax errors are reported.
pub fn parse(text: &str, faults: &Faults) -> Read<Node> {
    let (document, errors) = DeTable::parse_recoverable(text);
    let reported = errors.iter().map(|error| {
        let span = error.span().unwrap_or(0..0);
        let problem = match error.message() {
            "duplicate key" => Problem::duplicate(text.get(span.clone()).unwrap_or_default()),
            message => Problem::syntax("TOML", message),
        };
        faults.report(Fault { span, problem })
    });
    match reported.last() {
        Some(reported) => Err(reported),
        None => Ok(Node { span: 0..0, value: table(document.into_inner()) }),
    }
}

fn table(table: DeTable<'_>) -> Value {
    let entry = |(key, value): (Spanned<_>, _)| {
        let span = key.span();
        let name: std::borrow::Cow<'_, str> = key.into_inner();
        Entry { name: name.into_owned(), span, node: node(value) }
    };
    Value::Table(table.into_iter().map(entry).collect())
}

fn node(spanned: Spanned<DeValue<'_>>) -> Node {
    let span = spanned.span();
    let value = match spanned.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(integer) => Value::Number(integer_value(&integer)),
        // The parser has checked the grammar; a decimal that is too large is infinite here, and
        // refused by the bounds of the key.
        DeValue::Float(float) => Value::Number(float.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(boolean) => Value::Boolean(boolean),
        DeValue::Datetime(_) => Value::Other("a date"),
        DeValue::Array(list) => Value::List(list.into_iter().map(node).collect()),
        DeValue::Table(inner) => table(inner),
    };
    Node { span, value }
}

fn integer_value(integer: &DeInteger<'_>) -> f64 {
    match integer.radix() {
        10 => integer.as_str().parse().unwrap_or(f64::NAN),
        radix => i128::from_str_radix(integer.as_str(), radix).map_or(f64::NAN, |i| i as f64),
    }
}
