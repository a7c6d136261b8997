//! What a reset was for, what comes of it, and what a board sets up before its servo runs.

use haptic_servo::fault::Fault;
use haptic_servo::reset::ResetCause;
use haptic_servo::servo_loop::State;
use virtual_board::chip::{Chip, FREEZE, STM32F405, WATCHDOG_FREEZES};
use virtual_board::core::exceptions::NON_MASKABLE;
use virtual_board::device::FixedDevice;
use virtual_board::peripheral::clock::Cause;
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, on_both};

/// Counts into the damper wall.
const INTO: i32 = 300;

/// What the program makes of a reset of a board whose RAM has kept its contents.
fn told(chip: &Chip, cause: Cause) -> ResetCause {
    match cause {
        // The mark in RAM says that the supply was not off.
        Cause::Power | Cause::BrownOut => ResetCause::BrownOut,
        Cause::Pin => ResetCause::Pin,
        Cause::Software => ResetCause::Software,
        Cause::Watchdog => ResetCause::IndependentWatchdog,
        Cause::WindowWatchdog => ResetCause::WindowWatchdog,
        Cause::LowPower => ResetCause::LowPower,
        // The F405 loads them at every reset, and has no flag for it.
        Cause::OptionBytes if chip.name == STM32F405.name => ResetCause::Pin,
        Cause::OptionBytes => ResetCause::OptionBytes,
    }
}

/// The board says what its reset was for, once, and is off.
fn check_off(bench: &mut Bench, reset: ResetCause, what: &str) {
    let samples = bench.pins().samples.len();
    bench.run(200);
    assert_eq!(bench.board().clock.causes(), 0, "{what}: the flags are cleared");
    let status = bench.status();
    assert_eq!((status.reset, status.state), (reset, State::Disarmed), "{what}");
    let watchdog = (reset == ResetCause::IndependentWatchdog).then_some(Fault::Watchdog);
    assert_eq!(bench.fault(), watchdog, "{what}");
    let line = format!("last reset: {}", reset.as_str());
    let log = bench.log();
    let last = log.iter().rfind(|line| line.contains("last reset"));
    assert!(last.is_some_and(|last| last.contains(&line)), "{what}: {log:?}");
    let off = |amplifier: bool, code| !amplifier && matches!(code, None | Some(0 | MID_SCALE));
    let pins = bench.pins();
    // The first sample is that in which it was reset.
    let after = &pins.samples[samples + 1..];
    assert!(after.iter().all(|sample| off(sample.amplifier, sample.code)), "{what}");
}

#[test]
fn every_cause_of_a_reset_is_told_and_none_arms_the_servo() {
    on_both(|chip| {
        for cause in Cause::ALL {
            let what = format!("{cause:?}");
            let mut bench = Bench::running(chip, "damper_wall");
            bench.turn(INTO);
            bench.run(20);
            assert_eq!(bench.board().amplifier(), Level::High, "{what}");
            assert_ne!(bench.board().torque(), Some(MID_SCALE), "{what}");
            bench.machine.reset(cause);
            assert_ne!(bench.board().amplifier(), Level::High, "{what}");
            check_off(&mut bench, told(chip, cause), &what);
        }
    });
}

#[test]
fn a_supply_that_was_off_is_told_from_one_that_was_low_and_arms_nothing() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
        check_off(&mut bench, ResetCause::PowerOn, "");
        bench.armed();
        bench.machine.power_cycle();
        check_off(&mut bench, ResetCause::PowerOn, "");
        bench.machine.reset(Cause::Pin);
        check_off(&mut bench, ResetCause::Pin, "");
    });
}

/// A watchdog that bites before the program has looked at the flags of the reset before.
#[test]
fn of_two_causes_the_watchdog_is_named() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
        bench.run_for(10);
        bench.machine.reset(Cause::Software);
        bench.machine.reset(Cause::Watchdog);
        check_off(&mut bench, ResetCause::IndependentWatchdog, "");
    });
}

/// The flags of the chip's own memories, which only the G4 chips have: register, bits, and what the
/// fault has to say.
#[test]
fn a_word_that_flash_or_ram_cannot_give_is_named() {
    const PLACE: u32 = 0x1238;
    let ecc = |status| Fault::FlashEcc { address: PLACE, status };
    let chip = Chip::find("nucleo-g474re").unwrap();
    // Of either half of a word of 128 bits.
    for bit in [31, 29] {
        let status = 1 << bit | PLACE;
        let mut bench = Bench::running(chip, "damper_wall");
        bench.board_mut().flash.set(0x18, status);
        check_named(&mut bench, ecc(status));
    }
    let mut bench = Bench::running(chip, "damper_wall");
    bench.board_mut().configuration.set(0x1C, 1 << 8);
    check_named(&mut bench, Fault::RamParity);
}

/// A non-maskable interrupt takes the torque away at once, and after the watchdog's reset the board
/// says what it was.
fn check_named(bench: &mut Bench, fault: Fault) {
    bench.turn(INTO);
    bench.run(20);
    let board = bench.board_mut();
    board.system.exceptions.pend(NON_MASKABLE);
    let began = board.now;
    bench.run(300);
    let off = bench.amplifier_off(began).unwrap();
    assert!(off - began < 200, "{fault:?}: {} instructions", off - began);
    assert_eq!(bench.machine.resets().len(), 1, "{fault:?}");
    let status = bench.status();
    assert_eq!(status.state, State::Disarmed, "{fault:?}");
    assert_eq!(bench.fault(), Some(fault));
    let log = bench.log();
    assert!(log.iter().any(|line| line.contains(fault.as_str())), "{log:?}");
}

/// Places in the flash memory's interface.
const ACR: u32 = 0x00;
/// ACR: data cache, instruction cache, prefetch.
const DATA: u32 = 1 << 10;
const INSTRUCTIONS: u32 = 1 << 9;
const PREFETCH: u32 = 1 << 8;

/// With the wait states of the core's clock, which the drivers write over the rest.
#[test]
fn flash_is_read_through_its_caches() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
        bench.run(3);
        let access = bench.board().flash.get(ACR);
        let (caches, wait_states) = match chip.name {
            // Its prefetching is no gain where the servo runs from core-coupled memory.
            "nucleo-g474re" => (DATA | INSTRUCTIONS, 4),
            _ => (DATA | INSTRUCTIONS | PREFETCH, 5),
        };
        let all = DATA | INSTRUCTIONS | PREFETCH;
        assert_eq!((access & all, access & 0xF), (caches, wait_states));
    });
}

/// Chips of the F405's first revision, and those that give another chip's number as these did, must
/// not prefetch.
#[test]
fn the_first_revision_does_not_prefetch() {
    for identity in [0x1000_6413, 0x2000_6411] {
        let mut bench = Bench::boot(&STM32F405, "damper_wall", FixedDevice);
        bench.board_mut().debug.set(0x00, identity);
        bench.run(3);
        let access = bench.board().flash.get(ACR);
        assert_eq!(access & (DATA | INSTRUCTIONS | PREFETCH), DATA | INSTRUCTIONS);
    }
}

#[test]
fn a_brown_out_level_that_is_too_low_is_said_with_the_way_to_set_it() {
    on_both(|chip| {
        // As delivered, and as they are to be.
        let (field, enough) = match chip.name {
            "nucleo-g474re" => (0b111 << 8, 0b100 << 8),
            _ => (0b11 << 2, 0),
        };
        for is_enough in [false, true] {
            let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
            if is_enough {
                let options = bench.board().flash.get(chip.options) & !field | enough;
                bench.board_mut().flash.set(chip.options, options);
            }
            bench.run(3);
            let log = bench.log();
            let warns = |line: &String| line.contains("brown-out") && line.contains("-ob BOR_LEV=");
            assert_eq!(log.iter().any(warns), !is_enough, "{log:?}");
            assert_eq!(bench.status().low_brown_out, !is_enough);
        }
    });
}

/// A debugger may have asked for the watchdog to halt with the core: a breakpoint would hold the torque.
#[test]
fn the_watchdog_runs_on_at_a_breakpoint() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
        bench.board_mut().debug.set(FREEZE, WATCHDOG_FREEZES);
        bench.run(3);
        assert_eq!(bench.board().debug.get(FREEZE), 0);
    });
}
