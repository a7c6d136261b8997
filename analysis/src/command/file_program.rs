//! The program of a scene file.

use std::path::Path;

use super::building::building;
use super::status::CommandError;
use crate::file::{SceneFile, program};
use crate::toolchain::{self, BoardModel, NumberFormat, Toolchain};

/// The longest name that a board tells its host, in bytes.
const LONGEST: usize = 32;

/// A program for boards whose constants are those of a scene file.
pub struct FileProgram {
    /// The file, as it was named.
    source: String,
    /// Its text.
    pub text: String,
    is_certified: bool,
}

impl FileProgram {
    /// The program of a file, which states encoder and motor if they are not given.
    pub fn of(
        file: &SceneFile,
        source: &str,
        counts_per_turn: Option<f64>,
        full_scale: Option<f64>,
    ) -> Result<Self, CommandError> {
        let failed = |why| CommandError::NoBoardProgram { file: source.to_owned(), why };
        let transducers = file.board_transducers(counts_per_turn, full_scale).map_err(failed)?;
        let text = program::program(file, &transducers, source).map_err(failed)?;
        let is_certified = file.scene.certify().is_ok();
        Ok(Self { source: source.to_owned(), text, is_certified })
    }

    /// Writes it out, and builds it for a board or the emulated board.
    pub fn build(
        &self,
        toolchain: &Toolchain,
        board: Option<BoardModel>,
        format: NumberFormat,
    ) -> Result<toolchain::Program, CommandError> {
        let file = toolchain.write_scene(self.name(), &self.text)?;
        let built = building(&self.source, || toolchain.build_written(&file, board, format));
        built.map_err(|why| CommandError::FileNotBuilt {
            file: self.source.clone(),
            why: Box::new(why),
            is_certified: self.is_certified,
        })
    }

    /// The name of the program: that of the file.
    fn name(&self) -> &str {
        let stem = Path::new(&self.source).file_stem().and_then(|stem| stem.to_str());
        match stem {
            Some(stem) if stem != "-" && !stem.contains(char::is_control) => {
                &stem[..stem.floor_char_boundary(LONGEST)]
            }
            _ => "scene",
        }
    }
}
