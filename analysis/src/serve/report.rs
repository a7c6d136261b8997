//! Messages while a server runs.

/// What happens, in a sentence, for the one who started the server.
pub type Report = Box<dyn Fn(&str) + Send + Sync>;
