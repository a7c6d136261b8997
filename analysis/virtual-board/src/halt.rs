//! Why the processor stopped executing.

/// Why the core has stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt {
    /// An event may be due before the next instruction.
    Attention,
    /// It waits for an interrupt.
    Waiting,
    /// It returns from an exception, with this word.
    Returning(u32),
    /// There is no memory for an instruction, or for data at the address.
    NoMemory {
        /// Whether an instruction was fetched.
        fetch: bool,
        /// The address.
        address: u32,
    },
    /// No such instruction.
    Undefined,
    /// A breakpoint in the program.
    Breakpoint,
    /// Not in a state to execute: not Thumb.
    Invalid,
}
