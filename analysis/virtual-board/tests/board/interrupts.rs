//! A program that is interrupted after any number of instructions goes on as if it had not been:
//! conditions, flags, and the floating-point registers, also when the interrupt is interrupted.

use unicorn_engine::RegisterARM;
use virtual_board::chip::Chip;
use virtual_board::core::exceptions::{Number, PEND_SV, SYS_TICK};
use virtual_board::device::FixedDevice;
use virtual_board::image::Image;
use virtual_board::machine::Machine;

use crate::assembly::bytes;
use crate::bench::on_both;

const FLASH: u32 = 0x0800_0000;
/// Where the program puts what it has computed, and how many words.
const RESULTS: u32 = 0x2000_0000;
const WORDS: usize = 10;
/// Where the two interrupts count.
const COUNTS: u32 = 0x2000_0400;
/// What the lower one adds each time.
const ADDED: u32 = 8;
/// Instructions after which everything is over; more than all parts together have.
const ALL: u64 = 300;

/// Instructions for [`bytes`].
type Code = &'static [u32];

/// Switches the floating-point unit on, and gives PendSV a lower priority than SysTick's.
const SETUP: Code = &[
    0xF64E_5088, // movw r0, #0xed88
    0xF2CE_0000, // movt r0, #0xe000
    0xF44F_0170, // mov.w r1, #0xf00000
    0x6001,      // str r1, [r0]
    0x2180,      // movs r1, #0x80
    0xF800_1C66, // strb r1, [r0, #-102]
    0xF3BF_8F4F, // dsb
    0xF3BF_8F6F, // isb
];

/// Computes with and without conditions, stores everything and stands still.
const BODY: Code = &[
    0xF04F_5700, // mov.w r7, #0x20000000
    0x2001,      // movs r0, #1
    0x2102,      // movs r1, #2
    0x2203,      // movs r2, #3
    0x2304,      // movs r3, #4
    0xF04F_547F, // mov.w r4, #0x3fc00000: 1.5
    0x46A4,      // mov r12, r4
    0xEE00_4A10, // vmov s0, r4
    0xEE00_4A90, // vmov s1, r4
    0xEE07_4A90, // vmov s15, r4
    0xEE08_4A10, // vmov s16, r4
    0x4288,      // cmp r0, r1
    0xBFB5,      // itete lt
    0x300A,      // addlt r0, #10
    0x3014,      // addge r0, #20
    0x311E,      // addlt r1, #30
    0x3128,      // addge r1, #40
    0xBF08,      // it eq
    0x2232,      // moveq r2, #50
    0xBF1E,      // ittt ne
    0x323C,      // addne r2, #60
    0x3346,      // addne r3, #70
    0x2A3F,      // cmpne r2, #63
    0xBF06,      // itte eq
    0xF103_0301, // addeq.w r3, r3, #1
    0xEE30_0A20, // vaddeq.f32 s0, s0, s1
    0xEE20_0A20, // vmulne.f32 s0, s0, s1
    0x185B,      // adds r3, r3, r1
    0xEE70_0A27, // vadd.f32 s1, s0, s15
    0xEE60_7A88, // vmul.f32 s15, s1, s16
    0xEEF4_0A67, // vcmp.f32 s1, s15
    0xEEF1_FA10, // vmrs APSR_nzcv, fpscr
    0xBF4C,      // ite mi
    0xEE30_8A20, // vaddmi.f32 s16, s0, s1
    0xEE30_8A60, // vsubpl.f32 s16, s0, s1
    0xF3EF_8500, // mrs r5, apsr
    0x4464,      // add r4, r12
    0xC73F,      // stmia r7!, {r0-r5}
    0xECA7_0A02, // vstmia r7!, {s0, s1}
    0xECE7_7A02, // vstmia r7!, {s15, s16}
    0xE7FE,      // b .
];

/// What the body computes, worked out by hand: 1 + 10, 2 + 30, 3 + 60, 4 + 70 + 1 + 32; twice the
/// bits of 1.5; flags N of 4.5 < 6.75; and 1.5 + 1.5, 3 + 1.5, 4.5 * 1.5, 3 + 4.5.
fn results() -> [u32; WORDS] {
    let [a, b, c, d] = [3.0_f32, 4.5, 6.75, 7.5].map(f32::to_bits);
    [11, 32, 63, 107, 0x7F80_0000, 1 << 31, a, b, c, d]
}

/// Spoils all that an interrupt may, and counts; with a condition of its own.
const LOWER: Code = &[
    0x2000,      // movs r0, #0
    0x2155,      // movs r1, #0x55
    0x43CA,      // mvns r2, r1
    0x4613,      // mov r3, r2
    0x4694,      // mov r12, r2
    0xEE00_2A10, // vmov s0, r2
    0xEE00_1A90, // vmov s1, r1
    0xEE07_2A90, // vmov s15, r2
    0xEE30_1A20, // vadd.f32 s2, s0, s1
    0xEEF5_7A40, // vcmp.f32 s15, #0.0
    0x2801,      // cmp r0, #1
    0xBF0E,      // itee eq
    0x2109,      // moveq r1, #9
    0x2108,      // movne r1, #8
    0x2307,      // movne r3, #7
    0xF44F_6080, // mov.w r0, #0x400
    0xF2C2_0000, // movt r0, #0x2000
    0x6802,      // ldr r2, [r0]
    0x440A,      // add r2, r1
    0x6002,      // str r2, [r0]
    0x4770,      // bx lr
];

/// The same for the higher one.
const HIGHER: Code = &[
    0x2001,      // movs r0, #1
    0x43C1,      // mvns r1, r0
    0x460A,      // mov r2, r1
    0x460B,      // mov r3, r1
    0x468C,      // mov r12, r1
    0xEE00_1A10, // vmov s0, r1
    0xEE00_1A90, // vmov s1, r1
    0xEE01_1A10, // vmov s2, r1
    0xEE07_1A90, // vmov s15, r1
    0xF240_4004, // movw r0, #0x404
    0xF2C2_0000, // movt r0, #0x2000
    0x6802,      // ldr r2, [r0]
    0x2A00,      // cmp r2, #0
    0xBF0C,      // ite eq
    0x2201,      // moveq r2, #1
    0x3201,      // addne r2, #1
    0x6002,      // str r2, [r0]
    0x4770,      // bx lr
];

/// The program on a chip.
struct Interrupted {
    machine: Machine,
    body: u32,
}

impl Interrupted {
    fn boot(chip: &'static Chip) -> Self {
        const VECTORS: u32 = 64;
        let parts = [SETUP, BODY, LOWER, HIGHER].map(bytes);
        let mut at = FLASH + VECTORS;
        let [setup, body, lower, higher] = parts.each_ref().map(|part| {
            at += part.len() as u32;
            at - part.len() as u32
        });
        let mut vectors = [0; VECTORS as usize / 4];
        (vectors[0], vectors[1]) = (RESULTS + 0x4000, setup | 1);
        for (number, handler) in [(PEND_SV, lower), (SYS_TICK, higher)] {
            vectors[usize::from(number)] = handler | 1;
        }
        let vectors = vectors.into_iter().flat_map(u32::to_le_bytes);
        let program: Vec<u8> = vectors.chain(parts.concat()).collect();
        let image = Image { pieces: vec![(FLASH, program)], file: Vec::new() };
        let mut machine = Machine::power_on(image, chip, Box::new(FixedDevice)).unwrap();
        machine.core_mut().set_memory(COUNTS, &[0; 8]);
        machine.run_for(ALL).unwrap();
        Self { machine, body }
    }

    fn words<const N: usize>(&mut self, address: u32) -> [u32; N] {
        std::array::from_fn(|i| self.machine.core_mut().word(address + 4 * i as u32).unwrap())
    }

    /// Begins the body, and executes so many instructions of it.
    fn begin(&mut self, instructions: u64) {
        self.machine.core_mut().set_register(RegisterARM::PC, self.body | 1);
        self.machine.run_for(instructions).unwrap();
    }

    /// Runs the body once more, interrupted each time after so many instructions: it computes what
    /// it does undisturbed.
    fn check(&mut self, interrupts: &[(u64, Number)]) {
        let core = self.machine.core_mut();
        let stack = core.register(RegisterARM::MSP);
        core.set_memory(RESULTS, &[0xEE; 4 * WORDS]);
        self.begin(0);
        for &(after, number) in interrupts {
            self.machine.run_for(after).unwrap();
            self.machine.board_mut().system.exceptions.pend(number);
        }
        self.machine.run_for(ALL).unwrap();
        let what = format!("{}, {interrupts:?}", self.machine.board().chip().name);
        assert_eq!(self.words(RESULTS), results(), "{what}");
        assert_eq!(self.machine.core_mut().register(RegisterARM::MSP), stack, "{what}");
    }
}

/// The numbers of instructions before each of a program's, from none on.
fn before_each(code: Code) -> std::ops::Range<u64> {
    0..code.len() as u64
}

#[test]
fn an_interrupt_goes_on_after_another_one_anywhere() {
    on_both(|chip| {
        let mut program = Interrupted::boot(chip);
        for after in before_each(BODY) {
            for within in before_each(LOWER) {
                program.check(&[(after, PEND_SV), (within, SYS_TICK)]);
            }
        }
        let times = (BODY.len() * LOWER.len()) as u32;
        assert_eq!(program.words(COUNTS), [ADDED * times, times]);
    });
}
