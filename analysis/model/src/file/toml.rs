//! TOML text to a [`Node`].

use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

use super::faults::{Faults, Read};
use super::key;
use super::problem::{Fault, Problem};
use super::tree::{Entry, Node, Value};
use super::units;
use crate::quantity::significant;

/// Parses a TOML document; its top is always a table. All syntax errors are reported.
pub fn parse(text: &str, faults: &Faults) -> Read<Node> {
    let (document, errors) = DeTable::parse_recoverable(text);
    let reported = errors.iter().map(|error| {
        let span = error.span().unwrap_or(0..0);
        let problem = match error.message() {
            "duplicate key" => Problem::duplicate(text.get(span.clone()).unwrap_or_default()),
            message => {
                with_unit(text, span.start).unwrap_or_else(|| Problem::syntax("TOML", message))
            }
        };
        faults.report(Fault { span, problem })
    });
    match reported.last() {
        Some(reported) => Err(reported),
        None => Ok(Node { span: 0..0, value: table(document.into_inner()) }),
    }
}

/// The problem of a number with a unit behind it or a decimal comma, which is not valid TOML, on the line of a byte.
fn with_unit(text: &str, at: usize) -> Option<Problem> {
    let bare = |line: &'_ str| line.split('#').next().unwrap_or_default().trim().to_owned();
    let (before, _) = text.split_at_checked(at)?;
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = bare(text[start..].lines().next()?);
    let (name, value) = line.split_once('=')?;
    let header = |line| Some(bare(line).strip_prefix('[')?.strip_suffix(']')?.to_owned() + ".");
    let table = text[..start].lines().rev().find_map(header).unwrap_or_default();
    let path = table + name.trim();
    let key = key::ALL.iter().find(|key| key.path == path)?;
    let meant = significant(units::in_unit(value, key.unit)?, 6);
    let has = if value.contains(',') { "a decimal comma" } else { "a unit" };
    let wrong = format!("has {has}; it must be {}; did you mean {meant}?", key.requirement());
    Some(Problem::value(key.path, value, wrong))
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
