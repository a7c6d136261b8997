//! A hand that pushes into a wall to the torque limit and lets go at once: the motor throws the bare device.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

use haptic_servo::scene::Device as Mechanics;
use haptic_servo::servo_loop::State;
use virtual_board::device::Device;
use virtual_board::power_stage::Supply;

use super::bench::{armed, boot, circuit};
use super::bridge_wall::{CURRENT_LOOP, SCENE, TRANSDUCERS};
use super::brushless::{aligned, wired};
use super::brushless_wall;
use super::paddle::{Driven, Shaft, paddle};
use crate::bench::Bench;

/// A supply in V that takes energy back.
const VOLTS: f64 = 24.0;
/// Milliseconds from the end of a push until the device is at rest.
const AFTER: u64 = 40;

/// Speed of the hand in rad/s, near the largest, its acceleration in rad/s^2 where it turns round, and the speed at
/// which it then lets go.
const SPEED: f64 = 24.0;
const TURNS: f64 = 2.5e4;
const LETS_GO: f64 = -20.0;
/// Depth in rad, beyond that of the torque limit.
const DEPTH: f64 = 0.06;
/// The times in s, since the motor was switched on, at which the hand takes the device back and pushes: the clamp is
/// open.
const BACK: f64 = 0.03;
const BEGIN: f64 = 0.13;

/// The device of the program: a hand leads it into the wall at full speed, snatches it back, and lets go.
/// Keeps the largest speed of the free device in rad/s.
fn snatched(thrown: Arc<Mutex<f64>>) -> impl Device + Send + 'static {
    let (mut turned, mut is_free) = (None, false);
    let mut led = move |angle: f64, time: f64| {
        if angle > DEPTH {
            turned.get_or_insert(time);
        }
        let speed = match time {
            ..BACK => 0.0,
            ..BEGIN => -0.7,
            _ => SPEED.min((time - BEGIN) * 5e3) - turned.map_or(0.0, |at| (time - at) * TURNS),
        };
        (speed, turned.is_some() && speed < LETS_GO)
    };
    Driven::new(TRANSDUCERS.counts_per_turn, move |shaft: &mut Shaft, torque, seconds| {
        if is_free {
            let Mechanics { inertia, damping, .. } = SCENE.device;
            shaft.speed =
                (inertia * shaft.speed + torque * seconds) / (inertia + damping * seconds);
            let mut thrown = thrown.lock().unwrap();
            *thrown = thrown.max(shaft.speed.abs());
        } else if let Some(time) = shaft.time {
            (shaft.speed, is_free) = led(shaft.angle, time + seconds);
        }
        shaft.angle += shaft.speed * seconds;
    })
}

fn check_runs(bench: &mut Bench) {
    let (told, state) = (bench.fault(), bench.status().state);
    assert!(told.is_none() && state == State::Running, "{told:?}, {state:?}");
}

/// The back-EMF changes by most of twice the largest speed within 2 ms.
#[test]
fn a_handle_that_is_snatched_out_of_the_wall_is_no_fault() {
    let thrown = Arc::<Mutex<f64>>::default();
    let mut bench = boot(snatched(thrown.clone()));
    circuit(&mut bench).supply = Supply::stiff(VOLTS);
    armed(&mut bench);
    bench.run(140 + AFTER);
    let thrown = *thrown.lock().unwrap();
    println!("let go at {thrown:.1} rad/s");
    check_runs(&mut bench);
    assert!(thrown > 0.7 * SPEED, "{thrown} rad/s");
}

/// From rest at the limit, and from deeper in the wall, where the torque lasts longer.
#[test]
fn a_hand_that_lets_go_at_the_torque_limit_is_no_fault() {
    let limit = SCENE.torque_limit.expect("the scene has a limit");
    for (part, end) in [(0.99, 0.3), (1.2, 0.26)] {
        let hand = move |time: f64| {
            let grown = ((time - 0.15) / 0.1).clamp(0.0, 1.0);
            if time < end { part * limit * grown } else { 0.0 }
        };
        let mut bench = boot(paddle(hand, 0.0));
        circuit(&mut bench).supply = Supply::stiff(VOLTS);
        let armed = armed(&mut bench);
        bench.run((end * 1e3) as u64 - 1);
        let pushed = circuit(&mut bench).mean_torque();
        bench.run(AFTER);
        let counts: Vec<_> = bench.pins().samples[armed..].iter().map(|it| it.count).collect();
        let back = counts.windows(2).map(|pair| pair[0] - pair[1]).max().unwrap();
        let most = TRANSDUCERS.largest_speed * TRANSDUCERS.counts_per_turn / TAU * 1e-3;
        println!("{part}: {pushed:.3} N m, then up to {back} counts in a ms, of {most:.0}");
        check_runs(&mut bench);
        assert!(pushed < -0.95 * limit && f64::from(back) > 0.4 * most, "{pushed}, {back}");
    }
}

#[test]
fn a_hand_that_lets_go_of_a_brushless_motor_at_the_torque_limit_is_no_fault() {
    let limit = brushless_wall::SCENE.torque_limit.expect("the scene has a limit");
    let (mut held, fault) = aligned(wired([1, 0, 2], 0.7), |circuit| {
        circuit.supply = Supply::stiff(VOLTS);
    });
    assert_eq!(fault, None);
    held.bench.arm();
    held.bench.run(2000);
    // A little more than the limit and the friction, for 20 ms.
    held.push(1.03 * limit);
    held.bench.run(200);
    let pushed = circuit(&mut held.bench).mean_torque();
    held.push(0.0);
    held.bench.run(1000);
    check_runs(&mut held.bench);
    assert!(pushed < -0.8 * limit, "{pushed} N m");
}

/// The compiler's bound for a motor and its device.
#[test]
fn the_paddle_is_within_the_bound_of_its_current_loop() {
    let Mechanics { inertia, damping, .. } = SCENE.device;
    let torque = 1.25 * TRANSDUCERS.full_scale_torque + damping * TRANSDUCERS.largest_speed;
    let (most, bound) = (torque / inertia, CURRENT_LOOP.largest_acceleration());
    println!("{most:.0} rad/s^2 of {bound:.0}");
    assert!(most < bound && bound < 1.5 * most, "{most} of {bound}");
}
