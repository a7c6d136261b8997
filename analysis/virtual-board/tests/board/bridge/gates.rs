//! When the gates are high, and when never.

use virtual_board::chip::{B_G431B_ESC1, FREEZE_TIM1, TIM1_FREEZES};
use virtual_board::error::BoardError;
use virtual_board::peripheral::clock::Cause;
use virtual_board::power_stage::gate_log::{any_high, first_high, off_since, shortest_dead_time};

use super::bench::{INSTANT, armed, boot, circuit, gates, has_high_gate, running};
use super::bridge_wall::CURRENT_LOOP;
use super::paddle::still;
use crate::bench::Bench;

/// The first port of pins.
const PORTS: u32 = 0x4800_0000;
/// Counts into the wall.
pub const INTO: i32 = 200;

/// A servo that pushes against a paddle that is held.
pub fn pushing() -> Bench {
    let mut bench = running(still());
    circuit(&mut bench).is_blocked = true;
    bench.turn(INTO);
    bench.run(20);
    let torque = circuit(&mut bench).mean_torque();
    assert!(torque < -0.2, "{torque} N m");
    bench
}

#[test]
fn no_gate_is_high_before_the_servo_is_armed() {
    let mut bench = boot(still());
    bench.run(300);
    let now = bench.now();
    assert!(!any_high(gates(&bench), 0, now));
    armed(&mut bench);
    bench.run(1);
    assert!(has_high_gate(bench.board()));
    assert!(first_high(gates(&bench), 0).unwrap() > now);
}

#[test]
fn no_two_switches_of_a_leg_are_on_within_the_dead_time() {
    let bench = pushing();
    // 0.74 us, just below the 0.75 us of ST's configuration, in core clocks of 170 MHz.
    assert_eq!(shortest_dead_time(gates(&bench)), Some(126));
    assert_eq!(bench.board().power_stage.timer.dead_time(), 126);
    assert_eq!(INSTANT, u64::from(CURRENT_LOOP.clock_counts()) / u64::from(CURRENT_LOOP.updates()));
}

/// A halted core would leave its last duties on the bridge.
#[test]
fn a_debugger_that_halts_the_core_stops_the_modulation() {
    let bench = pushing();
    assert_eq!(bench.board().debug.get(FREEZE_TIM1), TIM1_FREEZES);
}

/// Of every cause: off at that clock, and until it is armed again.
#[test]
fn a_reset_takes_the_gates_away_at_once() {
    for cause in Cause::ALL {
        let mut bench = pushing();
        bench.machine.reset(cause);
        let reset = bench.now();
        assert!(!has_high_gate(bench.board()), "{cause:?}");
        bench.run(200);
        let off = off_since(gates(&bench)).unwrap_or_else(|| panic!("{cause:?}"));
        assert!(off <= reset, "{cause:?}: {off} after {reset}");
        assert_eq!(circuit(&mut bench).currents(), [0.0; 3], "{cause:?}");
        armed(&mut bench);
        bench.run(1);
        assert!(has_high_gate(bench.board()), "{cause:?}");
    }
}

/// What the virtual board finds by itself: both switches of a leg are on, here of U by pins that are outputs.
#[test]
fn two_switches_of_a_leg_are_never_on_unnoticed() {
    let mut bench = pushing();
    for (gate, _) in B_G431B_ESC1.gates.unwrap().iter().step_by(3) {
        let ((port, pin), board) = (*gate, bench.board_mut());
        let base = PORTS + 0x400 * port as u32;
        let modes = board.read(base, 4) & !(0b11 << (2 * pin));
        board.write(base + 0x18, 4, 1 << pin);
        board.write(base, 4, modes | 0b01 << (2 * pin));
    }
    let end = bench.machine.run_for(10);
    assert!(matches!(end, Err(BoardError::ShootThrough { leg: 0, .. })), "{end:?}");
}

/// A converter samples behind an amplifier that is off.
#[test]
fn a_channel_that_nothing_drives_is_named() {
    const OPAMP1: u32 = 0x4001_0300;
    let mut bench = pushing();
    bench.board_mut().write(OPAMP1, 4, 0);
    let end = bench.machine.run_for(2 * INSTANT).unwrap_err().to_string();
    assert!(end.contains("ADC1") && end.contains("nothing drives"), "{end}");
}

/// The drivers supply the gates of the high sides from capacitors, which only the low sides charge: here too slowly.
#[test]
fn a_high_side_whose_supply_is_not_charged_does_not_conduct() {
    let mut bench = boot(still());
    circuit(&mut bench).parts.bootstrap = 1.0;
    armed(&mut bench);
    bench.run(125);
    let board = bench.board();
    assert!(board.power_stage.uncharged().is_some());
    assert_eq!(board.power_stage.circuit.currents(), [0.0; 3]);
}
