//! Measures the largest use of the stack.

/// Pattern that fills unused stack.
const PAINT: u32 = 0xCCCC_CCCC;

unsafe extern "C" {
    /// The linker script's symbol for the first address above the stack; only its address is used.
    #[link_name = "_stack_start"]
    static TOP: u32;
    /// The symbol for the stack's lowest address.
    #[link_name = "_stack_end"]
    static BOTTOM: u32;
}

/// Bytes that have not been written since the reset.
pub fn unused() -> u32 {
    let (bottom, top) = (&raw const BOTTOM, &raw const TOP);
    let mut lowest = bottom;
    // SAFETY: reads words between the ends of the stack, which are RAM. Only an interrupt may write below the
    // current frame meanwhile, and its words are not the pattern either.
    while lowest < top && unsafe { lowest.read_volatile() } == PAINT {
        lowest = lowest.wrapping_add(1);
    }
    lowest.addr().wrapping_sub(bottom.addr()) as u32
}

/// Size of the stack in bytes.
pub fn size() -> u32 {
    ((&raw const TOP).addr() - (&raw const BOTTOM).addr()) as u32
}

/// Whether an address and this number of bytes above it are in the stack.
pub fn holds(address: u32, bytes: u32) -> bool {
    let (bottom, top) = ((&raw const BOTTOM).addr() as u32, (&raw const TOP).addr() as u32);
    address >= bottom && address < top && top - address >= bytes
}
