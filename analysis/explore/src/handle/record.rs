//! The counts and codes of a servo, from its first tick on.

/// Largest number of kept ticks: a quarter of an hour at 1 kHz.
const MOST: usize = 1 << 20;

/// The counts and codes of a servo. Later rows are dropped when it is full, so that the beginning is kept.
#[derive(Clone, Debug, Default)]
pub struct Record {
    ticks: Vec<(i32, u16)>,
}

impl Record {
    /// Keeps a tick.
    pub fn add(&mut self, count: i32, code: u16) {
        if self.ticks.len() < MOST {
            self.ticks.push((count, code));
        }
    }

    /// Count and code of each tick.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.ticks.iter().flat_map(|&(count, code)| [f64::from(count), f64::from(code)])
    }
}
