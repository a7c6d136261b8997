//! What a cycle does beside its scene.

/// What the servo does when the host falls silent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinkPolicy {
    /// Nothing: the host is not needed.
    #[default]
    Ignore,
    /// Goes on with the running set, and says in its status that the host was lost.
    Hold,
    /// Fades out and switches the amplifier off: a fault.
    Release,
}

/// What a cycle does beside its scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What to do when the host falls silent.
    pub link: LinkPolicy,
    /// Time in s without a message after which the host counts as lost.
    pub link_timeout: f64,
}

impl Options {
    /// Needs no host.
    pub const DEFAULT: Self = Self { link: LinkPolicy::Ignore, link_timeout: 1.0 };
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}
