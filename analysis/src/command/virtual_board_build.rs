//! Builds a virtual board and the program in its flash.

use std::path::PathBuf;

use haptic_servo::current::CurrentLoop;
use haptic_servo::servo::Transducers;

use super::building::{building, set_up};
use super::file_program::FileProgram;
use super::status::CommandError;
use crate::bridge_board::BridgeBoard;
use crate::compare_run::Backend;
use crate::program::Program;
use crate::toolchain::{BoardModel, NumberFormat, Tools, TorqueOutput};
use crate::virtual_board::{VirtualBoard, VirtualBoardError};

/// A virtual board, and the program for its flash.
pub struct VirtualBoardBuild {
    executable: PathBuf,
    board: BoardModel,
    elf: PathBuf,
    /// The current loop of the board's own bridge, with the encoder and the motor behind it.
    bridge: Option<(Box<CurrentLoop>, Transducers)>,
    is_magnetic: bool,
}

impl VirtualBoardBuild {
    /// Builds both, after installing missing tools.
    pub fn build(
        board: BoardModel,
        program: &'static Program,
        format: NumberFormat,
    ) -> Result<Self, CommandError> {
        let bridge = program.bridge.map(|bridge| (Box::new(bridge), program.transducers));
        Self::named(board, program.name, bridge, format)
    }

    /// The same of a program without a scene.
    pub fn named(
        board: BoardModel,
        name: &str,
        bridge: Option<(Box<CurrentLoop>, Transducers)>,
        format: NumberFormat,
    ) -> Result<Self, CommandError> {
        let toolchain = set_up(Tools::CompilerAndVirtualBoard)?;
        let output = if bridge.is_some() { TorqueOutput::Bridge } else { TorqueOutput::Dac };
        let (elf, executable) = building(&format!("{name} and the virtual board"), || {
            let elf = toolchain.build_for(board, output, &[name], format)?.swap_remove(0).path;
            Ok((elf, toolchain.build_virtual_board()?))
        })?;
        Ok(Self { executable, board, elf, bridge, is_magnetic: false })
    }

    /// The same with the program of a scene file.
    pub fn of_file(
        board: BoardModel,
        program: &FileProgram,
        format: NumberFormat,
    ) -> Result<Self, CommandError> {
        let toolchain = set_up(Tools::CompilerAndVirtualBoard)?;
        let elf = program.build(&toolchain, Some(board), format)?.path;
        let executable = building("the virtual board", || toolchain.build_virtual_board())?;
        let (bridge, is_magnetic) = (program.bridge.clone(), program.chip.is_some());
        Ok(Self { executable, board, elf, bridge, is_magnetic })
    }

    /// Boots a board whose program drives a DAC.
    pub fn boot(&self) -> Result<VirtualBoard, VirtualBoardError> {
        VirtualBoard::boot(&self.executable, self.board, &self.elf, None, self.is_magnetic)
    }

    /// Boots the board with a motor, if its program drives the board's own bridge.
    pub fn boot_bridge(&self) -> Result<Option<(BridgeBoard, &CurrentLoop)>, VirtualBoardError> {
        let Some((current_loop, transducers)) = &self.bridge else { return Ok(None) };
        let board = BridgeBoard::boot(
            &self.executable,
            self.board,
            &self.elf,
            current_loop,
            *transducers,
            self.is_magnetic,
        )?;
        Ok(Some((board, current_loop)))
    }

    /// The board as the backend of a comparison with the host; `period` is its servo's in s.
    pub fn backend(&self, period: f64) -> Backend<'_> {
        let program = &self.executable;
        let (board, elf, is_magnetic) = (self.board, &self.elf, self.is_magnetic);
        Backend::VirtualBoard { program, board, elf, period, is_magnetic }
    }
}
