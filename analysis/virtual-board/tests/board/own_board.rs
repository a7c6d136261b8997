//! A board of another crate (the package `own-board`), on the chip that it is for: it keeps the promises of the
//! boards of the firmware.

use std::path::PathBuf;
use std::sync::OnceLock;

use analysis::toolchain::{Tools, prepare};
use haptic_servo::fault::Fault;
use haptic_servo::wire::message::Outcome;
use virtual_board::board::Event;
use virtual_board::chip::{STM32F405, TICK_INTERRUPT};
use virtual_board::device::FixedDevice;
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, build};
use crate::faults::{Register, disable, panics};
use crate::provoked::{Case, run_on};
use crate::stub::{Masks, hold_up};

/// Counts from the face into the wall at which its torque is limited, and codes of that limit: 1 N m of 2.
const DEEP: i32 = 900;
const LIMIT: u16 = 896;

fn boot() -> Bench {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    let file = FILE.get_or_init(|| {
        let toolchain = prepare(Tools::Compiler).unwrap_or_else(|error| panic!("{error}"));
        toolchain.build_own_board().unwrap_or_else(|error| panic!("{error}")).path
    });
    Bench::boot_file(&STM32F405, file, FixedDevice)
}

/// Armed, with the clamp open, and in the wall.
fn in_the_wall() -> Bench {
    let mut bench = boot();
    bench.armed();
    bench.run(110);
    bench.turn(DEEP);
    bench.run(5);
    bench
}

#[test]
fn it_is_off_until_the_host_arms_it_and_then_renders_the_wall() {
    let mut bench = boot();
    bench.turn(DEEP);
    bench.run(200);
    let events: Vec<_> = bench.events().iter().map(|&(_, event)| event).collect();
    assert_eq!(events, [Event::Amplifier(Level::Low), Event::Torque(Some(MID_SCALE))]);
    assert!(bench.board().watchdog.due().is_some());
    bench.armed();
    bench.run(110);
    assert_eq!(bench.last_code(), Some(MID_SCALE - LIMIT));
    assert_eq!(bench.board().serial.lost(), 0);
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

const fn case(
    fault: &'static str,
    cause: &'static str,
    bound: f64,
    provoke: fn(&mut Bench),
) -> Case<()> {
    Case::new(|_| in_the_wall(), fault, cause, bound, provoke)
}

const FAULTS: &[Case<()>] = &[
    case("encoder-jump", "the encoder jumps", 2.0, |bench| bench.turn(2000)),
    case("missed-tick", "all interrupts are masked for three periods", 4.0, |bench| {
        let instructions = 3 * bench.period();
        hold_up(bench, instructions, Masks::All);
    })
    .told_as(Fault::MissedTick { missed: 2, tolerated: 0 }),
    // Eight periods, and two counts of the watchdog's clock of 8 kHz.
    case("watchdog", "the servo's interrupt is disabled", 8.25, |bench| {
        disable(bench, TICK_INTERRUPT)
    })
    .resetting(),
    case("clock-lost", "the crystal stops", 0.01, |bench| {
        bench.board_mut().clock.crystal_runs = false
    })
    .resetting(),
    case("hard-fault", "the bus has an error at the encoder's counter", 1.1, |bench| {
        let board = bench.board_mut();
        board.broken = Some(Register::Encoder.address(board.chip()));
    })
    .resetting(),
    case("panic", "the core is sent into a panic", 0.01, |bench| _ = panics(bench))
        .resetting()
        .told_as(Fault::Panic { line: 12, column: 34 }),
];

#[test]
fn every_fault_takes_the_torque_away_in_time_and_is_told() {
    for case in FAULTS {
        let mut bench = (case.begin)(&STM32F405);
        assert_ne!(bench.last_code(), Some(MID_SCALE));
        let (from, period) = (bench.now(), bench.period());
        (case.provoke)(&mut bench);
        run_on(&mut bench, from + 12 * period);
        let what = case.what();
        let off = bench.amplifier_off(from).unwrap_or_else(|| panic!("{what}: it stays on"));
        case.check_bound(off - from, period);
        case.check_told(&mut bench);
        // Nothing but arming brings the torque back.
        assert_eq!(bench.board().torque(), Some(MID_SCALE), "{what}");
        assert_eq!(bench.board().amplifier(), Level::Low, "{what}");
        assert_eq!(bench.arm(), Outcome::Done, "{what}");
    }
}
