//! The measurements of a run on the emulated board, from the `key=value` lines of its log.

use super::EmulatorError;

/// The measurements of a run on the emulated board.
#[derive(Clone, Debug, PartialEq)]
pub struct EmulatorReport {
    /// Ticks of the running servo, without those in which it was armed or swapped its set.
    pub ticks: u64,
    /// Frames that the log missed because its queue was full.
    pub dropped: u64,
    /// Periods that began while the servo was still busy with one before.
    pub overruns: u64,
    /// The calibration of the instruction counts.
    pub calibration: Calibration,
    /// Instructions of a tick from raw count to DAC code, over all ticks, without those of the measurement.
    pub compute_instructions: InstructionStats,
    /// The same over the ticks with torque, in this or in the next tick (the torque of a delayed wall comes a
    /// tick later); `None` without such ticks.
    pub contact_instructions: Option<InstructionStats>,
    /// The same over the other ticks.
    pub free_instructions: Option<InstructionStats>,
    /// Instructions of the servo's whole interrupt.
    pub interrupt_instructions: InstructionStats,
    /// The same over the ticks with another code than the last; `None` without such ticks.
    pub changed_instructions: Option<InstructionStats>,
    /// Instructions of one call of the work below the interrupt; a set of parameters is certified in one
    /// call.
    pub below_instructions: InstructionStats,
    /// Instructions of the energy monitor in a tick.
    pub energy_instructions: InstructionStats,
    /// Instructions for putting a tick's frame into the queue.
    pub frame_instructions: InstructionStats,
    /// Instructions of the lockstep around a tick, with the exchange of count and code.
    pub lockstep_instructions: InstructionStats,
    /// Instructions for certifying the scene on the board.
    pub certify_instructions: u64,
    /// Bytes of stack used from reset until the scene was certified, which needs most of it.
    pub stack_used: u64,
    /// Size of the stack in bytes.
    pub stack_size: u64,
    /// The certificate's enclosures by the board.
    pub board: CertificateBits,
    /// The certificate's enclosures by the compiler.
    pub compiler: CertificateBits,
    /// All lines of the log.
    pub log: Vec<String>,
}

/// The calibration of the instruction counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Calibration {
    /// Counts of the board's timer per instruction.
    pub per_instruction: u64,
    /// Instructions of an empty measurement, subtracted from each.
    pub overhead: u64,
}

/// Enclosures as bits, `(lo, hi)`; `None` if an index does not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CertificateBits {
    /// Index of the environment alone.
    pub alpha: Option<(u64, u64)>,
    /// Index behind the coupling.
    pub alpha_coupled: Option<(u64, u64)>,
}

/// Numbers of instructions over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstructionStats {
    /// The number of values.
    pub count: u64,
    /// The smallest.
    pub min: u64,
    /// The largest.
    pub max: u64,
    /// Their mean.
    pub mean: f64,
}

impl EmulatorReport {
    /// Reads the log of a run.
    pub(super) fn read(log: Vec<String>) -> Result<Self, EmulatorError> {
        let number = |key: &str, line: &str| {
            let found = value(find(&log, &[&format!("{line}=")]), key);
            let (line, key) = (line.to_owned(), key.to_owned());
            found.ok_or_else(|| EmulatorError::NoNumber { line, key, log: log.join(" | ") })
        };
        let spread = |what: &str| InstructionStats::of(find(&log, &[&format!("spread={what}")]));
        let one = |what: &str| InstructionStats::joined(spread(what), None);
        let (contact, free) = (spread("contact"), spread("free"));
        let calibration = Calibration {
            per_instruction: number("per_instruction", "per_instruction")?,
            overhead: number("overhead", "per_instruction")?,
        };
        Ok(Self {
            ticks: number("ticks", "ticks")?,
            dropped: number("dropped", "ticks")?,
            overruns: number("overruns", "ticks")?,
            compute_instructions: InstructionStats::joined(contact, free),
            contact_instructions: contact,
            free_instructions: free,
            interrupt_instructions: one("interrupt"),
            changed_instructions: spread("changed"),
            below_instructions: one("below"),
            energy_instructions: one("energy"),
            frame_instructions: one("frame"),
            lockstep_instructions: one("lockstep"),
            certify_instructions: number("certify_time", "certify_time")?
                / calibration.per_instruction.max(1),
            stack_used: number("stack_used", "certify_time")?,
            stack_size: number("stack_size", "certify_time")?,
            board: CertificateBits::by(&log, "by=board"),
            compiler: CertificateBits::by(&log, "by=compiler"),
            calibration,
            log,
        })
    }
}

/// The line that has these words; a word that ends in `=` stands for that key with any value.
fn find<'l>(log: &'l [String], words: &[&str]) -> Option<&'l str> {
    let is =
        |found: &str, word: &str| found == word || word.ends_with('=') && found.starts_with(word);
    let has = |line: &str, word: &str| line.split(' ').any(|found| is(found, word));
    log.iter().map(String::as_str).find(|line| words.iter().all(|word| has(line, word)))
}

/// The number of a key in a line.
fn value(line: Option<&str>, key: &str) -> Option<u64> {
    line?.split(' ').find_map(|word| word.strip_prefix(key)?.strip_prefix('='))?.parse().ok()
}

impl CertificateBits {
    fn by(log: &[String], by: &str) -> Self {
        let ends = |index: &str| {
            let line = find(log, &[index, by]);
            Some((value(line, "lo")?, value(line, "hi")?))
        };
        Self { alpha: ends("enclosure=alpha"), alpha_coupled: ends("enclosure=alpha_coupled") }
    }
}

impl InstructionStats {
    /// Those of a line; none without values.
    fn of(line: Option<&str>) -> Option<Self> {
        let count = value(line, "count").filter(|count| *count > 0)?;
        let mean = value(line, "sum")? as f64 / count as f64;
        Some(Self { count, min: value(line, "min")?, max: value(line, "max")?, mean })
    }

    /// The statistics of two groups together; all zero without values.
    fn joined(a: Option<Self>, b: Option<Self>) -> Self {
        match (a, b) {
            (None, None) => Self { count: 0, min: 0, max: 0, mean: 0.0 },
            (Some(one), None) | (None, Some(one)) => one,
            (Some(a), Some(b)) => {
                let count = a.count + b.count;
                let sum = a.mean * a.count as f64 + b.mean * b.count as f64;
                let (min, max) = (a.min.min(b.min), a.max.max(b.max));
                Self { count, min, max, mean: sum / count as f64 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log() -> Vec<String> {
        let lines = "per_instruction=32 overhead=7
enclosure=alpha by=compiler lo=1 hi=2
enclosure=alpha by=board lo=1 hi=3
enclosure=alpha_coupled by=board lo=18446744073709551615 hi=5
certify_time=3200 stack_used=900 stack_size=1000
ticks=4 dropped=1 overruns=2
spread=contact count=1 min=50 max=50 sum=50
spread=free count=3 min=40 max=42 sum=122
spread=interrupt count=2 min=100 max=102 sum=202";
        lines.lines().map(str::to_owned).collect()
    }

    #[test]
    fn a_log_becomes_a_report() {
        let report = EmulatorReport::read(log()).unwrap();
        assert_eq!(report.calibration, Calibration { per_instruction: 32, overhead: 7 });
        assert_eq!((report.ticks, report.dropped, report.overruns), (4, 1, 2));
        assert_eq!(report.certify_instructions, 100);
        let compute = InstructionStats { count: 4, min: 40, max: 50, mean: 43.0 };
        assert_eq!(report.compute_instructions, compute);
        assert_eq!(report.interrupt_instructions.mean, 101.0);
        assert_eq!(report.compiler.alpha, Some((1, 2)));
        assert_eq!(report.compiler.alpha_coupled, None);
        assert_eq!(report.board.alpha_coupled, Some((u64::MAX, 5)));
    }

    #[test]
    fn a_log_that_lacks_a_line_says_which() {
        let log: Vec<_> = log().into_iter().filter(|line| !line.contains("ticks=")).collect();
        let error = EmulatorReport::read(log).unwrap_err();
        let said = "the board's log has no number ticks in a line of ticks; the log: ";
        assert!(error.to_string().starts_with(said), "{error}");
    }
}
