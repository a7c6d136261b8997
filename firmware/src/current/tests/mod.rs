//! The current loop against a motor that is computed otherwise.
