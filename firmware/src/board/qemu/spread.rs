//! What a run's measurements come to.

/// Smallest, largest and sum of a number of instructions.
#[derive(Clone, Copy)]
pub struct Spread {
    count: u32,
    min: u32,
    max: u32,
    sum: u64,
}

impl Spread {
    /// Of nothing.
    pub const EMPTY: Self = Self { count: 0, min: u32::MAX, max: 0, sum: 0 };

    /// Takes another one.
    pub fn add(&mut self, value: u32) {
        self.count += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += u64::from(value);
    }

    /// How many there were.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Tells the host, if there was any.
    pub fn log(&self, name: &str) {
        let Self { count, min, max, sum } = *self;
        if count > 0 {
            defmt::info!("spread={=str} count={} min={} max={} sum={}", name, count, min, max, sum);
        }
    }
}

/// How often each number of instructions was met, up to a largest.
pub struct Histogram {
    /// All of them.
    pub spread: Spread,
    often: [u16; LARGEST + 1],
}

/// More than a tick takes; what is larger counts as this.
const LARGEST: usize = 255;

impl Histogram {
    /// Of nothing.
    pub const EMPTY: Self = Self { spread: Spread::EMPTY, often: [0; LARGEST + 1] };

    /// Takes another one.
    pub fn add(&mut self, value: u32) {
        self.spread.add(value);
        if let Some(often) = self.often.get_mut((value as usize).min(LARGEST)) {
            *often = often.saturating_add(1);
        }
    }

    /// What 999 of 1000 do not exceed.
    pub fn usual(&self) -> u32 {
        let mut rest = self.often.iter().map(|often| u32::from(*often)).sum::<u32>();
        let allowed = rest / 1000;
        for (value, often) in (0..).zip(&self.often) {
            rest -= u32::from(*often);
            if rest <= allowed {
                return value;
            }
        }
        0
    }
}
