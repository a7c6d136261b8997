//! The callbacks of the engine: before each instruction, for each access to a peripheral, and for everything
//! that it cannot execute itself.

use unicorn_engine::{HookType, MemType, RegisterARM, Unicorn};

use crate::board::VirtualBoard;
use crate::core::exceptions::Masks;
use crate::it_block::PcHistory;

/// The regions of peripherals, and of the core's own registers.
const REGIONS: [(u64, u64); 2] = [(0x4000_0000, 0x2000_0000), (0xE000_0000, 0x0010_0000)];
/// The engine's numbers of what interrupts it.
const BREAKPOINT: u32 = 7;
const RETURN_FROM_EXCEPTION: u32 = 8;

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
    NoMemory { fetch: bool, address: u32 },
    /// No such instruction.
    Undefined,
    /// A breakpoint in the program.
    Breakpoint,
    /// Not in a state to execute: not Thumb.
    Invalid,
}

/// The engine with its context.
pub type Engine<'a> = Unicorn<'a, Context>;

/// The context of the callbacks.
pub struct Context {
    /// The board.
    pub board: VirtualBoard,
    /// The time from which on the engine stops before the next instruction: when an event is due, or at once.
    deadline: u64,
    /// A masked exception is pending.
    masked: bool,
    /// Where the last instructions were.
    pub history: PcHistory,
    /// The reason if the engine was stopped.
    pub halt: Option<Halt>,
}

impl Context {
    /// A context of a board.
    pub fn new(board: VirtualBoard) -> Self {
        Self { board, deadline: 0, masked: false, history: PcHistory::default(), halt: None }
    }

    /// Begins a run up to a time; with `masked`, it also ends when the masks no longer block an exception.
    pub fn begin(&mut self, until: u64, masked: bool) {
        (self.deadline, self.masked, self.halt) = (until, masked, None);
    }

    /// After an access of the program to a peripheral: the next event may have changed.
    fn accessed(&mut self) {
        let board = &self.board;
        let at_once = board.wants_attention() || board.system.exceptions.any_pending();
        self.deadline = if at_once { 0 } else { self.deadline.min(board.due()) };
    }
}

/// Connects the callbacks to an engine with mapped memory.
pub fn wire(engine: &mut Engine<'static>) {
    for (base, size) in REGIONS {
        let read = move |engine: &mut Engine<'_>, offset: u64, size: usize| {
            let context = engine.get_data_mut();
            let value = context.board.read((base + offset) as u32, size);
            context.accessed();
            value.into()
        };
        let write = move |engine: &mut Engine<'_>, offset, size, value: u64| {
            let context = engine.get_data_mut();
            context.board.write((base + offset) as u32, size, value as u32);
            context.accessed();
        };
        engine.mmio_map(base, size, Some(read), Some(write)).expect("nothing else is there");
    }
    engine.add_code_hook(0, u64::MAX, before_instruction).expect(HAS_HOOK);
    engine.add_intr_hook(interrupted).expect(HAS_HOOK);
    let missing = |engine: &mut Engine<'_>, kind, address, _, _| {
        let fetch = matches!(kind, MemType::FETCH_UNMAPPED | MemType::FETCH_PROT);
        engine.get_data_mut().halt = Some(Halt::NoMemory { fetch, address: address as u32 });
        false
    };
    engine.add_mem_hook(HookType::MEM_INVALID, 0, u64::MAX, missing).expect(HAS_HOOK);
}

const HAS_HOOK: &str = "the engine has such hooks";

/// Counts an instruction and those that were skipped before it, or stops before it.
fn before_instruction(engine: &mut Engine<'_>, address: u64, size: u32) {
    let address = address as u32;
    let context = engine.get_data();
    let is_usual =
        context.board.now < context.deadline && !context.masked && context.history.is_next(address);
    // Half of a board's time is spent here, so the usual path only tests this.
    if !is_usual && !goes_on(engine, address) {
        return;
    }
    let context = engine.get_data_mut();
    context.history.push(address, size);
    context.board.now += 1;
}

/// Stops before an instruction if necessary, or counts the skipped instructions before it.
#[cold]
fn goes_on(engine: &mut Engine<'_>, address: u32) -> bool {
    let context = engine.get_data();
    if context.board.now >= context.deadline || (context.masked && is_unmasked(engine)) {
        stop(engine, Halt::Attention);
        return false;
    }
    if !context.history.is_next(address) {
        let mut history = context.history;
        let skipped = history.skip(address, |from, code| {
            // Without memory there is no IT block.
            let _ = engine.mem_read(from.into(), code);
        });
        let context = engine.get_data_mut();
        context.history = history;
        context.board.now += skipped;
    }
    true
}

/// Whether the masks allow an exception.
fn is_unmasked(engine: &Engine<'_>) -> bool {
    engine.get_data().board.system.exceptions.next(masks(engine)).is_some()
}

/// Called at an engine's interrupt: the core requests an action outside the engine.
fn interrupted(engine: &mut Engine<'_>, number: u32) {
    let halt = match number {
        BREAKPOINT => Halt::Breakpoint,
        RETURN_FROM_EXCEPTION => {
            let word = engine.reg_read(RegisterARM::PC).unwrap_or(0);
            Halt::Returning(word as u32)
        }
        _ => Halt::Invalid,
    };
    stop(engine, halt);
}

fn stop(engine: &mut Engine<'_>, why: Halt) {
    engine.get_data_mut().halt = Some(why);
    // Fails only if the engine does not run.
    let _ = engine.emu_stop();
}

/// The masks of exceptions.
pub fn masks(engine: &Engine<'_>) -> Masks {
    let read = |register| engine.reg_read(register).unwrap_or(0);
    Masks {
        primask: read(RegisterARM::PRIMASK) & 1 != 0,
        faultmask: read(RegisterARM::FAULTMASK) & 1 != 0,
        basepri: read(RegisterARM::BASEPRI) as u8,
    }
}
