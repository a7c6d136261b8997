//! What the back-EMF takes of a device's damping, or adds to it, beside what is fed forward.
//!
//! The back-EMF is fed forward by a mean speed, which is late. What it leaves drives a current, against which
//! the feedback works: a moving motor has a torque beside that of its codes, and where that is in phase with the
//! speed it takes damping.

use std::f64::consts::TAU;

use firmware::current::Motor;
use nalgebra::Complex;

use super::rig::{Machine, Rig};
use super::*;

type C = Complex<f64>;

/// Part of the newest speed in the mean.
const NEWEST: f64 = 1.0 / 32.0;

/// Torque in N m against a speed of 1 rad/s at an angular frequency, of codes that are no torque: winding,
/// feedback and feed-forward of theory, section 15, and what a sine of the speed is between two instants.
fn impedance(machine: &Machine, omega: f64) -> C {
    let Motor { resistance, inductance, torque_constant, .. } = machine.drive.motor;
    let response = machine.current_loop().response();
    let z = C::from_polar(1.0, omega * response.delay);
    let a = (-resistance * response.delay / inductance).exp();
    let b = (1.0 - a) / resistance;
    let gain = (1.0 - (-response.delay / response.lag).exp()).min(0.25);
    let feedback = gain / b * (z - a) / (z - 1.0);
    let moved = (z - 1.0) / C::new(0.0, omega * response.delay);
    let fed_forward = moved / z * NEWEST / (1.0 - (1.0 - NEWEST) / z);
    let current = b * torque_constant * (fed_forward / z - moved) / (z - a + b * feedback / z);
    -torque_constant * current
}

/// The damping in N m s/rad of a device on a spring that swings at a frequency in Hz, of which so much is the
/// device's own, by how its swings die away.
fn damping_of_swings(machine: &Machine, frequency: f64) -> f64 {
    let inertia = 4e-3;
    let all = inertia + machine.device.inertia;
    let stiffness = all * (TAU * frequency).powi(2);
    let hand = HandImpedance { inertia, stiffness, ..HandImpedance::default() };
    let mut rig = Rig::bridge(machine, &hand, Box::new(|_| 0), Box::new(|_| 0.0));
    rig.push(10.0);
    // Until the mean speed is that of the swings.
    rig.run(0.04).unwrap();
    let first = rig.energy(all, stiffness);
    let time = (10.0 / frequency / PERIOD).round() * PERIOD;
    rig.run(time).unwrap();
    (first / rig.energy(all, stiffness)).ln() / time * all
}

/// A paddle on the motor of `bridge_wall`, whose short circuit damps it by six times its own damping.
const STRONG: Machine = Machine {
    drive: Drive { motor: bridge_wall::DRIVE.motor, ..MACHINE.drive },
    transducers: Transducers { full_scale_torque: 1.0, ..MACHINE.transducers },
    ..MACHINE
};

/// The most damping in N m s/rad that is taken at any frequency, by the formula.
fn taken(machine: &Machine) -> f64 {
    let frequencies = (1..2000).map(|step| 10.0 * f64::from(step));
    -frequencies.map(|f| impedance(machine, TAU * f).re).fold(0.0, f64::min)
}

/// By how much the swings of a spring are more or less after a while; `None` where the current no longer follows.
fn growth(certified: &Certified<Scene>, stiffness: f64, hand: &HandImpedance) -> Option<f64> {
    let codes = servos::rounded(&STRONG, servos::exact(&STRONG, certified));
    let exact = servos::exact(&STRONG, certified);
    let mut rig = Rig::bridge(&STRONG, hand, codes, exact);
    rig.push(6.0 * PUSH * (stiffness / held_inertia(hand)).sqrt());
    let first = swing(&rig.run(0.02).ok()?);
    Some(swing(last(&rig.run(SETTLES).ok()?)) / first)
}

/// The passivity that the device has beside its motor is what a certificate has to count on.
#[test]
fn a_strong_motor_is_certified_with_what_it_takes_off_the_passivity_and_not_without() {
    let latency = latency(&STRONG.current_loop());
    let all = spring(1.0, Coupling::Rigid, latency);
    let passivity = Some(DEVICE.damping - taken(&STRONG));
    let less = Scene { device: Device { passivity, ..DEVICE }, ..all };
    for (scene, holds) in [(less, true), (all, false)] {
        let stiffness = 0.99 * limit_of(&scene);
        let environment = Environment::DelayedSpring(Wall::spring(stiffness, 1));
        let certified = Scene { environment, ..scene }.certify().unwrap();
        for inertia in [2e-5, 4e-5, 8e-5] {
            let hand = HandImpedance { inertia, ..HandImpedance::default() };
            let grown = growth(&certified, stiffness, &hand);
            println!("{stiffness} N m/rad, {inertia} kg m^2: {grown:?}");
            assert_eq!(grown.is_some_and(|grown| grown < 0.5), holds, "{stiffness} {grown:?}");
        }
    }
}

#[test]
fn a_back_emf_that_is_fed_forward_late_takes_the_damping_of_its_formula() {
    for frequency in [80.0, 130.0, 190.0, 250.0] {
        let added = damping_of_swings(&STRONG, frequency) - DEVICE.damping;
        let expected = impedance(&STRONG, TAU * frequency).re;
        println!("{frequency} Hz: {added} N m s/rad, by the formula {expected} N m s/rad");
        assert!((added - expected).abs() < 0.05 * expected.abs() + 2e-4, "{added} {expected}");
    }
    for (machine, most) in [(STRONG, 0.0058), (MACHINE, 3e-5)] {
        let taken = taken(&machine);
        println!("at most {taken} N m s/rad are taken");
        assert!(taken < most && taken > 0.5 * most, "{taken}");
    }
}
