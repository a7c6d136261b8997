//! Encoder and DAC of the emulated board: two pipes to a process on the host.
//!
//! Each tick the host writes a count (`i32`, little-endian) into the pipe `counts`, and the board
//! writes its DAC code (`u16`, little-endian) into the pipe `codes`; both are in the folder where
//! the emulator was started. The board waits for its count, so host and board cannot drift apart.
//! The host ends the run by closing `counts`.

use semihosting::fs::File;
use semihosting::io::{Read, Write};

use crate::dac::{Dac, DacCode};
use crate::encoder::{Encoder, RawCount};

/// The host's end could not be opened.
#[derive(Clone, Copy, Debug)]
pub struct NoHost;

/// Counts from the host.
pub struct Counts {
    pipe: File,
    last: RawCount,
    open: bool,
}

/// DAC codes to the host.
pub struct Codes {
    pipe: File,
    open: bool,
}

/// Opens both pipes, the host's first.
pub(super) fn pipes() -> Result<(File, File), NoHost> {
    let counts = File::open(c"counts").map_err(|_| NoHost)?;
    let codes = File::create(c"codes").map_err(|_| NoHost)?;
    Ok((counts, codes))
}

/// Opens both pipes as encoder and DAC.
pub fn open() -> Result<(Counts, Codes), NoHost> {
    let (counts, codes) = pipes()?;
    Ok((
        Counts { pipe: counts, last: RawCount::from(0_u32), open: true },
        Codes { pipe: codes, open: true },
    ))
}

impl Counts {
    /// Whether the host still answers.
    pub fn open(&self) -> bool {
        self.open
    }
}

impl Encoder for Counts {
    /// Waits for the host's count. Once the host has closed the pipe the count stands still, like
    /// that of a counter whose wheel does not turn.
    fn read(&mut self) -> RawCount {
        #[cfg(feature = "log")]
        let start = super::meter::now();
        let mut bytes = [0; 4];
        self.open = self.pipe.read_exact(&mut bytes).is_ok();
        if self.open {
            self.last = RawCount::from(u32::from_le_bytes(bytes));
        }
        #[cfg(feature = "log")]
        super::meter::LOCKSTEP.add(start);
        self.last
    }
}

impl Dac for Codes {
    /// Gives the code to the host; a host that has gone away ends the run at the next count.
    fn write(&mut self, code: DacCode) {
        #[cfg(feature = "log")]
        let start = super::meter::now();
        self.open = self.open && self.pipe.write_all(&code.get().to_le_bytes()).is_ok();
        #[cfg(feature = "log")]
        super::meter::LOCKSTEP.add(start);
    }
}
