//! Nothing is exported: everything is in the integration tests.
