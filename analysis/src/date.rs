//! The date of a page.

use std::time::{SystemTime, UNIX_EPOCH};

use thiserror::Error;
use time::OffsetDateTime;

/// Environment variable for reproducible pages (reproducible-builds.org).
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// The requested time is invalid.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{EPOCH} = `{0}` is not a valid number of seconds since 1970-01-01, up to the year 9999")]
pub struct InvalidDate(String);

/// Today in UTC, as 2026-03-14; the day of `SOURCE_DATE_EPOCH` where that is set.
///
/// # Errors
/// If the text is not a time.
pub fn today() -> Result<String, InvalidDate> {
    let seconds = match std::env::var_os(EPOCH) {
        Some(text) => text.to_string_lossy().into_owned(),
        None => {
            let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
            since.as_secs().to_string()
        }
    };
    day(&seconds)
}

fn day(seconds: &str) -> Result<String, InvalidDate> {
    let time = seconds.parse().ok().and_then(|at| OffsetDateTime::from_unix_timestamp(at).ok());
    time.map(|time| time.date().to_string()).ok_or_else(|| InvalidDate(seconds.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_of_seconds() {
        assert_eq!(day("0").unwrap(), "1970-01-01");
        assert_eq!(day("951782400").unwrap(), "2000-02-29");
        for bad in ["", "soon", "1e9", "9999999999999999"] {
            assert_eq!(day(bad), Err(InvalidDate(bad.to_owned())));
        }
    }
}
