//! Torque profiles that are changed under the hand: another mode.

use super::swap::{largest_step, set};
use super::*;
use crate::certificate::{Certified, Parameter};
use crate::environment::{KNOB_MODES, Profile};
use crate::scene_type::Typed;

const CERTIFIED: Certified<Scene> =
    limited(program(Profile::of_modes(&KNOB_MODES, 1).alone()), 0.2).scene.certified();
crate::scene_type!(KnobModes: CERTIFIED);
const MODES: Program<Typed<KnobModes>> = limited(program(Typed::<KnobModes>::ENVIRONMENT), 0.2);

const fn limited<E: Copy>(mut program: Program<E>, torque: f64) -> Program<E> {
    program.scene.torque_limit = Some(torque);
    program
}

/// Codes of 1 N m.
const CODES: f64 = 895.5;

/// A hand on a knob that turns slowly while every mode is selected, whatever was selected before.
#[test]
fn every_mode_is_selected_under_a_hand_without_a_step() {
    let mut bench: Bench<_, f32, Latched> = Bench::armed(&MODES, Board::new()).unwrap();
    let modes = KNOB_MODES.len();
    let (mut tick, mut seen) = (0, 0);
    // Each after each.
    for step in 1..modes {
        for place in 0..modes {
            let mode = (place * step % modes) as f64;
            let changed = set(&MODES, &[(Parameter::Mode, mode)]);
            bench.requests.submit(changed).unwrap();
            let before = bench.board.codes().len();
            for _ in 0..120 {
                bench.tick((9000.0 - 9000.0 * (f64::from(tick) * 5e-4).cos()) as i32);
                tick += 1;
            }
            assert_eq!(bench.notices().last(), Some(&Notice::Applied));
            assert_eq!(bench.servo_loop.state(), State::Running);
            let codes = &bench.board.codes()[before..];
            seen += usize::from(codes.iter().any(|code| *code != 2048));
            // The fade of a tick, and what the end stops' 15 N m/rad change in 5 counts.
            assert!(largest_step(codes) <= 18 + 8, "{mode}: {codes:?}");
        }
    }
    assert!(seen > 60, "{seen}");
    assert_eq!(bench.servo_loop.fault(), None);
}

/// A knob that turned freely for many turns is not turned back by the mode that comes next.
#[test]
fn a_mode_does_not_take_back_the_turns_of_the_one_before() {
    const TURN: i32 = 61_440;
    for turns in [-40, 1, 40] {
        let mut bench: Bench<_, f32, Latched> = Bench::armed(&MODES, Board::new()).unwrap();
        let there = turns * TURN + TURN / 8;
        for step in 0..=200 * turns.abs() {
            bench.tick((f64::from(there) * f64::from(step) / f64::from(200 * turns.abs())) as i32);
        }
        bench.stand(there, 200);
        // 45 degrees of a hundred are between the ends, and of the centre's spring half of its torque.
        for (mode, codes) in
            [(1.0, 0.0), (4.0, 0.05 * core::f64::consts::TAU / 8.0 * CODES), (0.0, 0.0)]
        {
            bench.requests.submit(set(&MODES, &[(Parameter::Mode, mode)])).unwrap();
            bench.stand(there, 200);
            let code = f64::from(bench.tick(there).code.offset());
            assert!((code + codes).abs() <= 1.0, "{turns} turns, mode {mode}: {code}");
        }
    }
}
