//! The flash memory's interface (RM0440, 3.7; RM0090, 3.9): its wait states and caches, which an
//! instruction count does not see, the option bytes as it was delivered with, and its errors.

use super::registers::Registers;

/// The G4's ACR, ECCR and OPTR.
pub fn g4() -> Registers {
    Registers::new(&[(0x00, 0x0004_0600, 0x0004_0F0F), (0x18, 0, 0), (0x20, 0xFFEF_F8AA, 0)])
}

/// The F405's ACR and OPTCR.
pub fn f405() -> Registers {
    Registers::new(&[(0x00, 0, 0x0000_0707), (0x14, 0x0FFF_AAED, 0)])
}
