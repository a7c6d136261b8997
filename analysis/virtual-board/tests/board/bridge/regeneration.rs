//! The energy that a hand returns to a supply that takes none.

use haptic_servo::current::Push;
use virtual_board::power_stage::Supply;

use super::bench::{armed, boot, circuit};
use super::bridge_wall::{SCENE, TRANSDUCERS};
use super::paddle::Paddle;

#[test]
fn experiment() {
    let bus = haptic_servo::current::Bus { voltage: 24.0, capacitance: 1e-3, fault_level: 24.65 };
    let push = Push { torque: 1.0, speed: TRANSDUCERS.largest_speed, injected: 0.0, winding: 0.0 };
    println!("{:?}", bus.check(&SCENE.as_data(), &push));
    println!("{}", bus.check(&SCENE.as_data(), &push).unwrap_err());
    for (capacitance, back, hit) in [
        (10e-3, -0.2, 0.95),
        (10e-3, -0.35, 0.35),
        (10e-3, -0.35, 0.9),
        (10e-3, -0.55, 0.9),
        (10e-3, 0.0, 0.9),
        (1e-3, -0.35, 0.9),
        (1e-3, -0.2, 0.9),
    ] {
        let hand = move |time: f64| {
            if time < 0.2 {
                0.0
            } else if time < 0.3 {
                back
            } else if time < 0.33 {
                hit
            } else {
                0.0
            }
        };
        let mut bench = boot(Paddle::new(hand, 0.0));
        circuit(&mut bench).supply = Supply::that_stores(24.0, capacitance);
        armed(&mut bench);
        let (mut highest, mut fastest) = (24.0f64, 0.0f64);
        let mut before = 0;
        for _ in 0..900 {
            bench.run(1);
            highest = highest.max(circuit(&mut bench).supply.volts);
            let count = bench.pins().samples.last().map_or(0, |s| s.count);
            fastest = fastest.max((count.wrapping_sub(before)).abs() as f64);
            before = count;
        }
        let joule = 0.5 * capacitance * (highest * highest - 576.0);
        let told = bench.status().fault;
        let deepest = bench.pins().samples.iter().map(|s| s.count as i16).max().unwrap() as f64;
        let rad = std::f64::consts::TAU / TRANSDUCERS.counts_per_turn;
        println!(
            "{capacitance} {back} {hit}: {highest:.3} V {joule:.5} J, {:.1} rad/s, {:.4} rad, {told:?}",
            fastest * rad * 1e3,
            deepest * rad
        );
    }
}
