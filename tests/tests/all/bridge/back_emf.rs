//! What the back-EMF adds to a device's damping, and what it takes.
//!
//! It drives a current, against which the feedback works: a moving motor has a torque beside that of its codes.
//! It adds damping at the frequencies of hands, and what it takes at those of the modulation is the loop's
//! `motion_loss`.

use std::f64::consts::TAU;

use haptic_servo::current::Motor;
use nalgebra::Complex;

use super::rig::{Machine, Rig};
use super::*;

type C = Complex<f64>;

/// Torque in N m against a speed of 1 rad/s at an angular frequency, of codes that are no torque: winding and
/// feedback of theory, section 15, and what a sine of the speed is between two instants.
fn impedance(machine: &Machine, omega: f64) -> C {
    let Motor { resistance, inductance, torque_constant, .. } = machine.drive.motor;
    let response = machine.current_loop().response();
    let z = C::from_polar(1.0, omega * response.delay);
    let a = (-resistance * response.delay / inductance).exp();
    let b = (1.0 - a) / resistance;
    let gain = (1.0 - (-response.delay / response.lag).exp()).min(0.25);
    let feedback = gain / b * (z - a) / (z - 1.0);
    let moved = (z - 1.0) / C::new(0.0, omega * response.delay);
    let current = -b * torque_constant * moved / (z - a + b * feedback / z);
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

/// A spring at 99 % of its limit, certified with the passivity that a program may declare.
#[test]
fn a_strong_motor_renders_what_is_certified_with_what_motion_leaves() {
    let latency = latency(&STRONG.current_loop());
    let passivity = Some(DEVICE.damping - STRONG.current_loop().motion_loss());
    let scene =
        Scene { device: Device { passivity, ..DEVICE }, ..spring(1.0, Coupling::Rigid, latency) };
    let stiffness = 0.99 * limit_of(&scene);
    let environment = Wall::spring(stiffness, 1).alone();
    let certified = Scene { environment, ..scene }.certify().unwrap();
    for inertia in [2e-5, 4e-5, 8e-5] {
        let hand = HandImpedance { inertia, ..HandImpedance::default() };
        let grown = growth(&certified, stiffness, &hand);
        println!("{stiffness} N m/rad, {inertia} kg m^2: {grown:?}");
        assert!(grown.is_some_and(|grown| grown < 0.5), "{stiffness} {grown:?}");
    }
}

#[test]
fn a_motor_that_moves_has_the_damping_of_its_formula() {
    for frequency in [80.0, 130.0, 190.0, 250.0] {
        let added = damping_of_swings(&STRONG, frequency) - DEVICE.damping;
        let expected = impedance(&STRONG, TAU * frequency).re;
        println!("{frequency} Hz: {added} N m s/rad, by the formula {expected} N m s/rad");
        assert!(expected > 0.0 && (added - expected).abs() < 0.05 * expected + 2e-4, "{added}");
    }
    for machine in [STRONG, MACHINE] {
        let (taken, bound) = (taken(&machine), machine.current_loop().motion_loss());
        println!("at most {taken} N m s/rad are taken, by the bound {bound}");
        assert!(taken < bound, "{taken} {bound}");
    }
}
