//! All that is wrong with a file, collected while it is read.

use std::cell::RefCell;

use super::problem::Fault;

/// A value that could not be read; why is among the [`Faults`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reported;

/// The value, or a reported error.
pub type Read<T> = Result<T, Reported>;

/// Errors in a file.
#[derive(Debug, Default)]
pub struct Faults(RefCell<Vec<Fault>>);

impl Faults {
    /// Adds one.
    pub fn report(&self, fault: Fault) -> Reported {
        self.0.borrow_mut().push(fault);
        Reported
    }

    /// All of them in the order of the text: people mend a file from the top.
    pub fn sorted(self) -> Vec<Fault> {
        let mut faults = self.0.into_inner();
        faults.sort_by_key(|fault| fault.span.start);
        faults
    }
}

/// All values read, unless a fault was reported. Each value is read, also after a fault.
pub fn all<T>(read: impl Iterator<Item = Read<T>>) -> Read<Vec<T>> {
    let read: Vec<Read<T>> = read.collect();
    read.into_iter().collect()
}
