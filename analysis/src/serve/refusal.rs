//! Why a page does not get the wire of a board.

use thiserror::Error;

/// Why a page does not get the wire.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PageRefusal {
    /// It has asked another machine, whose name leads here.
    #[error(
        "the host is `{host}`, but this server is {own}: open the address that `haptic serve` has printed"
    )]
    Host {
        /// Whom it has asked.
        host: String,
        /// Who is here.
        own: String,
    },
    /// It is a page of someone else.
    #[error("the origin is `{origin}`: only the page of this server, or one from a file, may ask")]
    Origin {
        /// Whose.
        origin: String,
    },
    /// It does not know the secret.
    #[error("the token is missing or wrong: open the address that `haptic serve` has printed")]
    Token,
    /// There is another page.
    #[error("another page has the board, which serves one at a time: disconnect there first")]
    InUse,
    /// It has not read.
    #[error("the page has taken less than the board has sent: connect again")]
    TooSlow,
}

impl PageRefusal {
    /// The status of an answer, or the code with which a socket is closed: of those that are for such uses.
    pub const fn code(&self) -> u16 {
        match self {
            Self::Host { .. } | Self::Origin { .. } | Self::Token => 403,
            Self::InUse => 4000,
            Self::TooSlow => 4001,
        }
    }
}
