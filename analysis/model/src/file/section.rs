//! Reads a table key by key; a key that is never read is unknown. Reading continues after an error, so
//! that a user who corrects a file sees all errors at once.

use std::fmt::Display;

use haptic_servo::parameter::Range;
use haptic_servo::scene::TimeRange;

use super::faults::{Faults, Read, Reported, all};
use super::key::{self, Bound, Form, Key, Presence};
use super::problem::{Fault, Problem, excerpt};
use super::tree::{Entry, Node, Span, Value};
use super::units;
use crate::quantity::significant;

/// Similarity of two names (0 to 1) from which one counts as a misspelling of the other. Chosen so that one
/// wrong, missing or swapped letter in a word of six still counts.
const ALIKE: f64 = 0.9;

/// What a number of a list must be.
const FINITE: &str = "a finite number";

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
    pub value: T,
    /// Bytes of the value in the text.
    pub span: Span,
}

/// Numbers with their places.
pub type Row = Found<Vec<Found<f64>>>;

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
        let (path, span, title) = (key.path, node.span, title.to_owned());
        let (asked, numbered, needed) = (Vec::new(), None, [].as_slice());
        let mut section =
            Self { text, faults, path, numbered, title, span, entries: vec![], asked, needed };
        match node.value {
            Value::Table(entries) => section.entries = entries,
            other => {
                let name = if path.is_empty() { "the file" } else { path };
                let (span, bound) = (&section.span, key.requirement());
                return Err(section.wrong_kind(name, span, other.kind(), &bound));
            }
        }
        Ok(section)
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

    pub fn needed_table(&mut self, key: &Key) -> Read<Self> {
        self.table(key)?.ok_or_else(|| self.missing(key))
    }

    /// The tables of that key in their order, or one in place of a list of one.
    pub fn tables_or_one(&mut self, key: &Key) -> Read<Option<Vec<Self>>> {
        let is_one = |entry: &Entry| matches!(entry.node.value, Value::Table(_));
        match self.entries.iter().find(|entry| entry.name == key.name()).is_some_and(is_one) {
            true => Ok(self.table(key)?.map(|table| vec![table])),
            false => self.tables(key),
        }
    }

    /// The tables of that key in their order, if it is there.
    pub fn tables(&mut self, key: &Key) -> Read<Option<Vec<Self>>> {
        let Some(items) = self.items(key)? else { return Ok(None) };
        let numbered = |(index, node): (usize, Node)| {
            let title = format!("[[{}]] number {}", key.path, index + 1);
            Self::new((self.text, self.faults), &title, key, node)
        };
        all(items.into_iter().enumerate().map(numbered)).map(Some)
    }

    /// Whether a key of that name is there, read or not.
    pub fn has(&self, key: &Key) -> bool {
        self.entries.iter().any(|entry| entry.name == key.name())
    }

    /// Bytes of the table in the text.
    pub fn span(&self) -> Span {
        self.span.clone()
    }

    /// Bytes of the value of a key in the text, in whatever table it was read; `None` if it is not there.
    pub fn place(&self, key: &Key) -> Option<Span> {
        self.faults.place(key.path)
    }

    /// The same; of a key that is not there, those of this table.
    pub fn place_of(&self, key: &Key) -> Span {
        self.place(key).unwrap_or_else(|| self.span())
    }

    /// The number of that key, if it is there.
    pub fn optional(&mut self, key: &Key) -> Read<Option<f64>> {
        let Some(node) = self.take(key) else { return Ok(None) };
        self.number_of(key, &self.name_of(key), &node, |value| key.bound.admits(value)).map(Some)
    }

    /// The number of that key, or of the key in its place, of [`key::RECIPROCALS`].
    pub fn or_reciprocal(&mut self, key: &Key) -> Read<Option<f64>> {
        let own = self.optional(key);
        let Some((other, _, product)) = key::RECIPROCALS.iter().find(|(_, of, _)| *of == key)
        else {
            return own;
        };
        let others = self.optional(other);
        match (own?, others?) {
            (own, None) => Ok(own),
            (None, Some(value)) if key.bound.admits(product / value) => Ok(Some(product / value)),
            (None, Some(_)) => Err(self.out_of_bounds(other)),
            (Some(_), Some(_)) => {
                let reason = format!("stands beside `{}`: leave out one of them", key.name());
                Err(self.conflict(other, reason))
            }
        }
    }

    /// The name of that key in a message; of a key whose number another states, of [`key::RECIPROCALS`], by that.
    pub fn stated(&self, key: &Key) -> String {
        let other = key::RECIPROCALS
            .iter()
            .find(|(other, of, _)| *of == key && self.place(other).is_some());
        match other {
            Some((other, _, product)) => format!("{product}/`{}`", other.path),
            None => format!("`{}`", key.path),
        }
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

    /// The time of that key in s, or the range that it lies in; 0 if it is not there.
    pub fn time(&mut self, key: &Key) -> Read<TimeRange> {
        let Some(node) = self.take(key) else { return Ok(TimeRange::ZERO) };
        let seconds = |place: &str, node: &Node| {
            let path = format!("{}{place}", key.path);
            self.number_of(key, &path, node, |value| Range::NotNegative.admits(value))
        };
        let time = match &node.value {
            Value::List(ends) => match &ends[..] {
                [least, most] => {
                    let (least, most) = (seconds("[0]", least), seconds("[1]", most));
                    TimeRange::between(least?, most?)
                }
                _ => return Err(self.out_of_bounds(key)),
            },
            _ => TimeRange::exactly(seconds("", &node)?),
        };
        if time.least > time.most {
            let reason = "is a range that ends before it begins: write [least, most]";
            return Err(self.conflict(key, reason));
        }
        Ok(time)
    }

    /// Checks that the time of that key is at most `longest` periods of the servo.
    pub fn check_time(&self, key: &Key, time: TimeRange, longest: f64, period: f64) -> Read<()> {
        if time.most <= longest * period {
            return Ok(());
        }
        let name = self.stated(&key::PERIOD);
        let times = if longest == 1.0 { String::new() } else { format!("{longest} times ") };
        let reason = format!("is more than {times}{name} = {period} s, the most that it may be");
        Err(self.conflict(key, reason))
    }

    /// The whole number of that key, as [`Section::number`].
    pub fn whole(&mut self, key: &Key) -> Read<usize> {
        Ok(self.number(key)? as usize)
    }

    pub fn needed_text(&mut self, key: &Key) -> Read<String> {
        self.text(key)?.ok_or_else(|| self.missing(key))
    }

    /// The string of that key, if it is there.
    pub fn text(&mut self, key: &Key) -> Read<Option<String>> {
        match self.take(key) {
            None => Ok(None),
            Some(Node { value: Value::Text(value), .. }) => Ok(Some(value)),
            Some(node) => Err(self.wrong_kind_of(key, &node)),
        }
    }

    /// The truth value of that key, if it is there.
    pub fn boolean(&mut self, key: &Key) -> Read<Option<bool>> {
        match self.take(key) {
            None => Ok(None),
            Some(Node { value: Value::Boolean(value), .. }) => Ok(Some(value)),
            Some(node) => Err(self.wrong_kind_of(key, &node)),
        }
    }

    /// The finite numbers of that key, if it is there.
    pub fn list(&mut self, key: &Key) -> Read<Option<Vec<f64>>> {
        let Some(items) = self.items(key)? else { return Ok(None) };
        let item = |(index, item): (usize, &Node)| {
            self.finite(format!("{}[{index}]", key.path), item, &key.requirement())
        };
        all(items.iter().enumerate().map(item)).map(Some)
    }

    /// The pairs of finite numbers of that key with their places, if it is there.
    pub fn pairs(&mut self, key: &Key) -> Read<Option<Vec<Pair>>> {
        let bound = "a pair of finite numbers, [angle in rad, torque in N m]";
        let Some(rows) = self.rows(key, &[2], bound)? else { return Ok(None) };
        Ok(Some(rows.into_iter().filter_map(|row| row.value.try_into().ok()).collect()))
    }

    /// The lists of finite numbers of that key with their places, if it is there. Each has one of these
    /// lengths; a number is a list of one. `bound` is what one must be.
    pub fn rows(&mut self, key: &Key, lengths: &[usize], bound: &str) -> Read<Option<Vec<Row>>> {
        let Some(items) = self.items(key)? else { return Ok(None) };
        let row = |(index, item): (usize, &Node)| {
            let name = format!("{}[{index}]", self.name_of(key));
            let numbers = match &item.value {
                Value::Number(_) => std::slice::from_ref(item),
                Value::List(numbers) => numbers,
                _ => &[],
            };
            if !lengths.contains(&numbers.len()) {
                let found = match &item.value {
                    Value::List(_) => "a list of another length",
                    other => other.kind(),
                };
                return Err(self.wrong_kind(&name, &item.span, found, bound));
            }
            let number = |(place, node): (usize, &Node)| {
                let value = self.finite(format!("{name}[{place}]"), node, FINITE)?;
                Ok(Found { value, span: node.span.clone() })
            };
            let value = all(numbers.iter().enumerate().map(number))?;
            Ok(Found { value, span: item.span.clone() })
        };
        all(items.iter().enumerate().map(row)).map(Some)
    }

    /// The values of a list.
    fn items(&mut self, key: &Key) -> Read<Option<Vec<Node>>> {
        match self.take(key) {
            None => Ok(None),
            Some(Node { value: Value::List(items), .. }) => Ok(Some(items)),
            Some(node) => Err(self.wrong_kind_of(key, &node)),
        }
    }

    /// A number of a list; `bound` is what a number that is not finite must be.
    fn finite(&self, name: String, node: &Node, bound: &str) -> Read<f64> {
        match node.value {
            Value::Number(value) if value.is_finite() => Ok(value),
            Value::Number(_) => Err(self.not_within(&name, &node.span, bound)),
            ref other => Err(self.wrong_kind(&name, &node.span, other.kind(), FINITE)),
        }
    }

    /// Reports a key whose value is out of its bound.
    pub fn out_of_bounds(&self, key: &Key) -> Reported {
        self.not_within(&self.name_of(key), &self.place_of(key), &key.requirement())
    }

    /// Reports a value that must be `bound`.
    pub fn not_within(&self, name: &str, span: &Span, bound: &str) -> Reported {
        self.wrong(name, span, format_args!("is out of bounds; it must be {bound}"))
    }

    /// Reports a key that contradicts another one, or a rule.
    pub fn conflict(&self, key: &Key, reason: impl Display) -> Reported {
        self.conflict_at(key, &self.place_of(key), reason)
    }

    /// The same at another place in the text.
    pub fn conflict_at(&self, key: &Key, span: &Span, reason: impl Display) -> Reported {
        self.wrong(&self.name_of(key), span, reason)
    }

    fn wrong_kind_of(&self, key: &Key, node: &Node) -> Reported {
        let mut bound = key.requirement();
        // A number in a string, mostly with its unit.
        if let (Bound::Number(_) | Bound::Other(Form::Time, _), Value::Text(text)) =
            (key.bound, &node.value)
            && let Some(value) = units::in_unit(text, key.unit)
        {
            bound += &format!("; did you mean {}?", significant(value, 6));
        }
        self.wrong_kind(&self.name_of(key), &node.span, node.value.kind(), &bound)
    }

    fn wrong_kind(&self, name: &str, span: &Span, found: &str, bound: &str) -> Reported {
        self.wrong(name, span, format_args!("is {found}; it must be {bound}"))
    }

    /// Reports a value that is there, with its fault.
    fn wrong(&self, name: &str, span: &Span, wrong: impl Display) -> Reported {
        self.report(span.clone(), Problem::value(name, &self.text[span.clone()], wrong))
    }

    /// Reports a missing key, or the misspelt key in its place.
    pub fn missing(&mut self, key: &Key) -> Reported {
        match self.entries.iter().position(|entry| alike(&entry.name, key.name())) {
            Some(slip) => {
                let entry = self.entries.swap_remove(slip);
                self.unknown(&entry)
            }
            None => {
                let missing = format!(" is missing; it must be {}", key.requirement());
                let problem = Problem::key_and(self.name_of(key), &missing);
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

    pub fn report(&self, span: Span, problem: Problem) -> Reported {
        self.faults.report(Fault { span, problem })
    }

    fn take(&mut self, key: &Key) -> Option<Node> {
        self.asked.push(key.name());
        let index = self.entries.iter().position(|entry| entry.name == key.name())?;
        let node = self.entries.swap_remove(index).node;
        self.faults.keep_place(key.path, node.span.clone());
        Some(node)
    }

    fn number_of(
        &self,
        key: &Key,
        path: &str,
        node: &Node,
        admits: impl Fn(f64) -> bool,
    ) -> Read<f64> {
        match node.value {
            Value::Number(value) if admits(value) => Ok(value),
            Value::Number(_) => Err(self.not_within(path, &node.span, &key.requirement())),
            _ => Err(self.wrong_kind_of(key, node)),
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
        let unknown = format!(" is not a key of {}; {advice}", self.title);
        self.report(entry.span.clone(), Problem::key_and(key, &unknown))
    }
}

fn alike(written: &str, name: &str) -> bool {
    // Comparing is quadratic in the length; no slip is longer than this.
    written.len() <= 2 * name.len() && strsim::jaro_winkler(written, name) >= ALIKE
}
