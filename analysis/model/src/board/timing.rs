//! How long a host waits for a board, and how often it asks.

use std::num::NonZeroU32;
use std::time::Duration;

/// How long an answer is waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RetryTiming {
    /// Until it is asked again: bytes get lost.
    pub again: Duration,
    /// In all.
    pub end: Duration,
}

/// With what a board knows.
pub const QUERY: RetryTiming =
    RetryTiming { again: Duration::from_millis(250), end: Duration::from_secs(3) };
/// With what a board does: it certifies a set, fades the torque out, swaps, and fades it in.
pub const REQUEST: RetryTiming =
    RetryTiming { again: Duration::from_secs(2), end: Duration::from_secs(10) };

/// Time between two questions how it is going; also what the board hears of its host, where it stops
/// without one.
pub const STATUS_INTERVAL: Duration = Duration::from_millis(100);
/// Time between two tries to connect again.
pub const RETRY: Duration = Duration::from_millis(500);
/// Silence after which a link that gives no error counts as lost all the same.
pub const SILENCE: Duration = Duration::from_secs(3);

/// Ticks a second that are sent by default: as many as a serial line carries and as curves can show.
const RATE: f64 = 1000.0;

/// Of how many ticks one is sent by default, with a period in s.
pub fn stream_every(period: f64) -> NonZeroU32 {
    // The cast saturates.
    NonZeroU32::new((1.0 / (period * RATE)).round() as u32).unwrap_or(NonZeroU32::MIN)
}
