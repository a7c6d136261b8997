//! All errors of a file, collected while it is read, and the places of its values.

use std::cell::RefCell;
use std::collections::HashMap;

use super::problem::Fault;
use super::tree::Span;

/// A value could not be read; the reason is in [`Faults`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reported;

/// The value, or a reported error.
pub type Read<T> = Result<T, Reported>;

/// Errors in a file, and where its values stand.
#[derive(Debug, Default)]
pub struct Faults {
    faults: RefCell<Vec<Fault>>,
    places: RefCell<HashMap<&'static str, Span>>,
}

impl Faults {
    pub fn report(&self, fault: Fault) -> Reported {
        self.faults.borrow_mut().push(fault);
        Reported
    }

    /// Keeps the place of a key's value; of a list of tables, that in the table read last.
    pub fn keep_place(&self, path: &'static str, span: Span) {
        self.places.borrow_mut().insert(path, span);
    }

    /// The place of a key's value, if it has been read.
    pub fn place(&self, path: &str) -> Option<Span> {
        self.places.borrow().get(path).cloned()
    }

    /// All errors in the order of the text: users correct a file from the top.
    pub fn sorted(self) -> Vec<Fault> {
        let mut faults = self.faults.into_inner();
        faults.sort_by_key(|fault| fault.span.start);
        faults
    }
}

/// All values, unless one of them was reported. Reading continues after an error, so that all errors are
/// found.
pub fn all<T>(read: impl Iterator<Item = Read<T>>) -> Read<Vec<T>> {
    let read: Vec<Read<T>> = read.collect();
    read.into_iter().collect()
}
