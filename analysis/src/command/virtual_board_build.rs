//! Builds a virtual board and the program that goes to its flash.

use std::path::PathBuf;

use super::status::CommandError;
use crate::compare_run::Backend;
use crate::progress;
use crate::toolchain::{self, Board, NumberFormat, Tools, TorqueOutput};
use crate::virtual_board::{VirtualBoard, VirtualBoardError};

/// A virtual board, and the program for its flash.
pub struct VirtualBoardBuild {
    program: PathBuf,
    board: Board,
    elf: PathBuf,
}

impl VirtualBoardBuild {
    /// Builds both, after setting up what is missing for that.
    pub fn build(board: Board, name: &str, format: NumberFormat) -> Result<Self, CommandError> {
        let tools = Tools::CompilerAndVirtualBoard;
        let toolchain = toolchain::prepare(tools, |step| eprintln!("set-up: {step}"))?;
        let spinner = progress::spinner(&format!("building {name} and the virtual board"));
        let output = toolchain.output_of(name)?;
        if output == TorqueOutput::Bridge {
            return Err(CommandError::BridgeInLockstep { program: name.to_owned() });
        }
        let elf = toolchain.build_for(board, output, &[name], format)?.swap_remove(0).path;
        let program = toolchain.build_virtual_board()?;
        spinner.finish_and_clear();
        Ok(Self { program, board, elf })
    }

    /// Switches it on.
    pub fn boot(&self) -> Result<VirtualBoard, VirtualBoardError> {
        VirtualBoard::boot(&self.program, self.board, &self.elf)
    }

    /// It as what runs beside the host; `period` is that of its servo in s.
    pub fn backend(&self, period: f64) -> Backend<'_> {
        Backend::VirtualBoard { program: &self.program, board: self.board, elf: &self.elf, period }
    }
}
