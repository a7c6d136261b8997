//! A hand that pushes fast into the wall and gives way, with a supply that takes no energy back.

use haptic_servo::current::{Bus, ReturnedEnergy};
use haptic_servo::fault::Fault;
use virtual_board::device::Device;
use virtual_board::power_stage::Supply;

use super::bench::{armed, boot, circuit};
use super::bridge_wall::{CURRENT_LOOP, SCENE, TRANSDUCERS};
use super::paddle::{Driven, Shaft};
use crate::bench::Bench;

/// When the hand takes the device back from the wall, and when it pushes, in s since the motor was switched on:
/// the clamp has opened.
const BACK: f64 = 0.03;
const BEGIN: f64 = 0.13;
/// Speeds in rad/s on the way back and in the push, near the largest.
const SLOW: f64 = -0.7;
const SPEED: f64 = 24.0;
/// Accelerations in rad/s^2 at the beginning and the end of the push.
const BEGINS: f64 = 5e3;
const ENDS: f64 = 2.5e4;
/// Milliseconds from switching on to the end: the push, and some time behind it.
const TICKS: u64 = 170;

/// The device of the program, led into the wall to a depth in rad, and slowly out of it: the push has its
/// full speed in front of the wall, and none at the depth.
fn pushed_to(depth: f64) -> impl Device + Send + 'static {
    let mut is_in = false;
    Driven::new(TRANSDUCERS.counts_per_turn, move |shaft: &mut Shaft, _, seconds| {
        let left = (depth - shaft.angle).max(0.0);
        let mut led = |time: f64| {
            is_in |= left < 1e-4;
            match time {
                _ if is_in => SLOW,
                ..BACK => 0.0,
                ..BEGIN => SLOW,
                _ => SPEED.min((time - BEGIN) * BEGINS).min((2.0 * ENDS * left).sqrt()),
            }
        };
        shaft.speed = shaft.time.map_or(0.0, |time| led(time + seconds));
        shaft.angle += shaft.speed * seconds;
    })
}

/// Depth of the push over that at which the wall at rest has its torque limit: what copper takes, and equation
/// 62 leaves out, allows some more than that.
const DEEPER: f64 = 1.3;

/// The highest voltage of a supply, and the fault, in a push.
fn pushed(supply: Supply) -> (f64, Option<&'static str>) {
    // Of equation 62, the pushed energy is the torque limit over the depth.
    let limit = SCENE.torque_limit.expect("the scene has a limit");
    let mut bench: Bench = boot(pushed_to(DEEPER * energy().pushed / limit));
    circuit(&mut bench).supply = supply;
    armed(&mut bench);
    let mut highest: f64 = 0.0;
    for _ in 0..TICKS {
        bench.run(1);
        highest = highest.max(circuit(&mut bench).supply.volts);
    }
    let fault = bench.fault().map(Fault::as_str);
    println!("{supply:?}: {highest:.3} V, {fault:?}");
    (highest, fault)
}

/// The program's supply.
fn bus() -> Bus {
    *CURRENT_LOOP.bus().expect("its supply takes nothing back")
}

fn energy() -> ReturnedEnergy {
    let push = CURRENT_LOOP.push(&SCENE, &TRANSDUCERS, None);
    bus().check(&SCENE, &push).expect("the program compiles")
}

/// With the capacitance that the compiler asks for, which is less than the program's: the voltage rises by what
/// the push returns, by no more than equation 62, and not to the fault.
#[test]
fn the_wall_stays_with_a_supply_that_the_compiler_accepts() {
    let (bus, energy) = (bus(), energy().total());
    let capacitance = bus.least_capacitance(energy).expect("some is enough");
    assert!(capacitance < bus.capacitance);
    let (highest, fault) = pushed(Supply::that_stores(bus.voltage, capacitance));
    let returned = 0.5 * capacitance * (highest * highest - bus.voltage * bus.voltage);
    println!("{returned:.4} J of at most {energy:.4} J");
    assert_eq!(fault, None);
    assert!(highest < bus.fault_level, "{highest} V");
    assert!(returned > 0.25 * energy && returned < energy, "{returned} J of {energy} J");
}

/// With 24 V and 0.2 mF the wall vanishes under the hand; the compiler refuses that.
#[test]
fn the_wall_vanishes_with_a_supply_that_the_compiler_refuses() {
    let small = Bus { capacitance: 2e-4, ..bus() };
    let push = CURRENT_LOOP.push(&SCENE, &TRANSDUCERS, None);
    assert!(small.check(&SCENE, &push).is_err());
    let (highest, fault) = pushed(Supply::that_stores(small.voltage, small.capacitance));
    assert_eq!(fault, Some("over-voltage"));
    assert!(highest > small.fault_level, "{highest} V");
}
