//! Ticks that are missing in a record.

use std::fmt;

use serde::Serialize;

/// Ticks that are missing between those of a record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TickGaps {
    pub missing: u64,
    /// Places at which they are missing.
    pub gaps: u64,
    /// The last tick before the first of them.
    pub first_after: Option<u64>,
    /// Times at which the ticks began anew, with an unknown number of ticks missing.
    pub restarts: u64,
    #[serde(skip)]
    last: Option<u64>,
}

impl TickGaps {
    /// Adds the next tick of a record that has every `every`th.
    pub fn add(&mut self, tick: u64, every: u64) {
        let last = self.last.replace(tick);
        let Some(last) = last else { return };
        match tick.checked_sub(last) {
            None | Some(0) => self.restarts += 1,
            Some(step) => {
                let missing = (step - 1) / every.max(1);
                if missing == 0 {
                    return;
                }
                self.missing += missing;
                self.gaps += 1;
            }
        }
        self.first_after.get_or_insert(last);
    }

    pub fn is_none(&self) -> bool {
        self.first_after.is_none()
    }
}

impl fmt::Display for TickGaps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { missing, gaps, first_after, restarts, .. } = self;
        let Some(first) = first_after else { return f.write_str("no tick is missing") };
        write!(f, "{missing} ticks are missing in {gaps} gaps")?;
        if *restarts > 0 {
            write!(f, ", and the ticks begin anew {restarts} times")?;
        }
        write!(f, "; the first is after tick {first}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(ticks: &[u64], every: u64) -> String {
        let mut gaps = TickGaps::default();
        ticks.iter().for_each(|tick| gaps.add(*tick, every));
        gaps.to_string()
    }

    #[test]
    fn gaps_are_counted_and_the_first_is_named() {
        assert_eq!(of(&[7, 8, 9], 1), "no tick is missing");
        assert_eq!(of(&[0, 10, 20], 10), "no tick is missing");
        let gaps = of(&[0, 1, 5, 6, 8], 1);
        assert_eq!(gaps, "4 ticks are missing in 2 gaps; the first is after tick 1");
        let thinned = of(&[0, 10, 40], 10);
        assert_eq!(thinned, "2 ticks are missing in 1 gaps; the first is after tick 10");
        assert!(of(&[5, 6, 0, 1], 1).contains("begin anew 1 times; the first is after tick 6"));
    }
}
