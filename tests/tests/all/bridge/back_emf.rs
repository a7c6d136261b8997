//! What the back-EMF takes of a device's passivity, in a closed loop with the controller: it drives a current,
//! against which the feedback works.

#[path = "../../../../firmware/src/bin/bridge_paddle/mod.rs"]
mod bridge_paddle;

use super::rig::{Machine, Rig};
use super::*;

/// A paddle on the motor of `bridge_wall`, whose short circuit damps it by six times its own damping.
const STRONG: Machine = Machine {
    drive: Drive { motor: bridge_paddle::DRIVE.motor, ..MACHINE.drive },
    transducers: Transducers { full_scale_torque: 1.0, ..MACHINE.transducers },
    ..MACHINE
};

/// By how much the swings of a spring are more or less after a while; `None` where the current no longer follows.
fn growth(certified: &Certified<Scene>, stiffness: f64, hand: &HandImpedance) -> Option<f64> {
    let codes = servos::rounded(&STRONG, servos::exact(&STRONG, certified));
    let exact = servos::exact(&STRONG, certified);
    let mut rig = Rig::new(&STRONG, hand, codes, exact);
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
