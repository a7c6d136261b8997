//! All errors of a file, collected while it is read.

use std::cell::RefCell;

use super::problem::Fault;

/// A value could not be read; the reason is in [`Faults`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reported;

/// The value, or a reported error.
pub type Read<T> = Result<T, Reported>;

/// Errors in a file.
#[derive(Debug, Default)]
pub struct Faults(RefCell<Vec<Fault>>);

impl Faults {
    /// Adds an error.
    pub fn report(&self, fault: Fault) -> Reported {
        self.0.borrow_mut().push(fault);
        Reported
    }

    /// All of them in the order of the text: users correct a file from the top.
    pub fn sorted(self) -> Vec<Fault> {
        let mut faults = self.0.into_inner();
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
