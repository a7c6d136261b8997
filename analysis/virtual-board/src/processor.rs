//! The core's instructions, executed by `unicorn-engine`: its registers, its memory, and the places
//! where it stops.
//!
//! The engine knows nothing of exceptions on this core. It stops before an instruction once
//! something may have to be done between two of them; at a wait for an interrupt; at a return from
//! an exception; and at what it cannot execute. Inside of a conditional block it does not stop: it
//! finishes the block first, so that an interrupt comes up to four instructions later there.

use unicorn_engine::{Arch, ArmCpuModel, Mode, Prot, RegisterARM, Unicorn, uc_error};

use crate::board::VirtualBoard;
use crate::chip::{COUPLED, FLASH, RAM};
use crate::core::exceptions::Masks;
use crate::hooks::{self, Context, Engine, Halt};

/// The core.
pub struct Processor {
    engine: Engine<'static>,
}

/// An address at which nothing is ever executed, since a run has to end somewhere.
const NOWHERE: u64 = 0xFFFF_FFF0;
/// CONTROL: the floating-point registers are in use.
const IN_USE: u32 = 1 << 2;
/// The same with the bit of the same meaning that later cores have in their secure state, in which the
/// engine believes itself: without it, the next floating-point instruction would begin with a status
/// of zero.
const IN_USE_TO_THE_ENGINE: u32 = 0b11 << 2;
/// A wait for an event, as an instruction: the engine takes it for an unknown one.
const WAIT_FOR_EVENT: u16 = 0xBF20;

impl Processor {
    /// A core with a chip's memory, which holds noise, and its board.
    pub fn new(board: VirtualBoard) -> Self {
        let chip = board.chip();
        let mode = Mode::THUMB | Mode::MCLASS;
        let mut engine = Unicorn::new_with_data(Arch::ARM, mode, Context::new(board))
            .expect("the engine has this core");
        engine.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32).expect("the engine has this core");
        let coupled = if chip.coupled.1 { Prot::ALL } else { Prot::READ | Prot::WRITE };
        for (base, size, access) in [
            (FLASH, chip.flash, Prot::READ | Prot::EXEC),
            (COUPLED, chip.coupled.0, coupled),
            // No program executes from there: each store would have to be looked at for instructions, which takes
            // the engine long.
            (RAM, chip.ram, Prot::READ | Prot::WRITE),
        ] {
            let mapped = engine.mem_map(base.into(), size.into(), access);
            mapped.expect("the chip's memories do not overlap");
        }
        hooks::wire(&mut engine);
        let mut core = Self { engine };
        core.forget();
        core
    }

    /// Leaves noise in RAM, as it is when power comes on.
    pub fn forget(&mut self) {
        let chip = self.board().chip();
        for (base, size) in [(RAM, chip.ram), (COUPLED, chip.coupled.0)] {
            self.fill_with_noise(base, size);
        }
    }

    /// The board.
    pub fn board(&self) -> &VirtualBoard {
        &self.engine.get_data().board
    }

    /// The board.
    pub fn board_mut(&mut self) -> &mut VirtualBoard {
        &mut self.engine.get_data_mut().board
    }

    /// Runs until something may have to be done, at the latest at a time. With `masked`, also as
    /// soon as the masks change.
    pub fn run(&mut self, until: u64, masked: bool) -> Halt {
        let pc = u64::from(self.register(RegisterARM::PC));
        self.engine.get_data_mut().begin(until, masked);
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
        self.memory(self.last_address(), 2).as_deref() == Some(&WAIT_FOR_EVENT.to_le_bytes())
    }

    /// Where the last instruction was.
    pub fn last_address(&self) -> u32 {
        self.engine.get_data().history.latest()
    }

    /// What holds exceptions off.
    pub fn masks(&self) -> Masks {
        hooks::masks(&self.engine)
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

    /// Reads memory; `None` outside of it.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chip::Chip;
    use crate::device::FixedDevice;

    /// `b .`
    const STAY: u16 = 0xE7FE;

    /// Why the core stops that executes some instructions from `at` on, and what it was then.
    fn execute(
        chip: &'static Chip,
        at: u32,
        code: &[u16],
        registers: [u32; 4],
    ) -> (Halt, Processor) {
        let mut core = Processor::new(VirtualBoard::new(chip, Box::new(FixedDevice)));
        let bytes: Vec<_> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
        core.set_memory(at, &bytes);
        let names = [RegisterARM::R0, RegisterARM::R1, RegisterARM::R2, RegisterARM::R3];
        for (name, value) in names.into_iter().zip(registers) {
            core.set_register(name, value);
        }
        core.set_register(RegisterARM::PC, at | 1);
        (core.run(50, false), core)
    }

    #[test]
    fn instructions_come_only_from_where_the_chip_lets_them() {
        for chip in Chip::ALL {
            let coupled = chip.coupled.1;
            for (at, is_memory) in [
                (FLASH, true),
                (COUPLED, coupled),
                (RAM, false),
                (FLASH - 0x1000, false),
                (0x6000_0000, false),
            ] {
                let none = Halt::NoMemory { fetch: true, address: at };
                let expected = if is_memory { Halt::Attention } else { none };
                let (halt, _) = execute(chip, at, &[STAY], [0; 4]);
                assert_eq!(halt, expected, "{}, {at:#x}", chip.name);
            }
        }
    }

    #[test]
    fn data_come_from_all_memory_and_go_where_it_can_be_written() {
        const LOAD: u16 = 0x6801; // ldr r1, [r0]
        const STORE: u16 = 0x6001; // str r1, [r0]
        for chip in Chip::ALL {
            for (access, address, is_allowed) in [
                (LOAD, FLASH, true),
                (STORE, FLASH, false),
                (LOAD, COUPLED, true),
                (STORE, COUPLED, true),
                (STORE, RAM + chip.ram - 4, true),
                (LOAD, RAM + chip.ram, false),
                (STORE, RAM + chip.ram, false),
                (STORE, COUPLED + chip.coupled.0, false),
            ] {
                let none = Halt::NoMemory { fetch: false, address };
                let expected = if is_allowed { Halt::Attention } else { none };
                let (halt, _) = execute(chip, FLASH, &[access, STAY], [address, 0, 0, 0]);
                assert_eq!(halt, expected, "{}, {access:#x} of {address:#x}", chip.name);
            }
        }
    }
}
