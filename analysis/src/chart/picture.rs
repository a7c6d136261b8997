//! Pictures as files.

use std::path::{Path, PathBuf};

use super::error::ChartError;

/// A drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    svg: String,
}

/// The output file of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    path: PathBuf,
}

impl Output {
    /// A file with the extension `.svg` in any case.
    ///
    /// # Errors
    /// If it has another extension or none.
    pub fn new(path: &Path) -> Result<Self, ChartError> {
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg")) {
            return Ok(Self { path: path.to_owned() });
        }
        Err(ChartError::Extension { path: path.to_owned() })
    }

    /// Writes the picture.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, picture: &Picture) -> Result<(), ChartError> {
        std::fs::write(&self.path, &picture.svg)
            .map_err(|source| ChartError::Output { path: self.path.clone(), source })
    }
}

impl Picture {
    /// A picture from its SVG.
    pub(super) fn new(svg: String) -> Self {
        Self { svg }
    }

    /// As SVG.
    pub fn svg(&self) -> &str {
        &self.svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_named_as_svg() {
        let names = ["a.svg", "b.SVG"];
        assert_eq!(names.map(|name| Output::new(Path::new(name)).is_ok()), [true; 2]);
        for name in ["a.eps", "a.png", "svg", ""] {
            let error = Output::new(Path::new(name)).unwrap_err().to_string();
            assert!(error.contains("must end in .svg"), "{error}");
        }
    }
}
