//! A figure with its bound, or with a peer that was measured in the same run.

use std::time::Instant;

use serde::Serialize;

use crate::studies::error::StudyError;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    pub name: String,
    pub value: f64,
    pub unit: &'static str,
    /// Its budget, or the peer's figure; in the same unit. `None` if there is neither.
    pub against: Option<f64>,
    /// `value / against` if both were measured in this run: below 1 is better for a cost.
    pub ratio: Option<f64>,
    /// Whether it is within its budget; `None` without one.
    pub met: Option<bool>,
    pub source: String,
}

/// A figure and its peer's, both measured in this run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    pub ours: f64,
    pub peers: f64,
}

impl Pair {
    /// Medians over rounds. Each round measures both, one after the other, so that other load of the machine
    /// affects both. A round before that fills caches and is discarded.
    pub fn in_turns<E>(
        rounds: usize,
        mut ours: impl FnMut() -> Result<f64, E>,
        mut peers: impl FnMut() -> Result<f64, E>,
    ) -> Result<Self, E> {
        ours()?;
        peers()?;
        let both: Vec<_> =
            (0..rounds).map(|_| Ok((ours()?, peers()?))).collect::<Result<_, E>>()?;
        let (ours, peers) = both.into_iter().unzip();
        Ok(Self { ours: median(ours), peers: median(peers) })
    }

    pub fn ratio(&self) -> f64 {
        self.ours / self.peers
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    pub value: f64,
    pub unit: &'static str,
    pub source: &'static str,
    pub bounds: Bounds,
}

/// From which side a budget bounds a figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    AtMost,
    AtLeast,
}

impl Budget {
    pub const fn of(value: f64, unit: &'static str) -> Self {
        Self { value, unit, source: "budget", bounds: Bounds::AtMost }
    }
}

impl Figure {
    pub fn alone(name: impl Into<String>, value: f64, unit: &'static str) -> Self {
        let (name, source) = (name.into(), String::new());
        Self { name, value, unit, against: None, ratio: None, met: None, source }
    }

    /// A figure with its budget, without a ratio.
    pub fn within(name: impl Into<String>, value: f64, budget: &Budget) -> Self {
        let &Budget { value: bound, unit, source, bounds } = budget;
        let (against, source) = (Some(bound), source.to_owned());
        let met = Some(match bounds {
            Bounds::AtMost => value <= bound,
            Bounds::AtLeast => value >= bound,
        });
        Self { against, met, source, ..Self::alone(name, value, unit) }
    }

    /// A figure with a peer of the same run; the source says so.
    pub fn beside(
        name: impl Into<String>,
        pair: Pair,
        unit: &'static str,
        source: impl Into<String>,
    ) -> Self {
        let (ratio, source) = (Some(pair.ratio()), format!("{}, same run", source.into()));
        Self { against: Some(pair.peers), ratio, source, ..Self::alone(name, pair.ours, unit) }
    }

    /// This figure measured again, in turns with a peer; the same figure with its budget if the peer is not
    /// available.
    pub fn again_beside(
        &self,
        peer: &str,
        measured: Result<(Pair, String), StudyError>,
    ) -> Result<Self, StudyError> {
        let name = format!("{}: beside {peer}", self.name);
        match measured {
            Ok((pair, source)) => Ok(Self::beside(name, pair, self.unit, source)),
            Err(StudyError::NoPeer(why)) => {
                let why = why.lines().next().unwrap_or_default();
                let source = format!("{}; {peer} is not available: {why}", self.source);
                Ok(Self { name, source, ..self.clone() })
            }
            Err(error) => Err(error),
        }
    }
}

/// Time of some work in s.
pub fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// The median of some values; 0 without values.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    /// One after the other, and without the round that fills caches.
    #[test]
    fn a_pair_is_measured_in_turns() {
        let log = RefCell::new(Vec::new());
        let measure = |who: char, values: [f64; 4]| {
            let (log, mut values) = (&log, values.into_iter());
            move || {
                log.borrow_mut().push(who);
                values.next().ok_or("too many rounds")
            }
        };
        let (ours, peers) =
            (measure('o', [99.0, 3.0, 1.0, 2.0]), measure('p', [0.0, 4.0, 8.0, 6.0]));
        let pair = Pair::in_turns(3, ours, peers).unwrap();
        assert_eq!((pair.ours, pair.ratio()), (2.0, 2.0 / 6.0));
        assert_eq!(log.into_inner(), ['o', 'p', 'o', 'p', 'o', 'p', 'o', 'p']);
    }

    #[test]
    fn a_budget_is_missed_on_its_side() {
        let least = Budget { bounds: Bounds::AtLeast, ..Budget::of(40.0, "instructions") };
        let met = |budget: &Budget| [39.0, 40.0, 42.0].map(|it| Figure::within("", it, budget).met);
        assert_eq!(met(&Budget::of(40.0, "instructions")), [Some(true), Some(true), Some(false)]);
        assert_eq!(met(&least), [Some(false), Some(true), Some(true)]);
        assert_eq!(Figure::alone("", 42.0, "instructions").met, None);
    }

    #[test]
    fn a_missing_peer_leaves_the_budget_and_no_ratio() {
        let alone = Figure::within("a step", 8.0, &Budget::of(10.0, "ns"));
        assert_eq!(alone.ratio, None);
        let missing = Err(StudyError::NoPeer("no cc\n(a cause)".to_owned()));
        let row = alone.again_beside("C", missing).unwrap();
        assert_eq!((row.value, row.against, row.ratio), (8.0, Some(10.0), None));
        assert_eq!(row.source, "budget; C is not available: no cc");
        assert!(serde_json::to_value(&row).unwrap()["ratio"].is_null());
        let broken = Err(StudyError::WrongPeer("another motion".to_owned()));
        assert!(alone.again_beside("C", broken).is_err());
    }
}
