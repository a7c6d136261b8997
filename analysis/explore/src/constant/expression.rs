//! A Rust expression, on one line if that is short enough, otherwise with one field per line.

/// Longest line in columns.
const WIDTH: usize = 100;
/// Columns of an indentation.
const INDENT: usize = 4;

/// The value of a constant.
pub enum Expression {
    /// A number, a path, a call.
    Word(String),
    /// A structure with named fields, and the expression for the other fields.
    Structure(&'static str, Vec<(&'static str, Expression)>, Option<String>),
    /// A list of references to values.
    List(Vec<Expression>),
    /// A call with one argument.
    Call(&'static str, Box<Expression>),
    /// A call of a method without arguments.
    Method(Box<Expression>, &'static str),
}

/// A verbatim text.
pub fn word(text: impl ToString) -> Expression {
    Expression::Word(text.to_string())
}

/// The shortest decimal that is the number.
pub fn number(number: f64) -> Expression {
    word(format!("{number:?}"))
}

/// An optional number.
pub fn optional(number: Option<f64>) -> Expression {
    word(format!("{number:?}"))
}

/// A structure with all its fields.
pub fn structure(name: &'static str, fields: Vec<(&'static str, Expression)>) -> Expression {
    Expression::Structure(name, fields, None)
}

impl Expression {
    /// A list of values.
    pub fn list(values: Vec<Self>) -> Self {
        Self::List(values)
    }

    /// A structure with its other fields from an expression.
    pub fn with_rest(self, rest: impl Into<String>) -> Self {
        match self {
            Self::Structure(name, fields, _) => Self::Structure(name, fields, Some(rest.into())),
            other => other,
        }
    }

    /// As the argument of a call.
    pub fn within(self, call: &'static str) -> Self {
        Self::Call(call, Box::new(self))
    }

    /// With a method called on it.
    pub fn method(self, name: &'static str) -> Self {
        Self::Method(Box::new(self), name)
    }

    /// After the `=` of a constant whose beginning has `columns` columns: on its own line if it fits only
    /// there.
    pub fn after(&self, columns: usize) -> String {
        let line = self.line();
        if columns + 1 + line.len() < WIDTH {
            return format!(" {line}");
        }
        if INDENT + line.len() < WIDTH {
            return format!("\n{}{line}", " ".repeat(INDENT));
        }
        format!(" {}", self.broken(0))
    }

    /// On one line.
    fn line(&self) -> String {
        match self {
            Self::Word(text) => text.clone(),
            Self::Structure(name, fields, rest) => {
                let fields = fields.iter().map(|(name, value)| format!("{name}: {}", value.line()));
                let rest = rest.iter().map(|rest| format!("..{rest}"));
                let all: Vec<_> = fields.chain(rest).collect();
                format!("{name} {{ {} }}", all.join(", "))
            }
            Self::List(values) => {
                let all: Vec<_> = values.iter().map(Self::line).collect();
                format!("&[{}]", all.join(", "))
            }
            Self::Call(name, argument) => format!("{name}({})", argument.line()),
            Self::Method(of, name) => format!("{}.{name}()", of.line()),
        }
    }

    /// With one field or value per line, below a line with this indentation.
    pub fn broken(&self, indent: usize) -> String {
        let within = indent + INDENT;
        let [outer, inner] = [indent, within].map(|columns| " ".repeat(columns));
        match self {
            Self::Word(text) => text.clone(),
            Self::Structure(name, fields, rest) => {
                let fields = fields.iter().map(|(name, value)| {
                    format!("{inner}{name}: {},\n", value.fitting(within, name.len() + 2))
                });
                let rest = rest.iter().map(|rest| format!("{inner}..{rest}\n"));
                let all: String = fields.chain(rest).collect();
                format!("{name} {{\n{all}{outer}}}")
            }
            Self::List(values) => {
                let all: String = values
                    .iter()
                    .map(|value| format!("{inner}{},\n", value.fitting(within, 0)))
                    .collect();
                format!("&[\n{all}{outer}]")
            }
            Self::Call(name, argument) => format!("{name}({})", argument.broken(indent)),
            Self::Method(of, name) => format!("{}\n{outer}.{name}()", of.broken(indent)),
        }
    }

    /// After `columns` columns of its line, which must also hold the comma.
    fn fitting(&self, indent: usize, columns: usize) -> String {
        let line = self.line();
        if indent + columns + line.len() < WIDTH { line } else { self.broken(indent) }
    }
}
