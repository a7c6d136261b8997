//! Why the processor stopped executing.

/// Why the core has stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt {
    /// Something may have to be done before the next instruction.
    Attention,
    /// It waits for an interrupt.
    Waiting,
    /// It returns from an exception, with this word.
    Returning(u32),
    /// The bus has nothing there: an instruction, or data at the address.
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
