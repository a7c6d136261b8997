//! How long a host waits for a board, and how often it asks.

use std::num::NonZeroU32;
use std::time::Duration;

/// Timeouts for an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RetryTiming {
    /// Until the request is repeated: bytes get lost.
    pub again: Duration,
    /// Until the host gives up.
    pub end: Duration,
}

/// For a query: the board has the answer.
pub const QUERY: RetryTiming =
    RetryTiming { again: Duration::from_millis(250), end: Duration::from_secs(3) };
/// For a request to act: the board certifies a set, fades the torque out, swaps, and fades it in.
pub const REQUEST: RetryTiming =
    RetryTiming { again: Duration::from_secs(2), end: Duration::from_secs(10) };

/// Time between two status queries. For a board that stops without its host they are the sign of the host.
pub const STATUS_INTERVAL: Duration = Duration::from_millis(100);
/// Time between two tries to connect again.
pub const RETRY: Duration = Duration::from_millis(500);
/// Silence after which a link that gives no error counts as lost all the same.
pub const SILENCE: Duration = Duration::from_secs(3);

/// Ticks a second that are sent by default: as many as a serial line carries and as curves can show.
const RATE: f64 = 1000.0;

/// Interval in ticks between two ticks that are sent by default; `period` in s.
pub fn stream_every(period: f64) -> NonZeroU32 {
    // The cast saturates.
    NonZeroU32::new((1.0 / (period * RATE)).round() as u32).unwrap_or(NonZeroU32::MIN)
}
