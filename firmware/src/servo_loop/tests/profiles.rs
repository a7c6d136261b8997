//! Torque profiles that are changed under the hand: another torque, another number of detents, another mode.

use super::swap::{largest_step, set};
use super::*;
use crate::certificate::{Certified, Parameter};
use crate::environment::{KNOB_MODES, Knots, Profile, Shape};
use crate::scene_type::Typed;
use crate::tuning;

static DETENTS: Knots<16> = Knots::of(&[Shape::detents(24, 0.05)]);

/// With a torque limit near their torque, so that a step of the fade is small beside it.
const KNOB: Program<Environment> = limited(program(Profile::of(&DETENTS, 1).alone()), 0.1);
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

/// The code of detents at a count at rest, by their own formula: a wave of straight lines whose top is
/// `torque`, behind a coupling of 44 N m/rad.
fn detents(count: i32, detents: f64, torque: f64) -> f64 {
    let mut behind = 0.0;
    for _ in 0..100 {
        let angle = f64::from(count) / 61_440.0 * core::f64::consts::TAU - behind / 44.0;
        let places = angle / core::f64::consts::TAU * detents;
        let away = places - places.round();
        let falls = (2.0 - 4.0 * away.abs()) * away.signum();
        behind = torque * if away.abs() < 0.25 { 4.0 * away } else { falls };
    }
    2048.0 - behind * CODES
}

/// The hand holds still where the old torque and the new one differ: what it feels of the change is a torque
/// that falls away, nothing, and a torque that comes back.
#[test]
fn the_torque_and_the_number_of_detents_change_without_a_step() {
    // A quarter of the pitch of 24 detents, where theirs is largest; that of 20 ones is less.
    let count = 61_440 / 96;
    let mut bench: Bench<_, f32, Latched> = Bench::armed(&KNOB, Board::new()).unwrap();
    bench.stand(count, 200);
    let mut scene = KNOB;
    for (number, torque, changes) in [
        (20.0, 0.05, &[(Parameter::Count, 20.0)][..]),
        (20.0, 0.02, &[(Parameter::ProfileTorque, 0.02)]),
        (24.0, 0.08, &[(Parameter::ProfileTorque, 0.08), (Parameter::Count, 24.0)]),
        (24.0, 0.08, &[(Parameter::Centre, core::f64::consts::TAU / 96.0)]),
    ] {
        let before = bench.board.codes().len() - 1;
        bench.requests.submit(set(&scene, changes)).unwrap();
        scene.scene = tuning::apply(&scene.scene, changes).unwrap();
        bench.stand(count, 60);
        assert_eq!(bench.notices().last(), Some(&Notice::Applied));
        let codes = &bench.board.codes()[before..];
        let (old, new) = (codes[0], *codes.last().unwrap());
        let is_centre = changes[0].0 == Parameter::Centre;
        let expected = if is_centre { 2048.0 } else { detents(count, number, torque) };
        assert!((f64::from(new) - expected).abs() <= 1.0, "{changes:?}: {new}, not {expected}");
        assert_ne!(old, new, "{changes:?}");
        // A tenth of the torque limit a tick, which is ten steps of a clamp that opens in a hundred ticks.
        let fade = (0.1 * 0.1 * CODES).ceil() as i32;
        assert!(largest_step(codes) <= fade, "{changes:?}: {codes:?}");
        // Away for ten ticks and more, as long as a new set runs before its clamp opens.
        let gap = codes.iter().filter(|code| **code == 2048).count();
        assert!(gap >= 10, "{changes:?}: {codes:?}");
        // Never more than before or after, and on their side, but for a tick in which the detents do not know
        // yet what the coupling gives under the ramp's last step.
        let (low, high) = (old.min(new) - 1, old.max(new).max(2048));
        assert!(codes.iter().all(|code| (low..=high).contains(code)), "{changes:?}: {codes:?}");
        let gap = longest_gap(&KNOB.rendering, 1e-3);
        let settled = (gap * 1e3) as usize + 1;
        assert!(codes[settled..].iter().all(|code| *code == new), "{changes:?}: {codes:?}");
    }
}

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
