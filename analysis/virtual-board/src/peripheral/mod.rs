//! Peripherals at register level: of each only the parts that programs use. Any other access is an error that
//! names the register, never a silent zero.

pub mod adc;
pub mod analogue;
pub mod basic_timer;
pub mod checksum;
pub mod clock;
pub mod counter;
pub mod dac;
pub mod dma;
pub mod edges;
pub mod pins;
pub mod pwm_timer;
pub mod registers;
pub mod serial;
pub mod spi;
pub mod watchdog;

/// Why an access is not modelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unmodelled {
    /// The register is not.
    #[error("that register is not modelled")]
    Register,
    /// These bits of what was written are not.
    #[error("the bits {0:#010x} are not modelled in that register")]
    Bits(u32),
    /// The supply of a core whose clock rises so far at once is not.
    #[error("the core's clock rises too far at once")]
    ClockStep,
}

/// What an access gives.
pub type Access<T> = Result<T, Unmodelled>;

/// Whether a value has no other bits than these.
pub fn only(value: u32, modelled: u32) -> Access<()> {
    match value & !modelled {
        0 => Ok(()),
        others => Err(Unmodelled::Bits(others)),
    }
}
