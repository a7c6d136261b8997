//! A motor that its encoder's index aligns after a reset.

use std::f64::consts::TAU;

use haptic_servo::current::{IndexOffset, Winding};
use virtual_board::encoder_index::EncoderIndex;
use virtual_board::power_stage::gate_log::any_high;

use super::bench::gates;
use super::brushless::{Held, check_stays_off, check_torque, wired};
use super::brushless_index::{DRIVE, OFFSET, TRANSDUCERS};
use crate::bench::Bench;

const COUNTS: f64 = TRANSDUCERS.counts_per_turn;
/// Where the index is, in counts: a little outside of the wall.
const AT: i64 = -300;
/// Counts for which it lasts.
const WIDTH: i64 = 2;
/// Torque of the hand in N m that turns the shaft past it.
const TURNS: f64 = 0.02;

/// Counts of an electrical turn.
fn electrical_counts() -> f64 {
    let Winding::Brushless { pole_pairs } = DRIVE.motor.winding else { panic!("it is brushless") };
    COUNTS / f64::from(pole_pairs)
}

/// The magnets' angle at the angle zero with which they are at this offset where the index is.
fn magnets(offset: f64) -> f64 {
    (offset - AT as f64) / electrical_counts() * TAU
}

/// A board out of reset whose motor has the offset of its program, and whose gates are recorded.
fn unaligned() -> Held {
    let motor = wired([0, 1, 2], magnets(f64::from(OFFSET.counts)));
    let mut held = Held::new("brushless_index", motor);
    let board = held.bench.board_mut();
    (board.index, board.gates) = (Some(index()), Some(Vec::new()));
    held.bench.run(200);
    held
}

fn index() -> EncoderIndex {
    EncoderIndex::new(COUNTS as i64, AT, WIDTH)
}

/// What the board says of the motor at the index.
fn told(bench: &mut Bench) -> Option<IndexOffset> {
    bench.status().power.and_then(|power| power.index)
}

/// Turns the shaft past the index, and lets it come to rest.
fn turn_past(held: &mut Held) -> Option<IndexOffset> {
    held.push(-TURNS);
    held.bench.run_until(50, 3000, |bench| told(bench).is_some());
    held.push(0.0);
    held.bench.run(500);
    told(&mut held.bench)
}

/// A servo that holds the shaft in its wall, against a hand, after its index has aligned it.
pub fn leaning() -> Held {
    let mut held = unaligned();
    assert_eq!(turn_past(&mut held), Some(OFFSET));
    check_torque(&mut held, "by the index");
    held
}

/// The encoder's counter has lost counts, and the index comes.
pub fn comes_elsewhere(bench: &mut Bench) {
    let board = bench.board_mut();
    let index = board.index.as_mut().expect("it has an index");
    index.position = index.at - 1;
    board.turn_encoder(1);
}

#[test]
fn the_first_index_after_a_reset_aligns_the_motor_and_no_gate_is_high_before() {
    let mut held = unaligned();
    check_stays_off(&mut held.bench);
    let fault = held.bench.fault().unwrap().to_string();
    assert!(fault.contains("turn the handle past the encoder's index, or align it"), "{fault}");
    assert_eq!(turn_past(&mut held), Some(OFFSET));
    let bench = &held.bench;
    assert!(!any_high(gates(bench), 0, bench.now()));
    // As late as the other two inputs, and pulled by the board alone.
    let encoder = &bench.board().encoder;
    assert_eq!(encoder.filters(), [encoder.index_filter(); 2]);
    check_torque(&mut held, "by the index");
}
