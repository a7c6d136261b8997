//! A document as a tree of values with their places in the text, for TOML and JSON alike.

use std::ops::Range;

/// Bytes of the text that a value or a key was written in.
pub type Span = Range<usize>;

/// A value and its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Bytes of the value in the text.
    pub span: Span,
    pub value: Value,
}

/// A value of either format; a date of TOML is [`Value::Other`], because no key takes it.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Integer or decimal number; as written it may be infinite or NaN.
    Number(f64),
    Text(String),
    Boolean(bool),
    List(Vec<Node>),
    /// A table, or an object.
    Table(Vec<Entry>),
    /// A value that no key takes, with the name of its kind.
    Other(&'static str),
}

/// A key with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub name: String,
    /// Bytes of the key in the text.
    pub span: Span,
    pub node: Node,
}

impl Node {
    /// Moves all places by this number of bytes.
    pub fn shift(&mut self, bytes: usize) {
        let moved = |span: &Span| span.start + bytes..span.end + bytes;
        self.span = moved(&self.span);
        match &mut self.value {
            Value::List(items) => items.iter_mut().for_each(|item| item.shift(bytes)),
            Value::Table(entries) => entries.iter_mut().for_each(|entry| {
                entry.span = moved(&entry.span);
                entry.node.shift(bytes);
            }),
            _ => {}
        }
    }
}

impl Value {
    pub fn into_json(self) -> serde_json::Value {
        match self {
            Self::Number(number) => number.into(),
            Self::Text(text) => text.into(),
            Self::Boolean(boolean) => boolean.into(),
            Self::List(list) => list.into_iter().map(|node| node.value.into_json()).collect(),
            Self::Table(entries) => entries
                .into_iter()
                .map(|entry| (entry.name, entry.node.value.into_json()))
                .collect(),
            Self::Other(_) => serde_json::Value::Null,
        }
    }

    /// The name of this kind of value in messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Text(_) => "a string",
            Self::Boolean(_) => "true or false",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
            Self::Other(kind) => kind,
        }
    }
}
