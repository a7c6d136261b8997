//! Events that are not faults, or cannot be detected as faults: nothing unsafe follows.

use analysis::program::Program;
use haptic_servo::servo_loop::State;
use unicorn_engine::RegisterARM;
use virtual_board::chip::Chip;
use virtual_board::device::FixedDevice;
use virtual_board::error::BoardError;
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, on_both};
use crate::device::HandHeldDevice;
use crate::faults::{Register, coefficient};
use crate::stub::{Masks, hold_up};

/// Counts into the damper wall, and the codes of its torque limit of 1 N m.
const INTO: i32 = 300;
const LIMIT: u16 = 896;

/// A servo that pushes, and goes on to do so.
fn pushing(chip: &'static Chip) -> Bench {
    let mut bench = Bench::running(chip, "damper_wall");
    bench.turn(INTO);
    bench.run(20);
    bench
}

/// Nothing was missed, and nothing has stopped the servo.
fn assert_running(bench: &mut Bench) {
    let status = bench.status();
    assert_eq!((status.state, status.fault, status.missed), (State::Running, None, 0));
}

#[test]
fn a_slow_interrupt_below_the_servo_s_makes_no_tick_late() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        let slack = bench.status().worst_slack;
        let period = bench.period();
        let (began, before) = (bench.now(), bench.board().samples);
        hold_up(&mut bench, 5 * period, Masks::None);
        bench.run_for(5 * period);
        let ticks = bench.board().meter.interrupt().count;
        assert_eq!(ticks, bench.board().samples);
        assert!(bench.board().samples - before >= (bench.now() - began) / period);
        assert_running(&mut bench);
        // Each began with the first instruction of its period, as before.
        let slower = slack - bench.status().worst_slack;
        assert!(slower < 100, "{slower} counts less of a period are left");
    });
}

#[test]
fn what_masks_all_but_the_servo_makes_no_tick_late() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        bench.machine.core_mut().set_register(RegisterARM::BASEPRI, 0x10);
        bench.run(5);
        bench.machine.core_mut().set_register(RegisterARM::BASEPRI, 0);
        assert_running(&mut bench);
    });
}

/// A delayed tick is a fault, although its code would be in time: see the faults.
#[test]
fn what_masks_the_servo_between_two_ticks_makes_no_tick_late() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        let (period, slack) = (bench.period(), bench.status().worst_slack);
        bench.run_to_update();
        bench.run_for(period / 10);
        hold_up(&mut bench, period * 8 / 10, Masks::All);
        bench.run(5);
        assert_running(&mut bench);
        let slower = slack - bench.status().worst_slack;
        assert!(slower < 100, "{slower} counts less of a period are left");
    });
}

/// A constant count cannot be distinguished from a device at rest.
#[test]
fn an_encoder_that_is_unplugged_leaves_a_constant_torque_within_the_limit() {
    on_both(|chip| {
        let mut bench = Bench::boot(
            chip,
            "damper_wall",
            HandHeldDevice::of(Program::find("damper_wall").unwrap()),
        );
        bench.armed();
        // In the wall, where the hand rests.
        bench.run(1700);
        bench.pins().plugged = false;
        // Time for the wall to settle, and for the hand to leave it, come again and let go.
        bench.run(3000);
        let samples = bench.pins().samples.clone();
        let last = samples.last().unwrap().code.unwrap();
        let is_constant = samples[2200..].iter().all(|sample| sample.code == Some(last));
        assert!(is_constant && last.abs_diff(MID_SCALE) <= LIMIT, "{last}");
        assert_ne!(last, MID_SCALE, "it was in the wall");
        assert_running(&mut bench);
    });
}

#[test]
fn a_crystal_that_does_not_start_leaves_every_pin_alone() {
    on_both(|chip| {
        let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
        bench.board_mut().clock.crystal_runs = false;
        // Ten times what it takes to be ready otherwise.
        bench.run_for(3_000_000);
        assert!(bench.events().is_empty(), "{:?}", bench.events());
        assert!(!bench.board().tick_timer.runs());
    });
}

#[test]
fn a_peripheral_that_is_broken_at_power_on_leaves_the_amplifier_off() {
    on_both(|chip| {
        for register in [Register::Encoder, Register::Dac] {
            let mut bench = Bench::boot(chip, "damper_wall", FixedDevice);
            bench.board_mut().broken = Some(register.address(chip));
            let end = bench.machine.run_for(3_000_000);
            let what = format!("{register:?}: {end:?}");
            // The handler of faults wants the DAC, too.
            let locked_up = matches!(end, Err(BoardError::LockedUp { .. }));
            assert_eq!(locked_up, register == Register::Dac, "{what}");
            assert_eq!(bench.board().amplifier(), Level::Low, "{what}");
            assert_eq!(bench.amplifier_on(), None, "{what}");
        }
    });
}

/// A wall with a face never pulls, and goes by the sign there, also by that of no number.
#[test]
fn a_position_that_is_no_number_with_a_negative_sign_gives_no_torque() {
    on_both(|chip| {
        let mut bench = pushing(chip);
        let negative = (-f32::NAN).to_le_bytes();
        for place in coefficient(&mut bench) {
            assert!(bench.machine.core_mut().set_memory(place, &negative));
        }
        bench.run(3);
        assert_eq!(bench.board().torque(), Some(MID_SCALE));
        assert_running(&mut bench);
    });
}
