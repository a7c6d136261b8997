//! The core's instructions, executed by `unicorn-engine`: its registers, its memory, and the places
//! where it stops.
//!
//! The engine knows nothing of exceptions on this core. It stops before an instruction once
//! something may have to be done between two of them; at a wait for an interrupt; at a return from
//! an exception; and at what it cannot execute. Inside of a conditional block it does not stop: it
//! finishes the block first, so that an interrupt comes up to four instructions later there.

use unicorn_engine::{Arch, ArmCpuModel, Mode, Prot, RegisterARM, Unicorn, uc_error};

use crate::board::Board;
use crate::conditional::Trail;
use crate::core::exceptions::Masks;

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

/// What the engine's callbacks work with.
struct Context {
    board: Board,
    /// When something is due.
    deadline: u64,
    /// A stop before the next instruction.
    attention: bool,
    /// An exception waits for its mask to fall.
    masked: bool,
    /// Where the last instruction was.
    address: u32,
    /// Where those before it were.
    trail: Trail,
    halt: Option<Halt>,
}

/// The core.
pub struct Processor {
    engine: Unicorn<'static, Context>,
}

/// An address at which nothing is ever executed, since a run has to end somewhere.
const NOWHERE: u64 = 0xFFFF_FFF0;
/// The regions of peripherals, and of the core's own registers.
const REGIONS: [(u64, u64); 2] = [(0x4000_0000, 0x2000_0000), (0xE000_0000, 0x0010_0000)];
/// CONTROL: the floating-point registers are in use.
const IN_USE: u32 = 1 << 2;
/// The same with the bit of the same meaning that later cores have in their secure state, in which the
/// engine believes itself: without it, the next floating-point instruction would begin with a status
/// of zero.
const IN_USE_TO_THE_ENGINE: u32 = 0b11 << 2;
/// A wait for an event, as an instruction: the engine takes it for an unknown one.
const WAIT_FOR_EVENT: u16 = 0xBF20;
/// The engine's numbers of what interrupts it.
const BREAKPOINT: u32 = 7;
const RETURN_FROM_EXCEPTION: u32 = 8;

impl Processor {
    /// A core with a chip's memory, which holds noise, and its board.
    pub fn new(board: Board) -> Self {
        let chip = board.chip();
        let context = Context {
            board,
            deadline: 0,
            attention: false,
            masked: false,
            address: 0,
            trail: Trail::default(),
            halt: None,
        };
        let mode = Mode::THUMB | Mode::MCLASS;
        let mut engine =
            Unicorn::new_with_data(Arch::ARM, mode, context).expect("the engine has this core");
        engine.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32).expect("the engine has this core");
        let coupled = if chip.coupled.1 { Prot::ALL } else { Prot::READ | Prot::WRITE };
        for (base, size, access) in [
            (0x0800_0000, chip.flash, Prot::READ | Prot::EXEC),
            (0x2000_0000, chip.ram, Prot::ALL),
            (0x1000_0000, chip.coupled.0, coupled),
        ] {
            engine.mem_map(base, size.into(), access).expect("the chip's memories do not overlap");
        }
        let mut core = Self { engine };
        core.wire();
        for (base, size) in [(0x2000_0000, chip.ram), (0x1000_0000, chip.coupled.0)] {
            core.fill_with_noise(base, size);
        }
        core
    }

    /// The engine's callbacks.
    fn wire(&mut self) {
        let engine = &mut self.engine;
        for (base, size) in REGIONS {
            let read = move |engine: &mut Unicorn<'_, Context>, offset: u64, size: usize| {
                let context = engine.get_data_mut();
                let value = context.board.read((base + offset) as u32, size);
                context.accessed();
                value.into()
            };
            let write = move |engine: &mut Unicorn<'_, Context>, offset, size, value: u64| {
                let context = engine.get_data_mut();
                context.board.write((base + offset) as u32, size, value as u32);
                context.accessed();
            };
            engine.mmio_map(base, size, Some(read), Some(write)).expect("nothing else is there");
        }
        engine.add_code_hook(0, u64::MAX, before_instruction).expect("the engine has such hooks");
        engine.add_intr_hook(interrupted).expect("the engine has such hooks");
        engine
            .add_mem_hook(
                unicorn_engine::HookType::MEM_INVALID,
                0,
                u64::MAX,
                |engine, kind, address, _, _| {
                    use unicorn_engine::MemType;
                    let fetch = matches!(kind, MemType::FETCH_UNMAPPED | MemType::FETCH_PROT);
                    let address = address as u32;
                    engine.get_data_mut().halt = Some(Halt::NoMemory { fetch, address });
                    false
                },
            )
            .expect("the engine has such hooks");
    }

    /// The board.
    pub fn board(&self) -> &Board {
        &self.engine.get_data().board
    }

    /// The board.
    pub fn board_mut(&mut self) -> &mut Board {
        &mut self.engine.get_data_mut().board
    }

    /// Runs until something may have to be done, at the latest at a time. With `masked`, also as
    /// soon as the masks change.
    pub fn run(&mut self, until: u64, masked: bool) -> Halt {
        let pc = u64::from(self.register(RegisterARM::PC));
        let context = self.engine.get_data_mut();
        context.deadline = until;
        context.attention = false;
        context.masked = masked;
        context.halt = None;
        let result = self.engine.emu_start(pc | 1, NOWHERE, 0, 0);
        if let Some(halt) = self.engine.get_data_mut().halt.take() {
            return halt;
        }
        match result {
            // It stopped by itself, which is what it does at a wait for an interrupt.
            Ok(()) => Halt::Waiting,
            Err(uc_error::INSN_INVALID) if self.has_waited() => Halt::Waiting,
            Err(uc_error::INSN_INVALID) => Halt::Undefined,
            Err(_) => Halt::Invalid,
        }
    }

    /// Whether the last instruction was a wait for an event.
    fn has_waited(&self) -> bool {
        half_word(&self.engine, self.engine.get_data().address) == WAIT_FOR_EVENT
    }

    /// Where the last instruction was.
    pub fn last_address(&self) -> u32 {
        self.engine.get_data().address
    }

    /// What holds exceptions off.
    pub fn masks(&self) -> Masks {
        masks(&self.engine)
    }

    /// A register.
    pub fn register(&self, register: RegisterARM) -> u32 {
        self.engine.reg_read(register).expect("the core has this register") as u32
    }

    /// Sets a register.
    pub fn set_register(&mut self, register: RegisterARM, value: u32) {
        self.engine.reg_write(register, value.into()).expect("the core has this register");
    }

    /// Whether the floating-point registers are in use.
    pub fn uses_floating_point(&self) -> bool {
        self.register(RegisterARM::CONTROL) & IN_USE != 0
    }

    /// Says whether they are.
    pub fn set_uses_floating_point(&mut self, used: bool) {
        self.set_register(RegisterARM::CONTROL, if used { IN_USE_TO_THE_ENGINE } else { 0 });
    }

    /// Reads memory; none where there is none.
    pub fn memory(&self, address: u32, size: usize) -> Option<Vec<u8>> {
        self.engine.mem_read_as_vec(address.into(), size).ok()
    }

    /// A word of memory.
    pub fn word(&self, address: u32) -> Option<u32> {
        let mut bytes = [0; 4];
        self.engine.mem_read(address.into(), &mut bytes).ok()?;
        Some(u32::from_le_bytes(bytes))
    }

    /// Writes memory, flash included; whether there is any.
    pub fn set_memory(&mut self, address: u32, bytes: &[u8]) -> bool {
        self.engine.mem_write(address.into(), bytes).is_ok()
    }

    /// RAM as it is when power comes on.
    fn fill_with_noise(&mut self, base: u32, size: u32) {
        let mut state = 0x9E37_79B9_u32 ^ base;
        let noise = (0..size).map(|_| {
            // Marsaglia's xorshift.
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state as u8
        });
        let noise: Vec<u8> = noise.collect();
        self.set_memory(base, &noise);
    }
}

impl Context {
    /// After an access of the program to a peripheral: what is due may have changed.
    fn accessed(&mut self) {
        let board = &self.board;
        self.deadline = self.deadline.min(board.due());
        self.attention |= board.wants_attention() || board.system.exceptions.any_pending();
    }
}

/// Counts an instruction and those that were skipped before it, or stops before it.
fn before_instruction(engine: &mut Unicorn<'_, Context>, address: u64, size: u32) {
    let unmasked = engine.get_data().masked && {
        let masks = masks(engine);
        engine.get_data().board.system.exceptions.next(masks).is_some()
    };
    let context = engine.get_data_mut();
    if unmasked || context.attention || context.board.now >= context.deadline {
        context.halt = Some(Halt::Attention);
        // Fails only where the engine does not run.
        let _ = engine.emu_stop();
        return;
    }
    let address = address as u32;
    if !context.trail.is_next(address) {
        let mut trail = context.trail;
        let skipped = trail.skip(address, |at| half_word(engine, at));
        let context = engine.get_data_mut();
        context.trail = trail;
        context.board.now += skipped;
    }
    let context = engine.get_data_mut();
    context.trail.push(address, size);
    context.board.now += 1;
    context.address = address;
}

/// Half a word of the program; 0 where there is none.
fn half_word(engine: &Unicorn<'_, Context>, address: u32) -> u16 {
    let mut bytes = [0; 2];
    match engine.mem_read(address.into(), &mut bytes) {
        Ok(()) => u16::from_le_bytes(bytes),
        Err(_) => 0,
    }
}

/// What the engine calls an interrupt: the core wants something that is done outside.
fn interrupted(engine: &mut Unicorn<'_, Context>, number: u32) {
    let halt = match number {
        BREAKPOINT => Halt::Breakpoint,
        RETURN_FROM_EXCEPTION => {
            let word = engine.reg_read(RegisterARM::PC).unwrap_or(0);
            Halt::Returning(word as u32)
        }
        _ => Halt::Invalid,
    };
    engine.get_data_mut().halt = Some(halt);
    // Fails only where the engine does not run.
    let _ = engine.emu_stop();
}

fn masks(engine: &Unicorn<'_, Context>) -> Masks {
    let read = |register| engine.reg_read(register).unwrap_or(0);
    Masks {
        primask: read(RegisterARM::PRIMASK) & 1 != 0,
        faultmask: read(RegisterARM::FAULTMASK) & 1 != 0,
        basepri: read(RegisterARM::BASEPRI) as u8,
    }
}
