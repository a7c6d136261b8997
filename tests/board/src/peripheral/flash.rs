//! The flash memory's interface (RM0440, 3.7; RM0090, 3.9): only its wait states and caches, which
//! an instruction count does not see.

use super::plain::Plain;

/// The G4's ACR.
pub fn g4() -> Plain {
    Plain::new(&[(0x00, 0x0004_0600, 0x0004_0F0F)])
}

/// The F405's ACR.
pub fn f405() -> Plain {
    Plain::new(&[(0x00, 0, 0x0000_0707)])
}
