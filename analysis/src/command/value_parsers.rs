//! Numbers on the command line.

use std::ops::Range;
use std::time::Duration;

use crate::chart::is_range;

pub fn bounded(text: &str, bound: &str, admits: impl Fn(f64) -> bool) -> Result<f64, String> {
    let value = text.parse().ok().filter(|&value: &f64| value.is_finite() && admits(value));
    value.ok_or_else(|| format!("it must be {bound}"))
}

pub fn positive(text: &str) -> Result<f64, String> {
    bounded(text, "a number greater than 0", |value| value > 0.0)
}

/// Counts of an encoder in a turn: as many as a counter has.
pub fn counts(text: &str) -> Result<f64, String> {
    let bound = format!("a number from 1 to {}", u32::MAX);
    bounded(text, &bound, |value| (1.0..=f64::from(u32::MAX)).contains(&value))
}

pub fn not_negative(text: &str) -> Result<f64, String> {
    bounded(text, "a number, 0 or more", |value| value >= 0.0)
}

pub fn seconds(text: &str) -> Result<Duration, String> {
    let seconds =
        text.parse().map_err(|_| format!("`{text}` is not a valid duration in seconds"))?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(duration) if !duration.is_zero() => Ok(duration),
        _ => Err(format!("`{text}` must be a number of seconds greater than 0")),
    }
}

pub fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is not finite")) }
}

/// Two numbers with `..` between them, or with a colon.
pub fn range(text: &str) -> Result<Range<f64>, String> {
    /// The smallest width relative to the larger end: numbers along an axis must differ.
    const NARROWEST: f64 = 1e-9;
    let between = || text.split_once("..").or_else(|| text.split_once(':'));
    let (from, to) = between().ok_or("it must be two numbers with .. between")?;
    let range = number(from)?..number(to)?;
    let largest = range.start.abs().max(range.end.abs());
    if range.start >= range.end {
        Err(format!("{} must be less than {}", range.start, range.end))
    } else if !is_range(&range) || range.end - range.start < NARROWEST * largest {
        let (start, end) = (range.start, range.end);
        Err(format!("from {start:e} to {end:e} is not a range that an axis can show"))
    } else {
        Ok(range)
    }
}

/// A range of an axis that is logarithmic.
pub fn positive_range(text: &str) -> Result<Range<f64>, String> {
    let range = range(text)?;
    if range.start > 0.0 { Ok(range) } else { Err(format!("{} must be above 0", range.start)) }
}
