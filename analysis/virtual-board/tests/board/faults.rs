//! Every fault, provoked from outside, and how soon the motor is without torque.

use haptic_servo::fault::Fault;
use haptic_servo::reset::ResetCause;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{FaultCode, Outcome, Refusal};
use unicorn_engine::RegisterARM;
use virtual_board::board::Event;
use virtual_board::chip::{Chip, TICK_INTERRUPT};
use virtual_board::core::exceptions::{FIRST_INTERRUPT, NON_MASKABLE};
use virtual_board::peripheral::pins::Level;
use virtual_board::unit::Unit;

use crate::bench::{Bench, MID_SCALE, on_both};
use crate::stub::{Masks, hold_up};

/// Counts into the damper wall, so that there is a torque that has to go.
const INTO: i32 = 300;
/// The most counts that the device moves in a tick: 100 rad/s for a thousandth of a second at 61,440
/// counts a turn, and an edge.
const LARGEST_STEP: u32 = 978;
/// Periods after which the watchdog resets the board: eight, and two counts of its clock of 8 kHz.
const TIMEOUT: f64 = 8.25;
/// Periods for which interrupts are masked.
const MASKED: u64 = 3;

/// Instructions from an update to after the count is read and before a code is written.
const BEFORE_THE_CODE: u64 = 45;

/// A way to provoke a fault.
struct Case {
    fault: &'static str,
    cause: &'static str,
    program: &'static str,
    /// Periods from the cause within which the amplifier is off.
    bound: f64,
    /// Provokes it, and says when.
    provoke: fn(&mut Bench) -> u64,
    /// Whether the watchdog has to reset the board, which then says what it was.
    resets: bool,
    /// The fault, where its numbers are known.
    expected: Option<Fault>,
}

const CASES: &[Case] = &[
    Case {
        fault: "encoder-jump",
        cause: "the encoder jumps by more than the device's largest speed",
        program: "damper_wall",
        bound: 1.0,
        provoke: |bench| {
            bench.pins().turns.push_back(LARGEST_STEP as i32 + 1);
            bench.run_to_update();
            bench.machine.board().now
        },
        resets: false,
        expected: Some(Fault::EncoderJump { counts: LARGEST_STEP + 1, largest: LARGEST_STEP }),
    },
    Case {
        fault: "missed-tick",
        cause: "all interrupts are masked for three periods",
        program: "damper_wall",
        bound: MASKED as f64 + 1.0,
        provoke: misses_ticks,
        resets: false,
        expected: Some(Fault::MissedTick { missed: MASKED as u32 - 1, tolerated: 0 }),
    },
    Case {
        fault: "late-tick",
        cause: "all interrupts are masked through an update, for half a period behind it",
        program: "damper_wall",
        bound: 1.25,
        provoke: |bench| {
            let period = bench.period();
            bench.run_to_update();
            bench.run_for(period / 2);
            hold_up(bench, period, Masks::All)
        },
        resets: false,
        expected: None,
    },
    Case {
        fault: "late-tick",
        cause: "a torque has a phase, and its code is written half a period behind it",
        program: "undelayed_wall",
        bound: 0.75,
        provoke: |bench| {
            bench.run_to_update();
            let update = bench.machine.board().now;
            bench.run_for(BEFORE_THE_CODE);
            bench.machine.board_mut().now += bench.period() / 2;
            update
        },
        resets: false,
        expected: None,
    },
    Case {
        fault: "late-tick",
        cause: "a torque has a phase, and interrupts are masked from half a period before its count to \
                3 microseconds behind",
        program: "undelayed_wall",
        bound: 0.75,
        provoke: |bench| {
            let period = bench.period();
            bench.run_to_update();
            bench.run_for(period / 2);
            hold_up(bench, period / 2 + 3 * period / 1000, Masks::All)
        },
        resets: false,
        expected: None,
    },
    Case {
        fault: "missed-tick",
        cause: "a torque has a phase, and all interrupts are masked for three periods",
        program: "undelayed_wall",
        bound: MASKED as f64 + 1.0,
        provoke: misses_ticks,
        resets: false,
        expected: Some(Fault::MissedTick { missed: MASKED as u32 - 1, tolerated: 0 }),
    },
    Case {
        fault: "panic",
        cause: "a torque has a phase, and the core is sent into a panic while its code waits for that",
        program: "undelayed_wall",
        bound: 1.0,
        provoke: |bench| {
            bench.run_to_waiting_code(40);
            panics(bench)
        },
        resets: true,
        expected: Some(Fault::Panic { line: 12, column: 34 }),
    },
    Case {
        fault: "not-a-number",
        cause: "a coefficient in memory is not a number",
        program: "damper_wall",
        bound: 1.0,
        provoke: |bench| {
            for place in coefficient(bench) {
                assert!(bench.machine.core_mut().set_memory(place, &f32::NAN.to_le_bytes()));
            }
            bench.machine.board().now
        },
        resets: false,
        expected: Some(Fault::NotANumber),
    },
    Case {
        fault: "watchdog",
        cause: "the servo's interrupt is disabled",
        program: "damper_wall",
        bound: TIMEOUT,
        provoke: |bench| {
            let board = bench.machine.board_mut();
            board.system.exceptions.enable(FIRST_INTERRUPT + TICK_INTERRUPT, false);
            board.now
        },
        resets: true,
        expected: Some(Fault::Watchdog),
    },
    Case {
        fault: "watchdog",
        cause: "all interrupts are masked for ever",
        program: "damper_wall",
        bound: TIMEOUT,
        provoke: |bench| {
            let instructions = 100 * bench.period();
            hold_up(bench, instructions, Masks::All)
        },
        resets: true,
        expected: Some(Fault::Watchdog),
    },
    Case {
        fault: "clock-lost",
        cause: "the crystal stops",
        program: "damper_wall",
        bound: 1.0,
        provoke: |bench| {
            let board = bench.machine.board_mut();
            board.clock.crystal_runs = false;
            board.now
        },
        resets: true,
        expected: Some(Fault::ClockLost),
    },
    Case {
        fault: "clock-lost",
        cause: "the crystal stops while all interrupts are masked",
        program: "damper_wall",
        bound: 1.0,
        provoke: |bench| {
            bench.machine.core_mut().set_register(RegisterARM::PRIMASK, 1);
            let board = bench.machine.board_mut();
            board.clock.crystal_runs = false;
            board.now
        },
        resets: true,
        expected: Some(Fault::ClockLost),
    },
    Case {
        fault: "non-maskable",
        cause: "a non-maskable interrupt comes of which the chip says nothing",
        program: "damper_wall",
        bound: 1.0,
        provoke: |bench| {
            let board = bench.machine.board_mut();
            board.system.exceptions.pend(NON_MASKABLE);
            board.now
        },
        resets: true,
        expected: Some(Fault::NonMaskable),
    },
    Case {
        fault: "hard-fault",
        cause: "the bus has an error at the encoder's counter",
        program: "damper_wall",
        bound: 1.0,
        provoke: |bench| breaks_in_a_tick(bench, Register::Encoder),
        resets: true,
        expected: None,
    },
    Case {
        fault: "hard-fault",
        cause: "the bus has an error at the DAC's register, also for the fault's handler",
        program: "damper_wall",
        bound: 1.0,
        provoke: |bench| breaks_in_a_tick(bench, Register::Dac),
        resets: true,
        expected: None,
    },
    Case {
        fault: "panic",
        cause: "the core is sent into a panic of line 12, column 34",
        program: "damper_wall",
        bound: 1.0,
        provoke: panics,
        resets: true,
        expected: Some(Fault::Panic { line: 12, column: 34 }),
    },
];

/// A register that a tick uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// The encoder's counter.
    Encoder,
    /// The DAC's, where codes are written.
    Dac,
}

impl Register {
    /// Its address on a chip.
    pub fn address(self, chip: &Chip) -> u32 {
        let (unit, offset) = match self {
            Self::Encoder => (Unit::Encoder, 0x24),
            Self::Dac => (Unit::Dac, 0x08),
        };
        chip.map.iter().find(|place| place.unit == unit).unwrap().base + offset
    }
}

/// A register that answers with an error from the next update on. Gives when that is.
fn breaks_in_a_tick(bench: &mut Bench, register: Register) -> u64 {
    bench.run_to_update();
    let board = bench.machine.board_mut();
    board.broken = Some(register.address(board.chip()));
    board.now
}

/// Masks all interrupts for [`MASKED`] periods. Gives when.
fn misses_ticks(bench: &mut Bench) -> u64 {
    let instructions = MASKED * bench.period();
    hold_up(bench, instructions, Masks::All)
}

/// Sends the core into a panic of line 12, column 34. Gives when.
pub fn panics(bench: &mut Bench) -> u64 {
    // The place in the source that a panic is told, as the compiler lays it out: a file's name, line and
    // column.
    let place = 0x2000_0000 + bench.machine.board().chip().ram - 16;
    let (panic, _) = bench.symbol("9panicking5panic");
    let core = bench.machine.core_mut();
    let words = [0_u32, 0, 12, 34].map(u32::to_le_bytes).concat();
    assert!(core.set_memory(place, &words));
    for register in [RegisterARM::R0, RegisterARM::R1, RegisterARM::R2] {
        core.set_register(register, place);
    }
    core.set_register(RegisterARM::PC, panic | 1);
    bench.machine.board().now
}

/// Where the servo has the angle of a count, as a number in single precision. A move of the servo may have left
/// it in a gap between two fields as well, where nothing reads it.
pub fn coefficient(bench: &mut Bench) -> Vec<u32> {
    let (place, size) = bench.symbol("9ISR_STATE");
    let angle = std::f32::consts::TAU / 61_440.0;
    let core = bench.machine.core_mut();
    let is_it = |address: &u32| {
        let value = f32::from_bits(core.word(*address).unwrap());
        (value / angle - 1.0).abs() < 1e-6
    };
    let found: Vec<_> = (place..place + size).step_by(4).filter(is_it).collect();
    assert!(matches!(found.len(), 1 | 2), "{found:x?}");
    found
}

impl Case {
    /// Provokes it on a running servo; gives the periods until the amplifier was off.
    fn run(&self, chip: &'static Chip) -> f64 {
        let Self { fault, cause, bound, .. } = *self;
        let what = format!("{}, {fault}: {cause}", chip.name);
        let mut bench = Bench::running(chip, self.program);
        bench.pins().turns.push_back(INTO);
        bench.run(20);
        assert_ne!(bench.pins().samples.last().unwrap().code, Some(MID_SCALE), "{what}");
        let period = bench.period();
        let began = (self.provoke)(&mut bench);
        while bench.machine.board().now < began + (TIMEOUT.ceil() as u64 + 2) * period {
            bench.run_for(1000);
            if !bench.machine.resets().is_empty() {
                // What was broken is repaired before it is used again.
                let board = bench.machine.board_mut();
                (board.broken, board.clock.crystal_runs) = (None, true);
            }
        }
        let off = bench.amplifier_off(began).unwrap_or_else(|| panic!("{what}: it stays on"));
        let periods = (off - began) as f64 / period as f64;
        assert!(periods <= bound, "{what}: {periods} periods");
        let told = self.check_told(&mut bench, &what);
        check_torque(&bench, off, &what);
        // Arming works again once the cause is gone.
        let persists = told == Fault::NotANumber;
        match bench.arm() {
            Outcome::Done => assert!(!persists, "{what}"),
            Outcome::Refused(refusal) => {
                assert!(persists && refusal == Refusal::Fault(told.into()), "{what}: {refusal}");
            }
        }
        periods
    }

    /// What the board says of it.
    fn check_told(&self, bench: &mut Bench, what: &str) -> Fault {
        assert_eq!(!bench.machine.resets().is_empty(), self.resets, "{what}");
        bench.run(50);
        let status = bench.status();
        let told = status.fault.and_then(FaultCode::fault).unwrap_or_else(|| panic!("{what}"));
        assert_eq!(told.as_str(), self.fault, "{what}");
        assert_eq!(told, self.expected.unwrap_or(told), "{what}");
        let state = if self.resets { State::Disarmed } else { State::Faulted };
        assert_eq!(status.state, state, "{what}");
        let reset = if self.resets { ResetCause::IndependentWatchdog } else { ResetCause::PowerOn };
        assert_eq!(status.reset, reset, "{what}");
        let previous_fault = bench.previous_fault().and_then(|record| record.fault.fault());
        assert_eq!(previous_fault, self.resets.then_some(told), "{what}");
        let log = bench.log();
        let says = |line: &String| line.contains("not armed") && line.contains(told.as_str());
        assert_eq!(log.iter().any(says), self.resets, "{what}: {log:?}");
        told
    }
}

/// From the update behind the one in which the amplifier went off, there is no torque.
fn check_torque(bench: &Bench, off: u64, what: &str) {
    let later = |&&(at, _): &&(u64, Event)| at > off + bench.period();
    for (at, event) in bench.events().iter().filter(later) {
        let harmless = match event {
            Event::Torque(code) => matches!(code, None | Some(MID_SCALE)),
            Event::Amplifier(level) => *level != Level::High,
        };
        assert!(harmless, "{what}: {event:?} at {at}");
    }
    assert_eq!(bench.machine.board().torque(), Some(MID_SCALE), "{what}");
}

/// The table of what was measured, in periods, rounded up to hundredths: instructions of a tick, of
/// which a period has 170,000, vary with the compiler.
fn table(measured: [Vec<f64>; 2]) -> String {
    let [g4, f405] = Chip::ALL.map(|chip| chip.name);
    let mut table =
        format!("| fault | provoked by | promised | {g4} | {f405} |\n|---|---|---|---|---|\n");
    for (number, Case { fault, cause, bound, .. }) in CASES.iter().enumerate() {
        let [g4, f405] =
            measured.each_ref().map(|periods| (periods[number] * 100.0).ceil() / 100.0);
        table += &format!("| {fault} | {cause} | {bound} | {g4:.2} | {f405:.2} |\n");
    }
    table
}

#[test]
fn every_fault_takes_the_torque_away_in_time_and_is_told() {
    let measured = on_both(|chip| CASES.iter().map(|case| case.run(chip)).collect());
    let (table, kept) = (table(measured), include_str!("../../faults.md"));
    assert!(kept.ends_with(&table), "faults.md has another table than\n{table}");
}
