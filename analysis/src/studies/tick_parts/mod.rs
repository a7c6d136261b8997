//! The parts of a tick in a program for the board: its linked instructions, attributed to the firmware's
//! functions from which they were compiled.
//!
//! The tick is compiled into the servo's interrupt as a whole, so its parts have no symbols; the program's
//! line tables show them.

mod listing;
mod part;

pub use part::Part;

use std::fs;
use std::path::Path;

use listing::{Instruction, ListingError, listing};
use serde::Serialize;

use crate::studies::error::StudyError;

/// The share of a part in a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Share {
    /// Instructions.
    pub instructions: u64,
    /// Instructions that multiply floating-point numbers.
    pub multiplications: u64,
    /// Bytes of code.
    pub bytes: u64,
}

/// The tick of a program, part by part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TickParts {
    shares: [Share; Part::ALL.len()],
}

impl TickParts {
    /// Determines the parts of the linked program in a file.
    pub fn of_file(path: &Path) -> Result<Self, StudyError> {
        let failed = |why: String| StudyError::Program { path: path.to_owned(), why };
        let elf = fs::read(path).map_err(|error| failed(error.to_string()))?;
        Self::of_elf(&elf).map_err(|error| failed(error.to_string()))
    }

    /// The program contains the tick twice, with and without [injected damping](Part::Injection), except for
    /// their common code.
    fn of_elf(elf: &[u8]) -> Result<Self, ListingError> {
        let mut parts = Self::default();
        listing(elf, |Instruction { functions, bytes, multiplies }| {
            if let Some(part) = Part::of(functions) {
                let share = &mut parts.shares[part as usize];
                share.instructions += 1;
                share.multiplications += u64::from(multiplies);
                share.bytes += bytes;
            }
        })?;
        Ok(parts)
    }

    /// Its share of a part; all zero if it does not contain the part.
    pub fn share(&self, part: Part) -> Share {
        self.shares[part as usize]
    }

    /// The tick as a whole.
    pub fn whole(&self) -> Share {
        self.shares.iter().fold(Share::default(), |sum, share| Share {
            instructions: sum.instructions + share.instructions,
            multiplications: sum.multiplications + share.multiplications,
            bytes: sum.bytes + share.bytes,
        })
    }
}
