//! Statistics of a run.

/// Smallest, largest and sum of a number of instructions.
#[derive(Clone, Copy)]
pub struct InstructionStats {
    count: u32,
    min: u32,
    max: u32,
    sum: u64,
}

impl InstructionStats {
    /// Statistics of no values.
    pub const EMPTY: Self = Self { count: 0, min: u32::MAX, max: 0, sum: 0 };

    /// Adds a value.
    pub fn add(&mut self, value: u32) {
        self.count += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += u64::from(value);
    }

    /// The number of values.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Logs the statistics, if there are values.
    pub fn log(&self, name: &str) {
        let Self { count, min, max, sum } = *self;
        if count > 0 {
            defmt::info!("spread={=str} count={} min={} max={} sum={}", name, count, min, max, sum);
        }
    }
}
