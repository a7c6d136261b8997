//! Code in the G4 chips' core-coupled memory (CCM SRAM).
//!
//! At 170 MHz their flash has four wait states. A cache hides them from a loop, but not from an
//! interrupt that comes after a certificate has been through the cache; in the core-coupled memory
//! the servo's interrupt takes the same time whatever ran before. The F405's core-coupled memory is
//! not connected to the instruction bus, and its flash cache, which it has too, is what it is left
//! with.

use core::ptr::copy_nonoverlapping;

unsafe extern "C" {
    /// Where the code begins; like the other two a symbol of the linker's map, of which only the
    /// address means something.
    #[link_name = "__fast_start"]
    static mut START: u32;
    /// Where it ends.
    #[link_name = "__fast_end"]
    static mut END: u32;
    /// Where it is in flash.
    #[link_name = "__fast_load"]
    static LOAD: u32;
}

/// Copies the code to where it runs. To be called before anything there is.
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
