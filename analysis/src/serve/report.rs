//! Messages while a server runs.

/// Reports events in sentences, for the user who started the server.
pub type Report = Box<dyn Fn(&str) + Send + Sync>;
