//! Turns a panic and a fault of the processor into a [`Fault`], with which the board ends its program.

use core::arch::naked_asm;
use core::panic::PanicInfo;

#[cfg(feature = "board-qemu")]
use super::qemu::stop::end;
use super::stack;
#[cfg(feature = "stm32")]
use super::stm32::stop::{end, end_non_maskable};
use crate::fault::Fault;

/// No input causes a panic; this handler is for programming errors.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end(Fault::of_panic(info))
}

/// The handler of the non-maskable interrupt, which reports a fault of the chip.
#[cfg(feature = "stm32")]
#[unsafe(export_name = "NonMaskableInt")]
unsafe extern "C" fn non_maskable() -> ! {
    end_non_maskable()
}

/// The first part of the processor's fault handler. A stack that has overflowed cannot serve the second part,
/// so the second part gets a fresh stack and the address of the old one.
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

/// Offset of the address of the faulting instruction in the frame that the processor stacks, after r0 to r3,
/// r12 and the return address; and the size of that frame in bytes without the floating-point registers.
const STACKED_PC: u32 = 24;
const STACKED: u32 = 32;

/// The second part of the handler, with the stack pointer from before.
extern "C" fn faulted(stacked: u32) -> ! {
    let address = if stacked.is_multiple_of(4) && stack::holds(stacked, STACKED) {
        // SAFETY: a word of the stack that the processor has just written, above the frames that reuse the
        // top of the stack.
        unsafe { ((stacked + STACKED_PC) as *const u32).read_volatile() }
    } else {
        0
    };
    // SAFETY: the fault status may be read at any time.
    let status = unsafe { (*cortex_m::peripheral::SCB::PTR).cfsr.read() };
    end(Fault::HardFault { address, status })
}
