//! Instructions of the servo's interrupt, counted from outside without overhead.

/// Numbers of instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstructionStats {
    /// The number of values.
    pub count: u64,
    /// The smallest.
    pub least: u64,
    /// The largest.
    pub most: u64,
    /// The sum.
    pub sum: u64,
}

impl Default for InstructionStats {
    fn default() -> Self {
        Self { count: 0, least: u64::MAX, most: 0, sum: 0 }
    }
}

impl InstructionStats {
    fn add(&mut self, number: u64) {
        self.count += 1;
        self.least = self.least.min(number);
        self.most = self.most.max(number);
        self.sum += number;
    }
}

/// The measurements of each tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Meter {
    compute: InstructionStats,
    interrupt: InstructionStats,
    /// The times at which the interrupt began and read the encoder.
    began: Option<u64>,
    read: Option<u64>,
}

impl Meter {
    /// From reading the encoder's counter to writing the DAC's code, both included.
    pub fn compute(&self) -> InstructionStats {
        self.compute
    }

    /// From the interrupt's first instruction to its last.
    pub fn interrupt(&self) -> InstructionStats {
        self.interrupt
    }

    /// The servo's interrupt begins.
    pub(crate) fn begin(&mut self, now: u64) {
        (self.began, self.read) = (Some(now), None);
    }

    /// The encoder is read.
    pub(crate) fn read(&mut self, now: u64) {
        if self.began.is_some() {
            self.read = Some(now);
        }
    }

    /// A code is written.
    pub(crate) fn write(&mut self, now: u64) {
        if let Some(read) = self.read.take() {
            self.compute.add(now - read + 1);
        }
    }

    /// The interrupt ends.
    pub(crate) fn end(&mut self, now: u64) {
        if let Some(began) = self.began.take() {
            self.interrupt.add(now - began);
        }
    }
}
