//! Messages while a server runs.

/// Reports events as text to the user who started the server.
pub type Report = Box<dyn Fn(&str) + Send + Sync>;
