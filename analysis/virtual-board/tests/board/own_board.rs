//! A board of another crate (the package `own-board`), on the chip that it is for: it keeps the promises of the
//! boards of the firmware.

use std::path::PathBuf;
use std::sync::OnceLock;

use analysis::toolchain::{Tools, prepare};
use haptic_servo::fault::Fault;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{FaultCode, Outcome};
use virtual_board::board::Event;
use virtual_board::chip::{STM32F405, TICK_INTERRUPT};
use virtual_board::core::exceptions::FIRST_INTERRUPT;
use virtual_board::device::FixedDevice;
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, build};
use crate::faults::{Register, panics};
use crate::stub::{Masks, hold_up};

/// Counts from the face into the wall at which its torque is limited, and codes of that limit: 1 N m of 2.
const DEEP: i32 = 900;
const LIMIT: u16 = 896;

fn boot() -> Bench {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    let file = FILE.get_or_init(|| {
        let toolchain = prepare(Tools::Compiler, |step| eprintln!("{step}"))
            .unwrap_or_else(|error| panic!("{error}"));
        toolchain.build_own_board().unwrap_or_else(|error| panic!("{error}")).path
    });
    Bench::boot_file(&STM32F405, file, FixedDevice)
}

/// Armed, with the clamp open, and in the wall.
fn in_the_wall() -> Bench {
    let mut bench = boot();
    bench.armed();
    bench.run(110);
    bench.pins().turns.push_back(DEEP);
    bench.run(5);
    bench
}

#[test]
fn it_is_off_until_the_host_arms_it_and_then_renders_the_wall() {
    let mut bench = boot();
    bench.pins().turns.push_back(DEEP);
    bench.run(200);
    let events: Vec<_> = bench.events().iter().map(|&(_, event)| event).collect();
    assert_eq!(events, [Event::Amplifier(Level::Low), Event::Torque(Some(MID_SCALE))]);
    assert!(bench.machine.board().watchdog.due().is_some());
    bench.armed();
    bench.run(110);
    assert_eq!(bench.pins().samples.last().unwrap().code, Some(MID_SCALE - LIMIT));
    assert_eq!(bench.machine.board().serial.lost(), 0);
}

/// To the bit what a board of the firmware renders of the same scene, at the same instants.
#[test]
fn its_torques_are_those_of_a_board_of_the_firmware() {
    let codes = |mut bench: Bench| {
        let armed = bench.armed();
        let steps = [7, 190, -60, 301, 5, -200, 77].into_iter().cycle().take(200);
        bench.pins().turns.extend(steps.enumerate().map(|(i, step)| step - i as i32));
        bench.run(220);
        let codes: Vec<_> = bench.pins().samples[armed..].iter().map(|at| at.code).collect();
        codes
    };
    let file = build(&STM32F405, &["damper_wall"]).remove(0);
    let (own, ours) = (codes(boot()), codes(Bench::boot_file(&STM32F405, &file, FixedDevice)));
    let length = own.len().min(ours.len());
    assert!(length > 200 && own.iter().any(|code| *code < Some(MID_SCALE - 100)), "{own:?}");
    assert_eq!(own[..length], ours[..length]);
}

/// A torque changes at an update of the timer that paces, and at no other time.
#[test]
fn its_codes_come_out_at_the_next_update() {
    let mut bench = boot();
    bench.armed();
    bench.pins().turns.extend([3; 300]);
    bench.run(300);
    let period = bench.period();
    let due = bench.machine.board().tick_timer.due().unwrap();
    let changes = |(at, event): &(u64, Event)| matches!(event, Event::Torque(_)).then_some(*at);
    let times: Vec<_> = bench.events().iter().filter_map(changes).skip(1).collect();
    assert!(times.len() > 20);
    let late: Vec<_> = times.iter().map(|at| (period - (due - at) % period) % period).collect();
    // A virtual board's time goes by instructions: an event may be a cycle behind its cause.
    assert!(late.iter().all(|after| *after <= 1), "{late:?}");
}

/// A cause, the periods within which the amplifier is off, whether the board is then reset, and what it says.
type Case = (fn(&mut Bench), f64, bool, fn(Fault) -> bool);

const FAULTS: [Case; 6] = [
    (
        |bench| bench.pins().turns.push_back(2000),
        2.0,
        false,
        |fault| matches!(fault, Fault::EncoderJump { .. }),
    ),
    (
        |bench| {
            let instructions = 3 * bench.period();
            hold_up(bench, instructions, Masks::All);
        },
        4.0,
        false,
        |fault| matches!(fault, Fault::MissedTick { missed: 2, tolerated: 0 }),
    ),
    (
        |bench| {
            let exceptions = &mut bench.machine.board_mut().system.exceptions;
            exceptions.enable(FIRST_INTERRUPT + TICK_INTERRUPT, false);
        },
        // Eight periods, and two counts of the watchdog's clock of 8 kHz.
        8.25,
        true,
        |fault| fault == Fault::Watchdog,
    ),
    (
        |bench| bench.machine.board_mut().clock.crystal_runs = false,
        0.01,
        true,
        |fault| fault == Fault::ClockLost,
    ),
    (
        |bench| {
            let board = bench.machine.board_mut();
            board.broken = Some(Register::Encoder.address(board.chip()));
        },
        1.1,
        true,
        |fault| matches!(fault, Fault::HardFault { .. }),
    ),
    (|bench| _ = panics(bench), 0.01, true, |fault| fault == Fault::Panic { line: 12, column: 34 }),
];

#[test]
fn every_fault_takes_the_torque_away_in_time_and_is_told() {
    for (number, (provoke, bound, resets, is_told)) in FAULTS.into_iter().enumerate() {
        let mut bench = in_the_wall();
        assert_ne!(bench.pins().samples.last().unwrap().code, Some(MID_SCALE));
        let (from, period) = (bench.machine.board().now, bench.period());
        provoke(&mut bench);
        while bench.machine.board().now < from + 12 * period {
            bench.run_for(1000);
            if !bench.machine.resets().is_empty() {
                // What was broken is repaired before it is used again.
                let board = bench.machine.board_mut();
                (board.broken, board.clock.crystal_runs) = (None, true);
            }
        }
        let off = bench.amplifier_off(from).unwrap_or_else(|| panic!("{number}: it stays on"));
        let periods = (off - from) as f64 / period as f64;
        assert!(periods <= bound, "{number}: {periods} periods");
        bench.run(50);
        assert_eq!(bench.machine.board().torque(), Some(MID_SCALE), "{number}");
        assert_eq!(!bench.machine.resets().is_empty(), resets, "{number}");
        let status = bench.status();
        let fault = status.fault.and_then(FaultCode::fault).expect("a fault");
        assert!(is_told(fault), "{number}: {fault:?}");
        let state = if resets { State::Disarmed } else { State::Faulted };
        assert_eq!(status.state, state, "{number}");
        // Nothing but arming brings the torque back.
        assert_eq!(bench.machine.board().amplifier(), Level::Low, "{number}");
        assert_eq!(bench.arm(), Outcome::Done, "{number}");
    }
}
