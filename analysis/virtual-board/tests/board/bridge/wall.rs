//! The wall in a hand, by the current that the bridge makes.

use std::f64::consts::TAU;

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
