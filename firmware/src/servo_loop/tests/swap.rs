//! Arming, disarming and swapping sets: whole, in their order, and without a step in torque.

use super::*;
use crate::certificate::Parameter;
use crate::environment::Canceller;
use crate::servo::SupportsTiming;
use crate::tuning::{self, Tunable};

/// Largest change from one code to the next.
pub fn largest_step(codes: &[i32]) -> i32 {
    codes.windows(2).map(|pair| (pair[1] - pair[0]).abs()).max().unwrap()
}

pub fn set<E: Tunable<f32> + SupportsTiming<Latched>>(
    program: &Program<E>,
    changes: &[(Parameter, f64)],
) -> PreparedServo<E, f32, Latched> {
    let Program { scene, transducers, rendering, .. } = program;
    tuning::prepare(scene, changes, transducers, rendering).unwrap().rendering
}

/// Counts of a hand that goes in and out, slowly enough that no scene here changes its torque by
/// more than a ramp does.
fn hand() -> impl Iterator<Item = i32> {
    (0..).map(|k: i32| (600.0 + 500.0 * (f64::from(k) * 0.004).sin()) as i32)
}

/// Swaps sets while the hand moves, at moments that fall anywhere in the ramps, and sees to it
/// that no code is further from the last one than a step of a swap's ramp and the scene's own change.
fn swaps_without_a_step(wall: Wall, changes: [&[(Parameter, f64)]; 2], own: i32) {
    let program = program(wall.alone());
    let mut bench: Bench<_, f32, Latched> = Bench::armed(&program, Board::new()).unwrap();
    let mut applied = 0;
    for (k, count) in hand().take(20_000).enumerate() {
        if k % 397 == 0 {
            let _ = bench.requests.submit(set(&program, changes[k / 397 % 2]));
        }
        match k % 4999 {
            3000 => _ = bench.requests.disarm(),
            3100 | 4000 => _ = bench.requests.arm(),
            _ => {}
        }
        bench.tick(count);
        applied += bench.notices().iter().filter(|n| **n == Notice::Applied).count();
    }
    assert!(applied > 20, "{applied}");
    let codes = bench.board.codes();
    assert!(codes.iter().any(|code| *code != 2048), "no torque at all");
    let largest = largest_step(&codes);
    // A tenth of the torque limit's 895.5 codes.
    assert!(largest <= 90 + own, "a step of {largest} codes");
    assert!(largest > 50, "{largest}: no swap was quick");
}

#[test]
fn no_swap_makes_a_step() {
    use Parameter::{Damping, Face, Filter, Residual, Stiffness, TorqueLimit};
    let spring = Wall::spring(11.0, 1);
    swaps_without_a_step(spring, [&[(Stiffness, 3.0)], &[(Stiffness, 21.0)]], 8);
    let wall = Wall::damped(6.0, 0.002, 2);
    swaps_without_a_step(
        wall,
        [&[(Stiffness, 2.0), (TorqueLimit, 0.3)], &[(Stiffness, 9.0), (Damping, 0.004)]],
        8,
    );
    let faced = Wall::damped(9.0, 0.002, 1).behind(0.02);
    swaps_without_a_step(faced, [&[(Face, -0.05)], &[(Face, 0.04), (Stiffness, 19.0)]], 8);
    let filtered = Wall::damped(1.0, 0.004, 8).filtered(0.8);
    swaps_without_a_step(filtered, [&[(Filter, 0.2)], &[(Stiffness, 2.0)]], 8);
    let free = Canceller { residual: 0.015, delay: 1 }.alone();
    let scene = program(free);
    assert!(
        tuning::prepare::<_, f32, Latched>(
            &scene.scene,
            &[(Residual, 0.01)],
            &scene.transducers,
            &scene.rendering
        )
        .is_ok()
    );
}

#[test]
fn a_set_is_the_one_that_was_built_and_runs_as_one_that_always_ran() {
    let mut bench = running(&SPRING, 300);
    let stiff = [(Parameter::Stiffness, 20.0), (Parameter::TorqueLimit, 0.7)];
    bench.requests.submit(set(&SPRING, &stiff)).unwrap();
    bench.stand(300, 250);
    assert_eq!(bench.notices(), [Notice::Applied]);
    let mut always = SPRING;
    always.scene = tuning::apply(&SPRING.scene, &stiff).unwrap();
    let mut always = running(&always, 300);
    always.stand(300, 200);
    for count in hand().take(500) {
        let (swapped, compiled) = (bench.tick(count), always.tick(count));
        assert_eq!((swapped.code, swapped.limit), (compiled.code, compiled.limit));
    }
}

/// A velocity filter that takes a hundred ticks to forget a position: it never was at another one.
#[test]
fn a_new_set_starts_at_rest_where_the_device_is() {
    let program = program(Wall::damped(2.0, 0.015, 1).filtered(0.98).alone());
    let mut bench: Bench<_, f32, Latched> = Bench::armed(&program, Board::new()).unwrap();
    let swing = |bench: &mut Bench<_, f32, Latched>| {
        let codes = bench.board.codes().len();
        bench.stand(900, 400);
        let codes = &bench.board.codes()[codes..];
        let spring = *codes.last().unwrap();
        // Nothing is added to the spring's torque as the clamp opens, but for a tick in which the spring
        // does not know yet what the coupling gives under the ramp's last step: 2 / 44 of 70 codes.
        assert!(codes.iter().all(|code| (spring - 4..=2048).contains(code)), "{codes:?}");
        spring
    };
    bench.stand(900, 2000);
    let spring = *bench.board.codes().last().unwrap();
    bench.requests.submit(set(&program, &[(Parameter::Damping, 0.014)])).unwrap();
    assert_eq!(swing(&mut bench), spring);
    // So does an armed servo: its state from a fault is not that of the motor.
    bench.board.elapsed = PERIOD;
    bench.stand(900, 20);
    bench.requests.arm();
    assert_eq!(swing(&mut bench), spring);
}

/// With the hand deep enough for the whole torque limit.
#[test]
fn a_swap_takes_the_torque_away_for_as_long_as_it_says() {
    let deep = 900;
    let mut spring = SPRING;
    spring.scene.torque_limit = Some(0.5);
    let mut bench = running(&spring, deep);
    bench.stand(deep, 10);
    let full = bench.tick(deep).code;
    bench.requests.submit(set(&spring, &[(Parameter::Stiffness, 12.0)])).unwrap();
    let codes: Vec<_> = (0..200).map(|_| bench.tick(deep).code).collect();
    let less = codes.iter().filter(|code| **code != full).count();
    let gap = longest_gap(&spring.rendering, 1e-3);
    assert!((gap - 0.036).abs() < 1e-9, "{gap} s");
    assert!((gap - 0.006..=gap).contains(&(less as f64 * 1e-3)), "{less} ticks of {gap} s");
    assert!(codes.contains(&DacCode::MID_SCALE));
    assert_eq!(codes.last(), Some(&full));
}

/// No hand presses on a wall without torque.
#[test]
fn a_swap_does_not_hurry_an_arming() {
    let mut bench = bench(&SPRING);
    bench.stand(500, 30);
    assert_eq!(bench.servo_loop.state(), State::FadingIn);
    bench.requests.submit(set(&SPRING, &[(Parameter::Stiffness, 12.0)])).unwrap();
    bench.stand(500, 130);
    assert_eq!(bench.servo_loop.state(), State::FadingIn);
    assert!(largest_step(&bench.board.codes()) <= 9 + 3);
    bench.stand(500, 20);
    assert_eq!(bench.servo_loop.state(), State::Running);
    // Nor does a swap that is about to begin hurry a disarming.
    bench.requests.submit(set(&SPRING, &[])).unwrap();
    bench.tick(500);
    bench.requests.disarm();
    let before = bench.board.codes().len();
    bench.stand(500, 60);
    assert_eq!(bench.servo_loop.state(), State::Disarmed);
    assert!(largest_step(&bench.board.codes()[before..]) <= 9 + 3);
}

#[test]
fn the_position_is_carried_over() {
    // A 16-bit counter that has wrapped: only the servo knows where the device is.
    let mut bench = running(&SPRING, 0);
    let far = 200_000;
    for k in 0..=far / 500 {
        bench.tick(k * 500);
    }
    bench.requests.submit(set(&SPRING, &[(Parameter::Stiffness, 12.0)])).unwrap();
    bench.stand(far, 300);
    assert!(bench.notices().contains(&Notice::Applied));
    assert_eq!(bench.status().count, i64::from(far));
}

#[test]
fn only_one_set_waits() {
    let mut bench = running(&SPRING, 500);
    bench.requests.submit(set(&SPRING, &[])).unwrap();
    assert!(bench.requests.submit(set(&SPRING, &[])).is_err());
    bench.stand(500, 300);
    assert_eq!(bench.notices(), [Notice::Applied]);
    bench.requests.submit(set(&SPRING, &[])).unwrap();
}

#[test]
fn a_set_for_a_servo_without_torque_is_swapped_at_once() {
    let mut bench = running(&SPRING, 500);
    bench.requests.disarm();
    bench.stand(500, 102);
    assert_eq!(bench.notices(), [Notice::Disarmed]);
    assert!(!bench.board.is_on());
    bench.requests.submit(set(&SPRING, &[])).unwrap();
    bench.tick(500);
    assert_eq!(bench.notices(), [Notice::Applied]);
}

#[test]
fn disarming_closes_from_the_torque_that_is_held() {
    let mut bench = running(&SPRING, 100);
    let held = i32::from(bench.tick(100).code.offset());
    assert!((-100..-80).contains(&held));
    bench.requests.disarm();
    bench.tick(100);
    // No dead time: it does not close from the limit, which is 900 codes away.
    bench.stand(100, 3);
    assert!(bench.board.codes().last().unwrap() - 2048 >= held + 15);
    bench.stand(100, 10);
    assert_eq!(bench.servo_loop.state(), State::Disarmed);
}

#[test]
fn disarming_wins_over_arming_and_a_second_thought_over_both() {
    let mut bench = running(&SPRING, 500);
    bench.requests.arm();
    bench.requests.disarm();
    bench.stand(500, 10);
    assert_eq!(bench.servo_loop.state(), State::FadingOut);
    bench.requests.arm();
    bench.stand(500, 102);
    assert_eq!(bench.servo_loop.state(), State::Running);
    assert_eq!(bench.notices(), [Notice::Armed]);
}
