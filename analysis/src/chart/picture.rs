//! Pictures as files.

use std::path::Path;

use super::error::ChartError;

/// A drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    svg: String,
}

/// Whether a file has this extension, in any case.
pub fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
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

    /// Checks that a picture may have this file, before the work for it.
    pub fn check_name(path: &Path) -> Result<(), ChartError> {
        match has_extension(path, "svg") {
            true => Ok(()),
            false => Err(ChartError::Extension { path: path.to_owned() }),
        }
    }

    /// Writes it to a file.
    pub fn write(&self, path: &Path) -> Result<(), ChartError> {
        std::fs::write(path, &self.svg).map_err(|source| ChartError::Output {
            path: path.to_owned(),
            what: "picture",
            source,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_named_as_svg() {
        assert!(["a.svg", "b.SVG"].iter().all(|name| Picture::check_name(Path::new(name)).is_ok()));
        for name in ["a.eps", "a.png", "svg", ""] {
            let error = Picture::check_name(Path::new(name)).unwrap_err().to_string();
            assert!(error.contains("must end in .svg"), "{error}");
        }
    }
}
