//! Ticks in which the servo does not run, so that the last torque stays (theory, section 8), or in which a reading of
//! the encoder fails (section 18.1).

/// Which ticks are missed, or which readings fail. Sample 0 is never.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Missed {
    /// None.
    #[default]
    None,
    /// The last ones of every so many ticks.
    Every {
        /// Ticks from the last of them to the last of the next, more than `length`.
        count: u32,
        /// How many are missed, one after the other.
        length: u32,
    },
    /// Each with this probability, the same ones for the same seed.
    Random {
        /// Probability, at least 0 and less than 1.
        fraction: f64,
        /// Seed.
        seed: u64,
    },
}

impl Missed {
    /// The first of so many ticks in which more in a row than allowed are missed.
    pub fn fault(self, allowed: u16, ticks: usize) -> Option<usize> {
        let mut missed = 0;
        if self == Self::None {
            return None;
        }
        self.ticks().take(ticks).position(|is_missed| {
            missed = if is_missed { missed + 1 } else { 0 };
            missed > allowed
        })
    }

    /// Whether a tick is missed, tick by tick.
    pub fn ticks(self) -> Ticks {
        let seed = if let Self::Random { seed, .. } = self { seed } else { 0 };
        Ticks { missed: self, random: fastrand::Rng::with_seed(seed), k: 0 }
    }
}

/// Whether each tick is missed.
#[derive(Clone, Debug)]
pub struct Ticks {
    missed: Missed,
    random: fastrand::Rng,
    k: u64,
}

impl Iterator for Ticks {
    type Item = bool;

    fn next(&mut self) -> Option<bool> {
        let k = self.k;
        self.k += 1;
        let missed = match self.missed {
            Missed::None => false,
            Missed::Every { count, length } => {
                let count = u64::from(count.max(1));
                k % count + u64::from(length) >= count
            }
            Missed::Random { fraction, .. } => self.random.f64() < fraction,
        };
        Some(missed && k > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misses_what_it_says() {
        let first = |missed: Missed| missed.ticks().take(10_000).collect::<Vec<_>>();
        let every = |count, length| first(Missed::Every { count, length });
        assert_eq!(every(2, 1)[..5], [false, true, false, true, false]);
        assert_eq!(every(3, 2)[..5], [false, true, true, false, true]);
        let random = first(Missed::Random { fraction: 0.1, seed: 7 });
        assert_eq!(random, first(Missed::Random { fraction: 0.1, seed: 7 }));
        let count = random.iter().filter(|&&missed| missed).count();
        assert!((900..1100).contains(&count), "{count}");
        assert!(!first(Missed::None).contains(&true));
    }
}
