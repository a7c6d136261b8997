//! Pictures as files.

use std::path::Path;

use super::error::ChartError;

#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub(super) svg: String,
}

/// Whether a file has this extension, in any case.
pub fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

impl Picture {
    /// Checks that a picture may have this file, before the work for it.
    pub fn check_name(path: &Path) -> Result<(), ChartError> {
        match has_extension(path, "svg") {
            true => Ok(()),
            false => Err(ChartError::Extension { path: path.to_owned() }),
        }
    }

    pub fn write(&self, path: &Path) -> Result<(), ChartError> {
        std::fs::write(path, &self.svg).map_err(|source| ChartError::Output {
            path: path.to_owned(),
            what: "picture",
            source,
        })
    }
}
