//! Just enough of a debugger to provoke a fault of the emulated processor from outside: GDB's remote
//! protocol over the emulator's socket.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;

/// A debugger that has stopped the processor.
pub struct Debugger(UnixStream);

impl Debugger {
    /// Connects, which stops the processor.
    ///
    /// # Errors
    /// Where the emulator has no such socket or does not understand.
    pub fn attach(socket: &Path) -> io::Result<Self> {
        let mut debugger = Self(UnixStream::connect(socket)?);
        debugger.ask("?")?;
        // The emulator lets only those set a register who have asked which there are.
        debugger.ask("qXfer:features:read:target.xml:0,ffb")?;
        Ok(debugger)
    }

    /// Sets the program counter.
    ///
    /// # Errors
    /// Where the emulator does not understand.
    pub fn jump(&mut self, address: u32) -> io::Result<()> {
        let bytes: String =
            address.to_le_bytes().iter().map(|byte| format!("{byte:02x}")).collect();
        // Register 15.
        match self.ask(&format!("Pf={bytes}"))?.as_str() {
            "OK" => Ok(()),
            said => Err(io::Error::other(format!("the emulator said {said}"))),
        }
    }

    /// Lets the processor run again, without a debugger.
    ///
    /// # Errors
    /// Where the emulator does not understand.
    pub fn detach(mut self) -> io::Result<()> {
        self.ask("D").map(drop)
    }

    /// Sends a packet and gives the answer's content.
    fn ask(&mut self, what: &str) -> io::Result<String> {
        let sum = what.bytes().fold(0_u8, u8::wrapping_add);
        write!(self.0, "${what}#{sum:02x}")?;
        loop {
            let said = self.packet()?;
            // That the processor has stopped is said whenever it does, too.
            if what == "?" || !said.starts_with('T') {
                return Ok(said);
            }
        }
    }

    fn packet(&mut self) -> io::Result<String> {
        // Acknowledgements come before the packet.
        while self.byte()? != b'$' {}
        let mut said = String::new();
        loop {
            match self.byte()? {
                b'#' => break,
                byte => said.push(byte.into()),
            }
        }
        // Its sum of two digits, over a socket that loses nothing.
        self.0.read_exact(&mut [0; 2])?;
        self.0.write_all(b"+")?;
        Ok(said)
    }

    fn byte(&mut self) -> io::Result<u8> {
        let mut byte = [0];
        self.0.read_exact(&mut byte)?;
        Ok(byte[0])
    }
}
