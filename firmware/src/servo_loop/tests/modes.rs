//! The same cycle in every mode and number format, and the energy that it sees.

use fixed::types::I8F24;

use super::*;
use crate::servo::{Simultaneous, SupportsTiming};
use crate::tuning::Tunable;

/// Counts of a hand that pushes in and lets go, again and again.
fn hand() -> impl Iterator<Item = i32> {
    (0..3000).map(|k: i32| (700.0 * (f64::from(k) * 0.01).sin()) as i32)
}

/// Codes that are written while the hand moves, from the first tick on.
fn codes<N: Number, M: OutputMode>() -> Vec<i32>
where
    Environment: Tunable<N> + SupportsTiming<M>,
{
    let mut bench: Bench<Environment, N, M> = Bench::armed(&SPRING, Board::new()).unwrap();
    hand().for_each(|count| {
        bench.tick(count);
    });
    assert_eq!(bench.servo_loop.state(), State::Running);
    bench.board.codes()
}

#[test]
fn a_code_is_written_a_tick_early_where_the_torque_takes_a_sample() {
    let latched = codes::<f32, Latched>();
    // Once it fades no more.
    assert_eq!(codes::<f32, Simultaneous>()[300..], latched[299..latched.len() - 1]);
}

#[test]
fn a_fixed_point_servo_fades_and_runs_as_well() {
    let (float, fixed) = (codes::<f32, Latched>(), codes::<I8F24, Latched>());
    assert!(float.iter().zip(&fixed).all(|(a, b)| (a - b).abs() <= 1));
}

#[test]
fn the_status_has_the_energy_since_the_servo_was_armed() {
    let mut bench = bench(&SPRING);
    let (mut sum, mut worst, mut last) = (0_i64, 0_i64, 0);
    for (k, count) in hand().enumerate() {
        bench.tick(count);
        // The code at the motor since the last count was written two ticks ago; the board's first code is its
        // code at boot.
        let held = if k > 1 { bench.board.codes()[k - 1] - 2048 } else { 0 };
        sum += i64::from(held) * i64::from(count - last);
        worst = worst.max(sum);
        last = count;
    }
    let status = bench.status();
    assert_eq!((status.energy, status.worst_deficit), (sum, worst));
    assert!(worst > 0, "a hand that is moved by force gets something back");
    bench.requests.disarm();
    bench.stand(last, 200);
    bench.requests.arm();
    bench.tick(last);
    assert_eq!((bench.status().energy, bench.status().worst_deficit), (0, 0));
}

#[test]
fn injected_damping_is_felt_only_while_there_is_a_deficit() {
    let mut program = SPRING;
    program.rendering.injection = Some(0.01);
    let (mut injecting, mut plain) = (bench(&program), bench(&SPRING));
    let mut differed = 0;
    for count in hand() {
        let deficit = injecting.servo_loop.energy.is_deficit();
        let (with, without) = (injecting.tick(count).code, plain.tick(count).code);
        differed += usize::from(with != without);
        // Torque injected before decays with the coupling's echo, a quarter a tick.
        assert!(deficit || differed > 0 || with == without);
    }
    assert!(differed > 100, "{differed}");
    program.rendering.injection = Some(0.02);
    let refused = Bench::<Environment, f32, Latched>::boot(&program, Board::new()).map(|_| ());
    assert_eq!(refused.err(), Some(Step::Servo));
}
