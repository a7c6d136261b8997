//! Code in the G4 chips' core-coupled memory (CCM SRAM).
//!
//! At 170 MHz their flash has four wait states. A cache hides them in a loop, but not in an interrupt after a
//! certificate has filled the cache. In the core-coupled memory the servo's interrupt takes the same time
//! after any other code. The F405's core-coupled memory is not connected to the instruction bus, so the F405
//! only has the cache of its flash.

use core::ptr::copy_nonoverlapping;

unsafe extern "C" {
    /// The beginning of the code; like the other two a symbol of the linker's map, of which only the address
    /// is used.
    #[link_name = "__fast_start"]
    static mut START: u32;
    /// The end of the code.
    #[link_name = "__fast_end"]
    static mut END: u32;
    /// The address of its copy in flash.
    #[link_name = "__fast_load"]
    static LOAD: u32;
}

/// Copies the code to its address in RAM. Call it before any of this code runs.
pub fn load() {
    let (start, end) = (&raw mut START, &raw const END);
    let words = (end.addr() - start.addr()) / size_of::<u32>();
    // SAFETY: the linker keeps the region from `START` to `END` for this code, and as many words of
    // flash at `LOAD`; both are aligned to words, and nothing runs there yet.
    unsafe { copy_nonoverlapping(&raw const LOAD, start, words) };
    // The writes complete before the fetch.
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
