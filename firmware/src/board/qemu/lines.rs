//! The inputs and outputs of the emulated board. In place of the registers of an encoder's counter, a DAC and
//! a pin it has words of memory, which the [lockstep](super::lockstep) exchanges with the host around each
//! tick.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use crate::dac::DacCode;
use crate::encoder::RawCount;

/// The encoder's counter.
static COUNT: AtomicU32 = AtomicU32::new(0);
/// The DAC's code.
static CODE: AtomicU32 = AtomicU32::new(DacCode::MID_SCALE.get() as u32);
/// Whether the amplifier is on.
static AMPLIFIER: AtomicBool = AtomicBool::new(false);

/// The encoder's counter.
#[inline(always)]
pub fn count() -> RawCount {
    RawCount::from(COUNT.load(Ordering::Relaxed))
}

/// Sets the encoder's counter.
pub fn set_count(count: u32) {
    COUNT.store(count, Ordering::Relaxed);
}

/// Writes a code to the DAC.
#[inline(always)]
pub fn write(code: DacCode) {
    CODE.store(u32::from(code.get()), Ordering::Relaxed);
}

/// Switches the amplifier.
#[inline(always)]
pub fn amplifier(on: bool) {
    AMPLIFIER.store(on, Ordering::Relaxed);
}

/// The DAC's code and the amplifier's state.
pub fn outputs() -> (u16, bool) {
    (CODE.load(Ordering::Relaxed) as u16, AMPLIFIER.load(Ordering::Relaxed))
}

/// Sets the torque to zero and switches the amplifier off.
pub fn stop() {
    amplifier(false);
    write(DacCode::MID_SCALE);
}
