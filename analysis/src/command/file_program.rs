//! The program of a scene file, or of the examples' paddle for the device of a file.

use std::path::Path;

use haptic_servo::current::CurrentLoop;
use haptic_servo::magnetic::Chip;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

use super::building::building;
use super::status::CommandError;
use crate::file::{DeviceFile, SceneFile, key, program};
use crate::program::Program;
use crate::toolchain::{
    self, BoardModel, NumberFormat, OtherDevice, Sources, Toolchain, TorqueOutput,
};

/// The longest name that a board tells its host, in bytes.
const LONGEST: usize = 32;

/// A program for boards whose constants are those of a scene file.
pub struct FileProgram {
    source: String,
    pub text: String,
    is_certified: bool,
    /// The chip of the magnetic encoder that it reads.
    pub chip: Option<&'static Chip>,
    /// The current loop of the board's own bridge that makes its torques; none where a DAC does.
    pub bridge: Option<(Box<CurrentLoop>, Transducers)>,
}

impl FileProgram {
    /// The program of a file, which states encoder and motor if they are not given; for a board's own bridge if
    /// the file has a motor for it.
    pub fn of(
        file: &SceneFile,
        source: &str,
        counts_per_turn: Option<f64>,
        full_scale: Option<f64>,
    ) -> Result<Self, CommandError> {
        let failed = |why| CommandError::NoBoardProgram { file: source.to_owned(), why };
        let transducers = file.board_transducers(counts_per_turn, full_scale).map_err(failed)?;
        let bridge = file.on_bridge(&transducers).map_err(failed)?;
        let text = program::program(file, &transducers, bridge.as_ref(), source).map_err(failed)?;
        let is_certified = file.scene.certify().is_ok();
        let bridge = bridge.map(|bridge| (Box::new(bridge.current_loop), transducers));
        Ok(Self { source: source.to_owned(), text, is_certified, chip: file.chip, bridge })
    }

    /// A program of the examples with the device of a file in place of the paddle.
    pub fn on_device(name: &str, source: &str, file: &DeviceFile) -> Result<Self, CommandError> {
        let device = other_device(source, file)?;
        let text = Sources::find()?.on_device(name, &device)?;
        let scene = Program::find(name).map(|program| program.scene);
        let is_certified =
            scene.is_none_or(|scene| Scene { device: file.device, ..scene }.certify().is_ok());
        Ok(Self { source: name.to_owned(), text, is_certified, chip: file.chip, bridge: None })
    }

    /// Refuses readings that fail on a virtual board without a chip, unless its counts may stand for them.
    pub fn check_dropped(&self, counts_do_not: bool) -> Result<(), CommandError> {
        if self.chip.is_some() || !counts_do_not {
            return Ok(());
        }
        Err(dropped_refused(
            "the virtual board counts its encoder's edges, which do not fail: state `encoder.chip`",
        ))
    }

    /// What makes its torques.
    pub fn output(&self) -> TorqueOutput {
        if self.bridge.is_some() { TorqueOutput::Bridge } else { TorqueOutput::Dac }
    }

    /// Writes it out, and builds it for a board or the emulated board.
    pub fn build(
        &self,
        toolchain: &Toolchain,
        board: Option<BoardModel>,
        format: NumberFormat,
    ) -> Result<toolchain::Program, CommandError> {
        let file = toolchain.write_scene(self.name(), &self.text)?;
        let built = building(&self.source, || {
            let board = board.map(|board| (board, self.output()));
            toolchain.build_written(&file, board, format, self.chip)
        });
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

/// The reason why a command does not simulate readings that fail.
pub fn dropped_refused(why: &str) -> CommandError {
    let key = key::FAILED.path;
    let error =
        format!("`{key}` cannot be used here: {why}; `--target host` and `haptic simulate` use it");
    CommandError::Failed(error.into())
}

/// The device of a file, for a program.
pub fn other_device(source: &str, file: &DeviceFile) -> Result<OtherDevice, CommandError> {
    let failed = |why| CommandError::NoBoardProgram { file: source.to_owned(), why };
    let transducers = file.transducers.of_board().map_err(failed)?;
    if file.device.passivity.is_some_and(f64::is_nan) {
        let why = "the device has no passivity in a hand, so no scene is certified on it";
        return Err(failed(why.to_owned()));
    }
    let module = program::device_module(&file.device, &transducers, file.chip, source);
    Ok(OtherDevice { module, chip: file.chip })
}
