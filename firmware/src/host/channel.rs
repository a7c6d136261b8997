//! The words of a host's commands and of their reports, between the task and the servo's interrupt.
//!
//! The interrupt runs to its end before the task continues. So the task writes a command into the slot that
//! the interrupt does not read, and then its number; and it reads a report again if the number changed
//! meanwhile.

use core::sync::atomic::{AtomicU32, Ordering};

/// A host's part of the mailbox; `()` without a host.
pub trait HostChannel {
    /// Before the first command.
    const EMPTY: Self;
}

impl HostChannel for () {
    const EMPTY: Self = ();
}

/// A command as words.
pub(super) type Command = [u32; 2];
/// A report as words.
pub(super) type Report = [u32; 9];

/// The last command, and the last report.
#[derive(Debug)]
pub struct HostWords {
    commands: [[AtomicU32; 2]; 2],
    /// Commands since the start; wraps.
    sent: AtomicU32,
    report: [AtomicU32; 9],
    /// The number of the reported command.
    reported: AtomicU32,
}

impl HostChannel for HostWords {
    const EMPTY: Self = Self {
        commands: [const { [const { AtomicU32::new(0) }; 2] }; 2],
        sent: AtomicU32::new(0),
        report: [const { AtomicU32::new(0) }; 9],
        reported: AtomicU32::new(0),
    };
}

impl HostWords {
    /// Replaces the command: for the task.
    pub(super) fn send(&self, command: Command) {
        let number = self.sent.load(Ordering::Relaxed).wrapping_add(1);
        for (place, word) in self.slot(number).iter().zip(command) {
            place.store(word, Ordering::Relaxed);
        }
        self.sent.store(number, Ordering::Release);
    }

    /// The last command and its number: for the interrupt.
    pub(super) fn command(&self) -> (u32, Command) {
        let number = self.sent.load(Ordering::Acquire);
        let [torque, rest] = self.slot(number);
        (number, [torque.load(Ordering::Relaxed), rest.load(Ordering::Relaxed)])
    }

    fn slot(&self, number: u32) -> &[AtomicU32; 2] {
        &self.commands[number as usize % 2]
    }

    /// Replaces the report by that of a command: for the interrupt.
    pub(super) fn publish(&self, number: u32, report: Report) {
        for (place, word) in self.report.iter().zip(report) {
            place.store(word, Ordering::Relaxed);
        }
        self.reported.store(number, Ordering::Release);
    }

    /// The last report, unless it is that of this command or is replaced meanwhile: for the task.
    pub(super) fn report_after(&self, last: u32) -> Option<(u32, Report)> {
        let number = self.reported.load(Ordering::Acquire);
        if number == last {
            return None;
        }
        let report = self.report.each_ref().map(|word| word.load(Ordering::Acquire));
        (self.reported.load(Ordering::Relaxed) == number).then_some((number, report))
    }
}
