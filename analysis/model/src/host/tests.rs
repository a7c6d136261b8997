//! Each law beside a certified wall, in a hand that pushes and lets go, with a tank and without.

use std::f64::consts::TAU;

use haptic_servo::host::ServoNumbers;
use haptic_servo::scene::{EncoderReading, Latency, Scene, TimeRange};
use haptic_servo::servo::OutputTiming;

use super::*;
use crate::controller::controller;
use crate::device::HandSetpoint;
use crate::file::SceneFile;
use crate::fixture::file_on_paddle;
use crate::hand::HandTrajectory;
use crate::simulation::device_in_hand::DeviceInHand;

fn file() -> SceneFile {
    file_on_paddle(
        "[coupling]\nstiffness = 44.0\n[environment]\ntype = \"damper-wall\"\nstiffness = 10.0\ndamping = 0.002\n\
         delay = 1\n[host]\nenergy = 0.05\npower = 0.1\ndamping = 0.004\ntorque = 0.5\ntimeout = 0.05\n[limits]\ntorque = 1.0\n",
    )
}

/// The most that the hand has taken, over the budget at that time.
fn most_taken(file: &SceneFile, law: HostLaw, output: OutputTiming, has_tank: bool) -> f64 {
    let (scene, host) = (&file.scene, file.host.unwrap());
    let transducers = file.transducers(None, None);
    let budget = if has_tank { host } else { unlimited(&host, scene.timing.period) };
    // Beside any servo the tank holds; this one is certified without a lag only.
    let prompt = Scene { latency: Latency::NONE, ..*scene }.certify().unwrap();
    let servo = controller::<_, f32>(&prompt, &transducers).unwrap();
    let numbers = ServoNumbers {
        latency: &scene.latency,
        timing: scene.timing,
        torque_limit: scene.torque_limit,
        // With a lag it is not known here.
        margin: Some(0.005),
        full_scale: transducers.full_scale_torque,
        fade: 0.1,
        output,
        radians_per_count: TAU / transducers.counts_per_turn,
        stores: false,
    };
    let hosted = HostedServo::beside(servo, &budget, &numbers).unwrap();
    let law = HostileHost::new(law, host.torque);
    let mut hosted = hosted.driven_by(HostSender::new(law, scene.timing.period, &transducers, 0));
    let hand = HandTrajectory::push_and_let_go();
    let mut device = DeviceInHand::new(scene, hand.hand, &transducers).unwrap();
    let period = scene.timing.period;
    let ticks = usize::from(output == OutputTiming::Latched);
    let mut energy = HostEnergy::new(&host, &scene.latency, period, ticks);
    let mut most = 0.0_f64;
    for tick in 0..5000 {
        let time = f64::from(tick) * period;
        let before = device.motion().position;
        let count = device.count();
        let code = crate::controller::Controller::tick(&mut hosted, count).code;
        let HandSetpoint { from, to } = hand.setpoint(time, time + period);
        let torque = device.torque(code);
        device.push(torque, HandSetpoint { from, to }, time < hand.release);
        let taken = energy.tick(hosted.last().given, device.motion().position - before);
        most = most.max(taken / (host.energy + host.power * (time + period)));
    }
    most
}

#[test]
fn a_hand_takes_no_more_than_the_budget_and_without_a_tank_it_does() {
    let mut above = 0;
    for law in HostLaw::ALL {
        for output in [OutputTiming::Simultaneous, OutputTiming::Latched] {
            let with = most_taken(&file(), law, output, true);
            let without = most_taken(&file(), law, output, false);
            println!("{law} {output:?}: {with} {without}");
            assert!(with <= 1.0, "{law} {output:?}: {with}");
            above += u32::from(without > 1.0);
        }
    }
    assert!(above >= 2, "{above}");
}

#[test]
fn an_amplifier_that_lags_and_an_output_that_is_late_do_not_change_that() {
    let late = |delay, lag| Latency::delayed(delay).with_actuator_lag(lag);
    const OLD: EncoderReading =
        EncoderReading { age: TimeRange::exactly(6e-5), ..*EncoderReading::ideal() };
    for (latency, output) in [
        (late(0.0, 4e-4), OutputTiming::Latched),
        (late(0.0, 4e-4), OutputTiming::Simultaneous),
        (late(3e-4, 0.0), OutputTiming::Simultaneous),
        (late(3e-4, 2e-4), OutputTiming::Simultaneous),
        // A board's own bridge.
        (Latency::sampled(4, 2e-4, 1e-3), OutputTiming::Latched),
        (Latency::sampled(4, 2e-4, 1e-3).read_by(&OLD), OutputTiming::Latched),
    ] {
        let mut file = file();
        file.scene.latency = latency;
        let most = most_taken(&file, HostLaw::Pump, output, true);
        println!("{latency:?}: {most}");
        assert!((0.1..=1.0).contains(&most), "{latency:?}: {most}");
    }
}

#[test]
fn each_law_sends_what_it_says() {
    let at = |position: f64, velocity: f64, time: f64| Reading { position, velocity, time };
    let mut pump = HostileHost::new(HostLaw::Pump, 0.5);
    assert_eq!([-1.0, 1.0].map(|speed| pump.torque(&at(0.0, speed, 0.0))), [-0.5, 0.5]);
    let mut spring = HostileHost::new(HostLaw::LateSpring, 0.5);
    assert_eq!([0.01, 0.02].map(|x| spring.torque(&at(x, 0.0, 0.0))), [0.0, -0.5]);
    let mut square = HostileHost::new(HostLaw::Square, 0.5);
    assert_eq!([0.0, 0.03, 0.05].map(|t| square.torque(&at(0.0, 0.0, t))), [0.5, -0.5, 0.5]);
    let mut noise = HostileHost::new(HostLaw::Noise, 0.5);
    let sent: Vec<_> =
        (0..10_000).map(|k| noise.torque(&at(0.0, 0.0, f64::from(k) * 1e-3))).collect();
    let mean = sent.iter().sum::<f64>() / 1e4;
    let square = sent.iter().map(|x| x * x).sum::<f64>() / 1e4;
    // Of a uniform distribution: a third of the square, to six deviations of a mean of ten thousand.
    assert!(mean.abs() < 0.018 && (square - 0.25 / 3.0).abs() < 0.005, "{mean} {square}");
    assert!("pumps".parse::<HostLaw>().unwrap_err().contains("pump, noise, late-spring, square"));
}
