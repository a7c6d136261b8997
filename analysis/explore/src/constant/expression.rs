//! A Rust expression, on one line where that is short enough, and otherwise a field a line.

/// Longest line in columns.
const WIDTH: usize = 100;
/// Columns of an indentation.
const INDENT: usize = 4;

/// What stands in a constant.
pub enum Expression {
    /// A number, a path, a call.
    Word(String),
    /// A structure with named fields, and with what the other fields are taken from.
    Structure(&'static str, Vec<(&'static str, Expression)>, Option<String>),
    /// References to values in a row.
    List(Vec<Expression>),
    /// A call with one argument.
    Call(&'static str, Box<Expression>),
}

/// A text as it is.
pub fn word(text: impl ToString) -> Expression {
    Expression::Word(text.to_string())
}

/// The shortest decimal that is the number.
pub fn number(number: f64) -> Expression {
    word(format!("{number:?}"))
}

/// A number that there may be.
pub fn optional(number: Option<f64>) -> Expression {
    word(format!("{number:?}"))
}

/// A structure with all its fields.
pub fn structure(name: &'static str, fields: Vec<(&'static str, Expression)>) -> Expression {
    Expression::Structure(name, fields, None)
}

impl Expression {
    /// Values in a row.
    pub fn list(values: Vec<Self>) -> Self {
        Self::List(values)
    }

    /// A structure that has its other fields from an expression.
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

    /// Behind the `=` of a constant that begins with so many columns: on a line of its own if it fits there
    /// and no better.
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
        }
    }

    /// With a field or a value a line, below a line with this indentation.
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
        }
    }

    /// Behind so many columns of its line, on which the comma after it has to fit.
    fn fitting(&self, indent: usize, columns: usize) -> String {
        let line = self.line();
        if indent + columns + line.len() < WIDTH { line } else { self.broken(indent) }
    }
}
