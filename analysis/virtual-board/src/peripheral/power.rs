//! Power control (RM0440, 6.4; RM0090, 5.4): voltage ranges, which are reached at once.

use super::registers::Registers;

/// The G4's: CR1 with the voltage range and the access to the backup domain, CR5 with the boost.
pub fn g4() -> Registers {
    Registers::new(&[
        (0x00, 0x0000_0200, 1 << 8),
        (0x08, 0x0000_8000, 1 << 14),
        (0x80, 0x0000_0100, 1 << 8),
    ])
}

/// The F405's: CR with the voltage scale and the access to the backup domain; CSR says that the
/// regulator is ready. The driver sets two bits of scale, of which this chip has the lower one.
pub fn f405() -> Registers {
    Registers::new(&[(0x00, 0x0000_4000, (0b11 << 14) | (1 << 8)), (0x04, 1 << 14, 0)])
}
