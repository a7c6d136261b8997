//! A hand that pushes into the wall and lets go, with a supply that takes no energy back.

use std::f64::consts::TAU;

use haptic_servo::current::{Bus, ReturnedEnergy};
use haptic_servo::scene::Device as Mechanics;
use haptic_servo::wire::message::FaultCode;
use virtual_board::device::{Device, Motion};
use virtual_board::power_stage::Supply;

use super::bench::{armed, boot, circuit};
use super::bridge_wall::{CURRENT_LOOP, SCENE, TRANSDUCERS};
use crate::bench::Bench;

/// When the push begins, in s since the motor was switched on: the clamp has opened.
const BEGIN: f64 = 0.13;
/// Speed of the push in rad/s, near the largest.
const SPEED: f64 = 24.0;
/// Milliseconds from switching on to the end: the push, and the device at rest behind it.
const TICKS: u64 = 170;

/// The device of the program, led into the wall and let go at a depth.
struct Pushed {
    depth: f64,
    angle: f64,
    speed: f64,
    count: i32,
    /// Seconds since the motor was first switched on.
    time: Option<f64>,
    is_held: bool,
}

impl Pushed {
    fn to(depth: f64) -> Self {
        let angle = 0.5 * TAU / TRANSDUCERS.counts_per_turn;
        Self { depth, angle, speed: 0.0, count: 0, time: None, is_held: true }
    }
}

impl Device for Pushed {
    fn sample(&mut self, _: Option<u16>, is_on: bool) -> i32 {
        if is_on {
            self.time.get_or_insert(0.0);
        }
        0
    }

    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        self.time = self.time.map(|time| time + seconds);
        let Mechanics { inertia, damping, .. } = SCENE.device;
        self.is_held &= self.angle < self.depth;
        self.speed = match self.is_held {
            true if self.time.is_some_and(|time| time >= BEGIN) => SPEED,
            true => 0.0,
            false => (inertia * self.speed + torque * seconds) / (inertia + damping * seconds),
        };
        self.angle += self.speed * seconds;
        let count = (self.angle * TRANSDUCERS.counts_per_turn / TAU).floor() as i32;
        let counts = count - std::mem::replace(&mut self.count, count);
        Motion { counts, angle: self.angle, speed: self.speed }
    }
}

/// The highest voltage of a supply, and the fault, in a push to the depth at which the wall at rest has its
/// torque limit.
fn pushed(supply: Supply) -> (f64, Option<&'static str>) {
    // Of equation 62, what is pushed is the torque limit over the depth.
    let limit = SCENE.torque_limit.expect("the scene has a limit");
    let mut bench: Bench = boot(Pushed::to(energy().pushed / limit));
    circuit(&mut bench).supply = supply;
    armed(&mut bench);
    let mut highest: f64 = 0.0;
    for _ in 0..TICKS {
        bench.run(1);
        highest = highest.max(circuit(&mut bench).supply.volts);
    }
    let fault = bench.status().fault.and_then(FaultCode::fault).map(|fault| fault.as_str());
    println!("{supply:?}: {highest:.3} V, {fault:?}");
    (highest, fault)
}

/// The program's supply.
fn bus() -> Bus {
    *CURRENT_LOOP.bus().expect("its supply takes nothing back")
}

fn energy() -> ReturnedEnergy {
    let push = CURRENT_LOOP.push(&SCENE.as_data(), &TRANSDUCERS, None);
    bus().check(&SCENE.as_data(), &push).expect("the program compiles")
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
    assert!(returned > 0.2 * energy && returned < energy, "{returned} J of {energy} J");
}

/// With 24 V and 1 mF the wall vanishes under the hand; the compiler refuses that.
#[test]
fn the_wall_vanishes_with_a_supply_that_the_compiler_refuses() {
    let small = Bus { capacitance: 1e-3, ..bus() };
    let push = CURRENT_LOOP.push(&SCENE.as_data(), &TRANSDUCERS, None);
    assert!(small.check(&SCENE.as_data(), &push).is_err());
    let (highest, fault) = pushed(Supply::that_stores(small.voltage, small.capacitance));
    assert_eq!(fault, Some("over-voltage"));
    assert!(highest > small.fault_level, "{highest} V");
}
