//! A hand that pushes into a wall to the torque limit and lets go at once.

use std::f64::consts::TAU;

use haptic_servo::wire::message::FaultCode;
use virtual_board::power_stage::Supply;

use super::bench::{armed, boot, circuit};
use super::bridge_wall::{SCENE, TRANSDUCERS};
use super::paddle::Paddle;

fn run(part: f64, end: f64) {
    let limit = SCENE.torque_limit.unwrap();
    let hand = move |t: f64| {
        if t < end { part * limit * ((t - 0.15) / 0.1).clamp(0.0, 1.0) } else { 0.0 }
    };
    let mut bench = boot(Paddle::new(hand, 0.0));
    circuit(&mut bench).supply = Supply::stiff(24.0);
    let from = armed(&mut bench);
    bench.run((end * 1e3) as u64 + 60);
    let fault = bench.status().fault.and_then(FaultCode::fault);
    let counts: Vec<_> = bench.pins().samples[from..].iter().map(|s| s.count).collect();
    let unit = TAU / TRANSDUCERS.counts_per_turn;
    let speed = counts.windows(2).map(|w| f64::from(w[1] - w[0]) * unit * 1e3);
    let min = speed.clone().fold(0.0, f64::min);
    let max = speed.fold(0.0, f64::max);
    let depth = counts.iter().max().copied().unwrap() as f64 * unit;
    println!("{part} {end}: {fault:?}, depth {depth:.4}, {min:.1} to {max:.1} rad/s");
    for c in counts.iter().skip((end * 1e3) as usize - 2).take(14) {
        print!("{:.4} ", f64::from(*c) * unit);
    }
    println!();
}

#[test]
fn explore() {
    for (part, end) in [(0.95, 0.4), (0.99, 0.4), (1.1, 0.255), (1.1, 0.265), (1.1, 0.27)] {
        run(part, end);
    }
}
