//! Reads a table key by key; a key that is never read is unknown. Reading continues after an error, so
//! that a user who corrects a file sees all errors at once.

use haptic_servo::parameter::Range;
use haptic_servo::scene::TimeRange;

use super::faults::{Faults, Read, Reported, all};
use super::key::{Key, Presence};
use super::problem::{Fault, Problem, excerpt};
use super::tree::{Entry, Node, Span, Value};

/// Similarity of two names (0 to 1) from which one counts as a misspelling of the other. Chosen so that one
/// wrong, missing or swapped letter in a word of six still counts.
const ALIKE: f64 = 0.9;

/// A table of the file that is being read.
pub struct Section<'t> {
    text: &'t str,
    faults: &'t Faults,
    path: &'static str,
    /// Its name with its index in a list, such as `environment.shape[0]`, where messages use that.
    numbered: Option<String>,
    title: String,
    span: Span,
    entries: Vec<Entry>,
    asked: Vec<&'static str>,
    needed: &'static [&'static Key],
}

/// A value and its place in the text.
pub struct Found<T> {
    /// The value.
    pub value: T,
    /// Bytes of the value in the text.
    pub span: Span,
}

/// Numbers with their place.
pub type Row = Found<Vec<f64>>;

/// Two numbers, each with its place.
pub type Pair = [Found<f64>; 2];

impl<'t> Section<'t> {
    /// Starts on a node that must be a table; `title` is its name in messages.
    pub fn new(
        (text, faults): (&'t str, &'t Faults),
        title: &str,
        key: &Key,
        node: Node,
    ) -> Read<Self> {
        let title = title.to_owned();
        match node.value {
            Value::Table(entries) => {
                let (path, span, asked) = (key.path, node.span, Vec::new());
                let (numbered, needed) = (None, [].as_slice());
                Ok(Self { text, faults, path, numbered, title, span, entries, asked, needed })
            }
            other => Err(faults.report(wrong_kind(text, key, key.path, &node.span, &other))),
        }
    }

    /// From here on messages use this name of the table in the full names of its keys.
    pub fn number_as(&mut self, name: String) {
        self.numbered = Some(name);
    }

    /// The full name of a key of this table, as messages give it.
    pub fn name_of(&self, key: &Key) -> String {
        match &self.numbered {
            Some(table) => format!("{table}.{}", key.name()),
            None => key.path.to_owned(),
        }
    }

    /// From here on messages use this title, since the type of the table is known, and these keys are
    /// required.
    pub fn specialize(&mut self, title: String, needed: &'static [&'static Key]) {
        (self.title, self.needed) = (title, needed);
    }

    /// Skips a key that cannot be read because of a reported error: it may be valid.
    pub fn skip(&mut self, key: &Key) {
        self.take(key);
    }

    /// The table of that key, if there is one.
    pub fn table(&mut self, key: &Key) -> Read<Option<Self>> {
        let title = format!("[{}]", key.path);
        self.take(key)
            .map(|node| Self::new((self.text, self.faults), &title, key, node))
            .transpose()
    }

    /// The table of that key, which must be there.
    pub fn needed_table(&mut self, key: &Key) -> Read<Self> {
        self.table(key)?.ok_or_else(|| self.missing(key))
    }

    /// The tables of that key in their order with the place of the whole list, if it is there.
    pub fn tables(&mut self, key: &Key) -> Read<Option<Found<Vec<Self>>>> {
        let Some(Node { span, value }) = self.take(key) else { return Ok(None) };
        let Value::List(items) = value else {
            return Err(self.wrong_kind(key, &span, &value));
        };
        let numbered = |(index, node): (usize, Node)| {
            let title = format!("[[{}]] number {}", key.path, index + 1);
            Self::new((self.text, self.faults), &title, key, node)
        };
        let value = all(items.into_iter().enumerate().map(numbered))?;
        Ok(Some(Found { value, span }))
    }

    /// Whether a key of that name is there, read or not.
    pub fn has(&self, key: &Key) -> bool {
        self.entries.iter().any(|entry| entry.name == key.name())
    }

    /// The text at `span`, safe to print.
    pub fn written(&self, span: &Span) -> String {
        excerpt(&self.text[span.clone()])
    }

    /// Bytes of the table in the text.
    pub fn span(&self) -> Span {
        self.span.clone()
    }

    /// The number of that key with its place, if it is there.
    pub fn found(&mut self, key: &Key) -> Read<Option<Found<f64>>> {
        let Some(node) = self.take(key) else { return Ok(None) };
        let value = self.number_of(key, &self.name_of(key), &node)?;
        Ok(Some(Found { value, span: node.span }))
    }

    /// The number of that key, if it is there.
    pub fn optional(&mut self, key: &Key) -> Read<Option<f64>> {
        Ok(self.found(key)?.map(|found| found.value))
    }

    /// The number of that key. Where it is left out, it is the key's default, if that has one.
    pub fn number(&mut self, key: &Key) -> Read<f64> {
        let is_needed = self.needed.contains(&key);
        match (self.optional(key)?, key.presence) {
            (Some(value), _) => Ok(value),
            (None, Presence::Default(value)) if !is_needed => Ok(value),
            (None, _) => Err(self.missing(key)),
        }
    }

    /// The number of that key in the same way; `None` where it is left out and need not be there.
    pub fn value(&mut self, key: &Key) -> Read<Option<f64>> {
        match key.presence {
            Presence::Optional(_) => self.optional(key),
            _ => self.number(key).map(Some),
        }
    }

    /// The time of that key in s, or the range that it lies in, with its place, if it is there.
    pub fn time(&mut self, key: &Key) -> Read<Option<Found<TimeRange>>> {
        let Some(node) = self.take(key) else { return Ok(None) };
        let span = node.span.clone();
        let value = match &node.value {
            Value::List(ends) => match &ends[..] {
                [least, most] => {
                    let ends = [("[0]", least), ("[1]", most)];
                    let [least, most] = ends.map(|(place, end)| {
                        self.seconds(key, &format!("{}{place}", key.path), end)
                    });
                    TimeRange::between(least?, most?)
                }
                _ => return Err(self.out_of_bounds(key, key.path, &span)),
            },
            _ => TimeRange::exactly(self.seconds(key, key.path, &node)?),
        };
        if value.least > value.most {
            let reason = "is a range that ends before it begins: write [least, most]".to_owned();
            return Err(self.conflict(key, span, reason));
        }
        Ok(Some(Found { value, span }))
    }

    fn seconds(&self, key: &Key, path: &str, node: &Node) -> Read<f64> {
        match node.value {
            Value::Number(value) if Range::NotNegative.admits(value) => Ok(value),
            Value::Number(_) => Err(self.out_of_bounds(key, path, &node.span)),
            ref other => Err(self.wrong_kind(key, &node.span, other)),
        }
    }

    /// The whole number of that key, in the same way.
    pub fn whole(&mut self, key: &Key) -> Read<usize> {
        Ok(self.number(key)? as usize)
    }

    /// The string of that key with its place, which must be there.
    pub fn needed_text(&mut self, key: &Key) -> Read<Found<String>> {
        self.text(key)?.ok_or_else(|| self.missing(key))
    }

    /// The string of that key with its place, if it is there.
    pub fn text(&mut self, key: &Key) -> Read<Option<Found<String>>> {
        match self.take(key) {
            None => Ok(None),
            Some(Node { span, value: Value::Text(value) }) => Ok(Some(Found { value, span })),
            Some(node) => Err(self.wrong_kind(key, &node.span, &node.value)),
        }
    }

    /// The truth value of that key, if it is there.
    pub fn boolean(&mut self, key: &Key) -> Read<Option<bool>> {
        match self.take(key) {
            None => Ok(None),
            Some(Node { value: Value::Boolean(value), .. }) => Ok(Some(value)),
            Some(node) => Err(self.wrong_kind(key, &node.span, &node.value)),
        }
    }

    /// The finite numbers of that key with their place, if it is there.
    pub fn list(&mut self, key: &Key) -> Read<Option<Found<Vec<f64>>>> {
        let Some(node) = self.take(key) else { return Ok(None) };
        let Value::List(items) = &node.value else {
            return Err(self.wrong_kind(key, &node.span, &node.value));
        };
        let item = |(index, item): (usize, &Node)| {
            let path = format!("{}[{index}]", key.path);
            let (value, span) = (&item.value, &item.span);
            match value {
                Value::Number(number) if number.is_finite() => Ok(*number),
                Value::Number(_) => Err(self.out_of_bounds(key, &path, span)),
                _ => {
                    let problem = Problem::WrongKind {
                        key: path,
                        value: excerpt(&self.text[span.clone()]),
                        found: value.kind(),
                        bound: "a finite number".to_owned(),
                    };
                    Err(self.report(span.clone(), problem))
                }
            }
        };
        let value = all(items.iter().enumerate().map(item))?;
        Ok(Some(Found { value, span: node.span }))
    }

    /// The pairs of finite numbers of that key with their places, if it is there.
    pub fn pairs(&mut self, key: &Key) -> Read<Option<Found<Vec<Pair>>>> {
        let Some(node) = self.take(key) else { return Ok(None) };
        let Value::List(items) = &node.value else {
            return Err(self.wrong_kind(key, &node.span, &node.value));
        };
        let pair = |(index, item): (usize, &Node)| {
            let name = format!("{}[{index}]", self.name_of(key));
            let Value::List(numbers) = &item.value else {
                return Err(self.no_pair(name, item, item.value.kind()));
            };
            let [a, b] = &numbers[..] else {
                return Err(self.no_pair(name, item, "a list of another length"));
            };
            let [a, b] = [(0, a), (1, b)].map(|(place, node)| match node.value {
                Value::Number(value) if value.is_finite() => {
                    Ok(Found { value, span: node.span.clone() })
                }
                ref other => {
                    let name = format!("{name}[{place}]");
                    Err(self.no_finite(name, &node.span, other))
                }
            });
            Ok([a?, b?])
        };
        let value = all(items.iter().enumerate().map(pair))?;
        Ok(Some(Found { value, span: node.span }))
    }

    /// The lists of finite numbers of that key with their places, if it is there. Each has one of these
    /// lengths; a number is a list of one. `bound` is what one must be.
    pub fn rows(
        &mut self,
        key: &Key,
        lengths: &[usize],
        bound: &str,
    ) -> Read<Option<Found<Vec<Row>>>> {
        let Some(node) = self.take(key) else { return Ok(None) };
        let Value::List(items) = &node.value else {
            return Err(self.wrong_kind(key, &node.span, &node.value));
        };
        let row = |(index, item): (usize, &Node)| {
            let name = format!("{}[{index}]", self.name_of(key));
            let (value, span) = (&item.value, item.span.clone());
            let numbers = match value {
                Value::Number(_) => std::slice::from_ref(item),
                Value::List(numbers) => numbers,
                _ => &[],
            };
            if !lengths.contains(&numbers.len()) {
                let written = excerpt(&self.text[span.clone()]);
                let found = match value {
                    Value::List(_) => "a list of another length",
                    other => other.kind(),
                };
                let bound = bound.to_owned();
                let problem = Problem::WrongKind { key: name, value: written, found, bound };
                return Err(self.report(span, problem));
            }
            let number = |(place, node): (usize, &Node)| match node.value {
                Value::Number(value) if value.is_finite() => Ok(value),
                ref other => Err(self.no_finite(format!("{name}[{place}]"), &node.span, other)),
            };
            let value = all(numbers.iter().enumerate().map(number))?;
            Ok(Found { value, span })
        };
        let value = all(items.iter().enumerate().map(row))?;
        Ok(Some(Found { value, span: node.span }))
    }

    fn no_pair(&self, key: String, node: &Node, found: &'static str) -> Reported {
        let value = excerpt(&self.text[node.span.clone()]);
        let bound = "a pair of finite numbers, [angle in rad, torque in N m]".to_owned();
        self.report(node.span.clone(), Problem::WrongKind { key, value, found, bound })
    }

    fn no_finite(&self, key: String, span: &Span, value: &Value) -> Reported {
        let (text, bound) = (excerpt(&self.text[span.clone()]), "a finite number".to_owned());
        let problem = match value {
            Value::Number(_) => Problem::OutOfBounds { key, value: text, bound },
            _ => Problem::WrongKind { key, value: text, found: value.kind(), bound },
        };
        self.report(span.clone(), problem)
    }

    /// Reports a key whose value is out of its bound.
    pub fn out_of_bounds(&self, key: &Key, path: &str, span: &Span) -> Reported {
        let value = &self.text[span.clone()];
        self.report(span.clone(), Problem::out_of_bounds(path, value, key.bound, key.unit))
    }

    /// Reports a key that contradicts another one, or a rule.
    pub fn conflict(&self, key: &Key, span: Span, reason: String) -> Reported {
        let value = excerpt(&self.text[span.clone()]);
        self.report(span, Problem::Conflict { key: self.name_of(key), value, reason })
    }

    /// Reports a missing key, or the misspelt key in its place.
    pub fn missing(&mut self, key: &Key) -> Reported {
        match self.entries.iter().position(|entry| alike(&entry.name, key.name())) {
            Some(slip) => {
                let entry = self.entries.swap_remove(slip);
                self.unknown(&entry)
            }
            None => {
                let problem = Problem::Missing { key: self.name_of(key), bound: key.requirement() };
                self.report(self.span.start..self.span.start, problem)
            }
        }
    }

    /// Ends the table and reports every unknown key. Called before the values are used, so that
    /// other errors do not hide unknown keys.
    pub fn finish(&mut self) {
        for entry in std::mem::take(&mut self.entries) {
            self.unknown(&entry);
        }
    }

    /// Reports a problem.
    pub fn report(&self, span: Span, problem: Problem) -> Reported {
        self.faults.report(Fault { span, problem })
    }

    fn take(&mut self, key: &Key) -> Option<Node> {
        self.asked.push(key.name());
        let index = self.entries.iter().position(|entry| entry.name == key.name())?;
        Some(self.entries.swap_remove(index).node)
    }

    fn wrong_kind(&self, key: &Key, span: &Span, value: &Value) -> Reported {
        self.faults.report(wrong_kind(self.text, key, &self.name_of(key), span, value))
    }

    fn number_of(&self, key: &Key, path: &str, node: &Node) -> Read<f64> {
        match node.value {
            Value::Number(value) if key.bound.admits(value) => Ok(value),
            Value::Number(_) => Err(self.out_of_bounds(key, path, &node.span)),
            ref other => Err(self.wrong_kind(key, &node.span, other)),
        }
    }

    fn unknown(&self, entry: &Entry) -> Reported {
        let slip = self.asked.iter().find(|name| alike(&entry.name, name));
        let advice = match slip {
            Some(name) => format!("`{name}` is"),
            None => format!("its keys are {}", self.asked.join(", ")),
        };
        let table = self.numbered.as_deref().unwrap_or(self.path);
        let dot = if table.is_empty() { "" } else { "." };
        let key = format!("{table}{dot}{}", excerpt(&entry.name));
        let problem = Problem::Unknown { key, table: self.title.clone(), advice };
        self.report(entry.span.clone(), problem)
    }
}

fn alike(written: &str, name: &str) -> bool {
    // Comparing is quadratic in the length; no slip is longer than this.
    written.len() <= 2 * name.len() && strsim::jaro_winkler(written, name) >= ALIKE
}

fn wrong_kind(text: &str, key: &Key, name: &str, span: &Span, value: &Value) -> Fault {
    let problem = Problem::wrong_kind(key, name, &text[span.clone()], value.kind());
    Fault { span: span.clone(), problem }
}
