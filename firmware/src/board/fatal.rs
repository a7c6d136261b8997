//! What a panic and a fault of the processor become: a [`Fault`], with which the board ends its
//! program.

use core::arch::naked_asm;
use core::panic::PanicInfo;

#[cfg(feature = "board-qemu")]
use super::qemu::stop::end;
use super::stack;
#[cfg(feature = "stm32")]
use super::stm32::stop::{end, end_non_maskable};
use crate::fault::Fault;

/// None is reachable by input; this is for mistakes.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end(Fault::of_panic(info))
}

/// The processor's handler of the non-maskable interrupt, which is a fault of the chip.
#[cfg(feature = "stm32")]
#[unsafe(export_name = "NonMaskableInt")]
unsafe extern "C" fn non_maskable() -> ! {
    end_non_maskable()
}

/// The processor's handler of faults, first part: a stack that has run over cannot serve the second
/// part, so that gets a fresh one, and the old one's address to look at.
#[unsafe(export_name = "HardFault")]
#[unsafe(naked)]
unsafe extern "C" fn hard_fault() -> ! {
    naked_asm!(
        "mov r0, sp",
        "movw r1, #:lower16:_stack_start",
        "movt r1, #:upper16:_stack_start",
        "mov sp, r1",
        "b {faulted}",
        faulted = sym faulted,
    )
}

/// Where the processor stacks the address of the instruction that faulted, behind r0 to r3, r12 and
/// the return address; and the bytes that it stacks without the floating-point registers.
const STACKED_PC: u32 = 24;
const STACKED: u32 = 32;

/// The handler's second part, with the stack pointer as it was.
extern "C" fn faulted(stacked: u32) -> ! {
    let address = if stacked.is_multiple_of(4) && stack::holds(stacked, STACKED) {
        // SAFETY: a word of the stack, where the processor has just put it, above the frames that
        // have taken the stack's top again.
        unsafe { ((stacked + STACKED_PC) as *const u32).read_volatile() }
    } else {
        0
    };
    // SAFETY: the fault status may be read at any time.
    let status = unsafe { (*cortex_m::peripheral::SCB::PTR).cfsr.read() };
    end(Fault::HardFault { address, status })
}
