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

/// How often each number of instructions was met, from a smallest up to a largest.
pub struct Histogram {
    /// All of them.
    pub spread: Spread,
    often: [u16; NUMBERS],
}

/// Fewer than any scene's tick takes; what is smaller counts as this.
const SMALLEST: u32 = 112;
/// As many numbers as the ticks' lie among; what is larger counts as the largest of them.
const NUMBERS: usize = 192;

impl Histogram {
    /// Of nothing.
    pub const EMPTY: Self = Self { spread: Spread::EMPTY, often: [0; NUMBERS] };

    /// Takes another one.
    pub fn add(&mut self, value: u32) {
        self.spread.add(value);
        let place = value.saturating_sub(SMALLEST) as usize;
        if let Some(often) = self.often.get_mut(place.min(NUMBERS - 1)) {
            *often = often.saturating_add(1);
        }
    }

    /// What 999 of 1000 do not exceed.
    pub fn usual(&self) -> u32 {
        let mut rest = self.often.iter().map(|often| u32::from(*often)).sum::<u32>();
        let allowed = rest / 1000;
        for (value, often) in (SMALLEST..).zip(&self.often) {
            rest -= u32::from(*often);
            if rest <= allowed {
                return value;
            }
        }
        0
    }
}
