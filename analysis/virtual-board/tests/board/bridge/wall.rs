//! The wall in a hand, by the current that the bridge makes.

use std::f64::consts::TAU;

use haptic_servo::servo_loop::State;
use virtual_board::power_stage::Supply;

use super::bench::{armed, boot, circuit};
use super::bridge_wall::{SCENE, TRANSDUCERS};
use super::paddle::paddle;

/// Torque of the hand and Coulomb friction in N m.
const TORQUE: f64 = 0.45;
const FRICTION: f64 = 0.01;

/// Leans against the wall from a quarter of a second on, and lets go from 1.2 s on.
fn leans(time: f64) -> f64 {
    let grown = ((time - 0.25) / 0.25).clamp(0.0, 1.0);
    let left = ((1.4 - time) / 0.2).clamp(0.0, 1.0);
    TORQUE * grown.min(left)
}

/// With some friction it stands still where the wall's stiffness has it, and the motor's torque is the hand's.
#[test]
fn a_hand_that_leans_against_the_wall_comes_to_rest() {
    let mut bench = boot(paddle(leans, FRICTION));
    let armed = armed(&mut bench);
    bench.run(1000);
    let torque = circuit(&mut bench).mean_torque();
    bench.run(900);
    let samples = bench.pins().samples[armed..].to_vec();
    let angle = |count: i32| (f64::from(count) + 0.5) * TAU / TRANSDUCERS.counts_per_turn;
    let leaning: Vec<_> = samples[800..1100].iter().map(|sample| sample.count).collect();
    let spread = leaning.iter().max().unwrap() - leaning.iter().min().unwrap();
    let stiffness = TORQUE / angle(leaning[100]);
    println!("{spread} counts of motion, {stiffness:.2} N m/rad, {torque:.4} N m");
    let free: Vec<_> = samples[1700..].iter().map(|sample| sample.count).collect();
    assert!(SCENE.torque_limit.is_some_and(|limit| limit > TORQUE));
    assert!(spread <= 1);
    // The rest is friction.
    assert!((torque + TORQUE).abs() <= FRICTION, "{torque} N m");
    // Let go, the friction holds it where the wall pushes no harder.
    let held = FRICTION / stiffness;
    assert!(free.iter().all(|&count| count == free[0]) && angle(free[0]) < held, "{:?}", free[0]);
    assert!(bench.is_on());
}

/// The motor throws the bare device, and its back-EMF changes as fast as it can.
#[test]
fn a_hand_that_lets_go_at_the_torque_limit_is_no_fault() {
    const END: f64 = 0.3;
    let limit = SCENE.torque_limit.expect("the scene has a limit");
    let grown = |time: f64| ((time - 0.15) / 0.1).clamp(0.0, 1.0);
    let hand = move |time: f64| if time < END { 0.99 * limit * grown(time) } else { 0.0 };
    let mut bench = boot(paddle(hand, 0.0));
    circuit(&mut bench).supply = Supply::stiff(24.0);
    let armed = armed(&mut bench);
    bench.run((END * 1e3) as u64 - 1);
    let pushed = circuit(&mut bench).mean_torque();
    bench.run(40);
    let counts: Vec<_> = bench.pins().samples[armed..].iter().map(|it| it.count).collect();
    let back = counts.windows(2).map(|pair| pair[0] - pair[1]).max().unwrap();
    let most = TRANSDUCERS.largest_speed * TRANSDUCERS.counts_per_turn / TAU * 1e-3;
    println!("{pushed:.3} N m, then up to {back} counts in a ms, of {most:.0}");
    assert_eq!((bench.fault(), bench.status().state), (None, State::Running));
    assert!(pushed < -0.95 * limit && f64::from(back) > 0.4 * most, "{pushed}, {back}");
}
