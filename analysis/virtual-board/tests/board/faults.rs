//! Every fault, provoked from outside, and how soon the motor is without torque.

use haptic_servo::fault::Fault;
use haptic_servo::reset::ResetCause;
use haptic_servo::wire::message::{Outcome, Refusal};
use unicorn_engine::RegisterARM;
use virtual_board::board::Event;
use virtual_board::chip::Unit;
use virtual_board::chip::{Chip, TICK_INTERRUPT};
use virtual_board::core::exceptions::{FIRST_INTERRUPT, NON_MASKABLE, Number};
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, on_both};
use crate::provoked::{Case, check_kept, run_on};
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

/// A servo that pushes into its wall.
fn pushing_into(chip: &'static Chip, program: &'static str) -> Bench {
    let mut bench = Bench::running(chip, program);
    bench.turn(INTO);
    bench.run(20);
    assert_ne!(bench.last_code(), Some(MID_SCALE));
    bench
}

/// A cause gives the time from which on its periods are counted.
type Cause = Case<u64>;

const fn latched(
    fault: &'static str,
    cause: &'static str,
    bound: f64,
    provoke: fn(&mut Bench) -> u64,
) -> Cause {
    Case::new(|chip| pushing_into(chip, "damper_wall"), fault, cause, bound, provoke)
}

/// The same where a torque has a phase.
const fn at_phase(
    fault: &'static str,
    cause: &'static str,
    bound: f64,
    provoke: fn(&mut Bench) -> u64,
) -> Cause {
    Case::new(|chip| pushing_into(chip, "undelayed_wall"), fault, cause, bound, provoke)
}

/// After all interrupts are masked for [`MASKED`] periods.
const MISSED: Fault = Fault::MissedTick { missed: MASKED as u32 - 1, tolerated: 0 };
/// That of [`panics`].
const PANIC: Fault = Fault::Panic { line: 12, column: 34 };

const CASES: &[Cause] = &[
    latched(
        "encoder-jump",
        "the encoder jumps by more than the device's largest speed",
        1.0,
        |bench| {
            bench.turn(LARGEST_STEP as i32 + 1);
            bench.run_to_update();
            bench.now()
        },
    )
    .told_as(Fault::EncoderJump { counts: LARGEST_STEP + 1, largest: LARGEST_STEP }),
    latched(
        "missed-tick",
        "all interrupts are masked for three periods",
        MASKED as f64 + 1.0,
        misses_ticks,
    )
    .told_as(MISSED),
    latched(
        "late-tick",
        "all interrupts are masked through an update, for half a period behind it",
        1.25,
        |bench| {
            let period = bench.period();
            bench.run_to_update();
            bench.run_for(period / 2);
            hold_up(bench, period, Masks::All)
        },
    ),
    at_phase(
        "late-tick",
        "a torque has a phase, and its code is written half a period behind it",
        0.75,
        |bench| {
            bench.run_to_update();
            let update = bench.now();
            bench.run_for(BEFORE_THE_CODE);
            bench.board_mut().now += bench.period() / 2;
            update
        },
    ),
    at_phase(
        "late-tick",
        "a torque has a phase, and interrupts are masked from half a period before its count to \
         3 microseconds behind",
        0.75,
        |bench| {
            let period = bench.period();
            bench.run_to_update();
            bench.run_for(period / 2);
            hold_up(bench, period / 2 + 3 * period / 1000, Masks::All)
        },
    ),
    at_phase(
        "missed-tick",
        "a torque has a phase, and all interrupts are masked for three periods",
        MASKED as f64 + 1.0,
        misses_ticks,
    )
    .told_as(MISSED),
    at_phase(
        "panic",
        "a torque has a phase, and the core is sent into a panic while its code waits for that",
        1.0,
        |bench| {
            bench.run_to_waiting_code(40);
            panics(bench)
        },
    )
    .resetting()
    .told_as(PANIC),
    latched("not-a-number", "a coefficient in memory is not a number", 1.0, |bench| {
        for place in coefficient(bench) {
            assert!(bench.machine.core_mut().set_memory(place, &f32::NAN.to_le_bytes()));
        }
        bench.now()
    })
    .told_as(Fault::NotANumber),
    latched("watchdog", "the servo's interrupt is disabled", TIMEOUT, |bench| {
        disable(bench, TICK_INTERRUPT);
        bench.now()
    })
    .resetting()
    .told_as(Fault::Watchdog),
    latched("watchdog", "all interrupts are masked for ever", TIMEOUT, |bench| {
        let instructions = 100 * bench.period();
        hold_up(bench, instructions, Masks::All)
    })
    .resetting()
    .told_as(Fault::Watchdog),
    latched("clock-lost", "the crystal stops", 1.0, |bench| {
        bench.board_mut().clock.crystal_runs = false;
        bench.now()
    })
    .resetting()
    .told_as(Fault::ClockLost),
    latched("clock-lost", "the crystal stops while all interrupts are masked", 1.0, |bench| {
        bench.machine.core_mut().set_register(RegisterARM::PRIMASK, 1);
        bench.board_mut().clock.crystal_runs = false;
        bench.now()
    })
    .resetting()
    .told_as(Fault::ClockLost),
    latched(
        "non-maskable",
        "a non-maskable interrupt comes of which the chip says nothing",
        1.0,
        |bench| {
            bench.board_mut().system.exceptions.pend(NON_MASKABLE);
            bench.now()
        },
    )
    .resetting()
    .told_as(Fault::NonMaskable),
    latched("hard-fault", "the bus has an error at the encoder's counter", 1.0, |bench| {
        breaks_in_a_tick(bench, Register::Encoder)
    })
    .resetting(),
    latched(
        "hard-fault",
        "the bus has an error at the DAC's register, also for the fault's handler",
        1.0,
        |bench| breaks_in_a_tick(bench, Register::Dac),
    )
    .resetting(),
    latched("panic", "the core is sent into a panic of line 12, column 34", 1.0, panics)
        .resetting()
        .told_as(PANIC),
];

/// Disables an interrupt.
pub fn disable(bench: &mut Bench, interrupt: Number) {
    bench.board_mut().system.exceptions.enable(FIRST_INTERRUPT + interrupt, false);
}

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
        chip.units().find(|place| place.unit == unit).unwrap().base + offset
    }
}

/// A register that answers with an error from the next update on. Gives when that is.
fn breaks_in_a_tick(bench: &mut Bench, register: Register) -> u64 {
    bench.run_to_update();
    let board = bench.board_mut();
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
    let place = 0x2000_0000 + bench.board().chip().ram - 16;
    let (panic, _) = bench.symbol("9panicking5panic");
    let core = bench.machine.core_mut();
    let words = [0_u32, 0, 12, 34].map(u32::to_le_bytes).concat();
    assert!(core.set_memory(place, &words));
    for register in [RegisterARM::R0, RegisterARM::R1, RegisterARM::R2] {
        core.set_register(register, place);
    }
    core.set_register(RegisterARM::PC, panic | 1);
    bench.now()
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

/// Provokes a fault on a running servo; gives the periods until the amplifier was off.
fn run(case: &Cause, chip: &'static Chip) -> f64 {
    let what = case.what();
    let mut bench = (case.begin)(chip);
    let (period, has_phase) = (bench.period(), bench.board().phase_timer.runs());
    let began = (case.provoke)(&mut bench);
    run_on(&mut bench, began + (TIMEOUT.ceil() as u64 + 2) * period);
    let off = bench.amplifier_off(began).unwrap_or_else(|| panic!("{what}: it stays on"));
    let periods = case.check_bound(off - began, period);
    let told = case.check_told(&mut bench);
    check_told_after_reset(case, &mut bench, told);
    check_torque(&bench, off, &what);
    // Where a torque has a phase, the one before goes to none, also if a code waited for its phase.
    let is_none = |code| code == MID_SCALE;
    assert!(!has_phase || bench.torques_after(began).all(is_none), "{what}");
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

/// What the board says of a reset, and of the fault before it.
fn check_told_after_reset(case: &Cause, bench: &mut Bench, told: Fault) {
    let what = case.what();
    let reset = if case.resets { ResetCause::IndependentWatchdog } else { ResetCause::PowerOn };
    assert_eq!(bench.status().reset, reset, "{what}");
    let previous_fault = bench.previous_fault().and_then(|record| record.fault.fault());
    assert_eq!(previous_fault, case.resets.then_some(told), "{what}");
    let log = bench.log();
    let says = |line: &String| line.contains("not armed") && line.contains(told.as_str());
    assert_eq!(log.iter().any(says), case.resets, "{what}: {log:?}");
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
    assert_eq!(bench.board().torque(), Some(MID_SCALE), "{what}");
}

#[test]
fn every_fault_takes_the_torque_away_in_time_and_is_told() {
    let measured = on_both(|chip| CASES.iter().map(|case| run(case, chip)).collect());
    let names = Chip::ALL.map(|chip| chip.name);
    let columns: Vec<_> = names.into_iter().zip(measured).collect();
    check_kept(include_str!("../../faults.md"), CASES, &columns, 2);
}
