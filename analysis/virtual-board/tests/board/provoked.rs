//! Faults that are provoked from outside: the shape of their tables, and what every one of them has to show.

use haptic_servo::fault::Fault;
use haptic_servo::servo_loop::State;
use virtual_board::chip::Chip;

use crate::bench::Bench;

/// A way to provoke a fault.
pub struct Case<T> {
    /// The fault's name.
    pub fault: &'static str,
    /// The cause.
    pub cause: &'static str,
    /// Periods from the cause within which the motor is off.
    pub bound: f64,
    /// A servo that pushes.
    pub begin: fn(&'static Chip) -> Bench,
    /// Provokes it.
    pub provoke: fn(&mut Bench) -> T,
    /// Whether the watchdog has to reset the board, which then says what it was.
    pub resets: bool,
    /// The fault, where its numbers are known.
    pub expected: Option<Fault>,
}

impl<T> Case<T> {
    /// On a servo that this begins, without a reset.
    pub const fn new(
        begin: fn(&'static Chip) -> Bench,
        fault: &'static str,
        cause: &'static str,
        bound: f64,
        provoke: fn(&mut Bench) -> T,
    ) -> Self {
        Self { fault, cause, bound, begin, provoke, resets: false, expected: None }
    }

    /// The same with the watchdog's reset.
    pub const fn resetting(self) -> Self {
        Self { resets: true, ..self }
    }

    /// The same on another servo.
    pub const fn on(self, begin: fn(&'static Chip) -> Bench) -> Self {
        Self { begin, ..self }
    }

    /// The same with a fault whose numbers are known.
    pub const fn told_as(self, fault: Fault) -> Self {
        Self { expected: Some(fault), ..self }
    }

    /// The case in words.
    pub fn what(&self) -> String {
        format!("{}: {}", self.fault, self.cause)
    }

    /// Checks the number of periods until the motor was off; gives it.
    pub fn check_bound(&self, clocks: u64, period: u64) -> f64 {
        let periods = clocks as f64 / period as f64;
        println!("{}: {periods:.3} periods", self.what());
        assert!(periods <= self.bound, "{}: {periods} periods", self.what());
        periods
    }

    /// The board says what it was, and whether it was reset for it; gives what it says.
    pub fn check_told(&self, bench: &mut Bench) -> Fault {
        let what = self.what();
        bench.run(50);
        assert_eq!(!bench.machine.resets().is_empty(), self.resets, "{what}");
        let told = bench.fault().unwrap_or_else(|| panic!("{what}"));
        assert_eq!(told.as_str(), self.fault, "{what}: {told}");
        assert_eq!(told, self.expected.unwrap_or(told), "{what}");
        let state = if self.resets { State::Disarmed } else { State::Faulted };
        assert_eq!(bench.status().state, state, "{what}");
        told
    }
}

/// Runs up to a time. What was broken is repaired once the board is reset, before it is used again.
pub fn run_on(bench: &mut Bench, until: u64) {
    while bench.now() < until {
        bench.run_for(1000);
        if !bench.machine.resets().is_empty() {
            let board = bench.board_mut();
            (board.broken, board.clock.crystal_runs) = (None, true);
        }
    }
}

/// Compares the end of a kept text with the table of what was measured, in periods, rounded up: instructions of a
/// tick, of which a period has 170,000, vary with the compiler.
pub fn check_kept<T>(
    kept: &str,
    cases: &[Case<T>],
    measured: &[(&str, Vec<f64>)],
    decimals: usize,
) {
    let names: Vec<_> = measured.iter().map(|(name, _)| *name).collect();
    let mut table = format!(
        "| fault | provoked by | promised | {} |\n|---|---|---{}|\n",
        names.join(" | "),
        "|---".repeat(names.len())
    );
    let unit = 10_f64.powi(decimals as i32);
    for (row, Case { fault, cause, bound, .. }) in cases.iter().enumerate() {
        table += &format!("| {fault} | {cause} | {bound} |");
        for (_, periods) in measured {
            table += &format!(" {:.decimals$} |", (periods[row] * unit).ceil() / unit);
        }
        table.push('\n');
    }
    assert!(kept.ends_with(&table), "the kept table is another than\n{table}");
}
