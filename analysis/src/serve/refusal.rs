//! The reasons why a page does not get the wire of a board.

use thiserror::Error;

use super::http::HttpResponse;

/// The reason why a page does not get the wire.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PageRefusal {
    /// The request is for another host, whose name points to this machine.
    #[error(
        "the host is `{host}`, but this server is {own}: open the address that `haptic serve` has printed"
    )]
    Host {
        /// The requested host.
        host: String,
        /// This server's host.
        own: String,
    },
    /// The page has a foreign origin.
    #[error("the origin is `{origin}`: only the page of this server, or one from a file, may ask")]
    Origin {
        /// The origin.
        origin: String,
    },
    /// The token is missing or wrong.
    #[error("the token is missing or wrong: open the address that `haptic serve` has printed")]
    Token,
    /// Another page has the board.
    #[error("another page has the board, which serves one at a time: disconnect there first")]
    InUse,
    /// The page has read too slowly.
    #[error("the page has taken less than the board has sent: connect again")]
    TooSlow,
    /// The page sends, and has not the board, or no longer.
    #[error("this page has not the board: connect again")]
    Gone,
}

impl From<PageRefusal> for HttpResponse {
    fn from(refusal: PageRefusal) -> Self {
        let is_conflict = matches!(refusal, PageRefusal::InUse | PageRefusal::Gone);
        let status = if is_conflict { "409 Conflict" } else { "403 Forbidden" };
        Self::refusal(status, refusal.to_string())
    }
}
