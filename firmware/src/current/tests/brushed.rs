//! A brushed motor, and the model, the feed-forward and the feedback of its current without counts; and the limit of
//! the torque by the heat of the current.

use super::super::controller::Follower;
use super::rig::Rig;
use super::*;
use crate::test_scene::Random;

/// Largest deviation from the certified current in A over instants.
fn deviation(rig: &mut Rig, steps: &[(usize, i16)], instants: std::ops::Range<usize>) -> f64 {
    let mut most = 0.0_f64;
    for instant in 0..instants.end {
        let current = rig.instant(code_at(steps, instant)).unwrap();
        if instants.contains(&instant) {
            most = most.max((current - certified_current(&BRUSHED, steps, instant)).abs());
        }
    }
    most
}

#[test]
fn the_current_is_the_certified_one_at_every_instant() {
    let off = deviation(&mut Rig::started(&BRUSHED), &STEPS, 0..600);
    assert!(off < allowed(&BRUSHED), "{off}");
    assert!(off > 0.1 * allowed(&BRUSHED), "{off}");
}

#[test]
fn a_motor_that_is_off_by_a_third_settles_and_stays_near() {
    for (resistance, inductance) in [(1.4, 1.0), (1.0, 0.7), (1.0, 1.3), (1.4, 0.7), (1.4, 1.3)] {
        let mut rig = Rig::started(&BRUSHED);
        rig.motor.resistance *= resistance;
        rig.motor.inductance *= inductance;
        let steps = [(3, FULL_SCALE), (100, -FULL_SCALE)];
        let transient = deviation(&mut rig, &steps, 0..200);
        assert!(transient < 0.3 * 8.0, "{resistance}, {inductance}: {transient}");
        for _ in 0..200 {
            rig.instant(-FULL_SCALE).unwrap();
        }
        let settled = (rig.current + 4.0).abs();
        assert!(settled < allowed(&BRUSHED), "{resistance}, {inductance}: {settled}");
    }
}

#[test]
fn the_back_emf_of_an_acceleration_leaves_what_the_formula_says() {
    // `Ke dv/dt` over the gain `K R/h` of the integral.
    let feedback = -(-std::f64::consts::TAU * DRIVE.bandwidth * INSTANT).exp_m1();
    let gain = feedback * DRIVE.motor.resistance / INSTANT;
    for acceleration in [10_000.0, -10_000.0] {
        let mut rig = Rig::started(&BRUSHED);
        let off = -DRIVE.motor.back_emf() * acceleration / gain;
        let mut most = 0.0_f64;
        for instant in 0..400 {
            rig.speed = acceleration * f64::from(instant) * INSTANT;
            let current = rig.instant(0).unwrap();
            assert!(current.abs() < off.abs() + allowed(&BRUSHED), "{instant}: {current}, {off}");
            most = most.max(if instant > 200 { (current - off).abs() } else { 0.0 });
        }
        assert!(most < allowed(&BRUSHED), "{most} around {off}");
    }
}

#[test]
fn a_speed_that_comes_at_once_is_fed_back() {
    let mut rig = Rig::started(&BRUSHED);
    rig.speed = 60.0;
    let step = deviation(&mut rig, &[(0, 900)], 0..400);
    // The voltage over the resistance, times `(1 - a)/K`.
    let decay = -(-DRIVE.motor.resistance * INSTANT / DRIVE.motor.inductance).exp_m1();
    let feedback = -(-std::f64::consts::TAU * DRIVE.bandwidth * INSTANT).exp_m1();
    let bound = 60.0 * DRIVE.motor.back_emf() / DRIVE.motor.resistance * decay / feedback;
    assert!(step > 0.5 * bound && step < bound, "{step} of {bound}");
    let steady = (0..400).map(|_| (rig.instant(900).unwrap() - 900.0 / 1791.0 * 4.0).abs());
    assert!(steady.fold(0.0, f64::max) < allowed(&BRUSHED));
}

/// Largest deviation in A from the model, of a torque that swings slowly through zero, for a loop that is designed
/// for this dead time. The stage has 0.5 microseconds of it.
fn deviation_at_zero_crossings(dead_time: f64) -> (f64, CurrentLoop) {
    let stage = PowerStage { dead_time, ..STAGE };
    let design = CurrentLoop::checked(&DRIVE, &stage, &TRANSDUCERS, PERIOD);
    let mut rig = Rig::off(&design);
    rig.stage.dead_time = 0.5e-6;
    rig = rig.restarted();
    let gain = -(-INSTANT / design.response().lag).exp_m1();
    let (mut model, mut next, mut most) = (0.0, 0.0, 0.0_f64);
    for instant in 0..4000 {
        let code = (150.0 * (f64::from(instant) * 0.01).sin()) as i16;
        most = most.max((rig.instant(code).unwrap() - model).abs());
        let amps = f64::from(code) / 1791.0 * design.full_scale_current();
        (model, next) = (next, next + gain * (amps - next));
    }
    (most, design)
}

#[test]
fn the_dead_time_is_given_back_where_the_current_changes_its_sign() {
    let (compensated, design) = deviation_at_zero_crossings(0.5e-6);
    let (plain, _) = deviation_at_zero_crossings(0.0);
    println!("{compensated} A, and {plain} A without");
    let crossing = design.resolution().zero_crossing / design.torque_per_amp();
    assert!(compensated < allowed(&design) + crossing, "{compensated}: {crossing}");
    assert!(plain > 3.0 * compensated, "{plain}, {compensated}");
}

#[test]
fn another_supply_does_not_show() {
    for bus in [22.1, 25.9] {
        let mut rig = Rig::started(&BRUSHED);
        rig.bus = bus;
        let off = deviation(&mut rig, &STEPS, 0..600);
        assert!(off < allowed(&BRUSHED), "{bus}: {off}");
    }
    // Falls by an eighth while the current is there.
    let mut rig = Rig::started(&BRUSHED);
    for _ in 0..100 {
        rig.instant(1000).unwrap();
    }
    rig.bus = 22.1;
    for _ in 0..100 {
        let off = (rig.instant(1000).unwrap() - 1000.0 / 1791.0 * 4.0).abs();
        assert!(off < allowed(&BRUSHED) + 0.05, "{off}");
    }
}

#[test]
fn a_voltage_that_is_not_enough_leaves_nothing_behind() {
    // Speed and torque take all the voltage, for less time than is a fault, and then a part of it.
    let mut rig = Rig::started(&BRUSHED);
    rig.speed = 340.0;
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for instant in 0..500 {
        let code = if (300..345).contains(&instant) { FULL_SCALE } else { 500 };
        rig.bus = if (300..345).contains(&instant) { 22.1 } else { 25.0 };
        let current = rig.instant(code).unwrap();
        if instant > 250 {
            (least, most) = (least.min(current), most.max(current));
        }
    }
    // A supply that jumps shows for two instants.
    assert!((0.93..1.12).contains(&least), "{least}");
    // The difference of the compare values less the dead time, less 17 V, through 0.6 ohm.
    let volts = 22.1 * (2125.0 - 290.0 - 34.0) / 2125.0 - 17.0;
    assert!((most - volts / 0.6).abs() < 0.1, "{most}");
    // The integral has not gone on in the meantime: it would have taken the current further down.
    assert!((rig.current - 500.0 / 1791.0 * 4.0).abs() < allowed(&BRUSHED), "{}", rig.current);
}

#[test]
fn a_settled_current_stays_within_its_resolution() {
    let (mut random, mut most) = (Random(1), 0.0_f64);
    for _ in 0..60 {
        let mut rig = Rig::started(&BRUSHED);
        rig.offsets = [2550.0, 2541.0].map(|middle| middle + 0.5 * random.next());
        rig = rig.restarted();
        let code = (random.next() * 1791.0) as i16;
        for instant in 0..700 {
            let current = rig.instant(code).unwrap();
            if instant > 300 {
                most = most.max((current - f64::from(code) / 1791.0 * 4.0).abs());
            }
        }
    }
    let bound = BRUSHED.resolution().deviation / BRUSHED.torque_per_amp();
    assert!(most < bound && most > 0.3 * bound, "{most} of {bound}");
}

#[test]
fn the_ripple_is_that_of_the_formula() {
    // Half of the supply.
    let code = (13.0 / 0.6 / 4.0 / 3.0 * 1791.0) as i16;
    let mut rig = Rig::started(&BRUSHED);
    rig.bus = 26.0;
    rig.speed = 130.0;
    for _ in 0..300 {
        rig.instant(code.min(FULL_SCALE)).unwrap();
    }
    let ripple = rig.extremes.1 - rig.extremes.0;
    let bound = BRUSHED.resolution().ripple / BRUSHED.torque_per_amp();
    assert!(ripple < bound && ripple > 0.7 * bound, "{ripple} of {bound}");
}

/// A winding between instants: `i(k+1) = a i(k) + b v(k-1)`, by the rate of its decay.
struct Coil {
    resistance: f64,
    inductance: f64,
    current: f64,
    voltage: f64,
}

impl Coil {
    fn pass(&mut self, next: f64) {
        let end = self.voltage / self.resistance;
        let part = -(-self.resistance / self.inductance * INSTANT).exp_m1();
        self.current += (end - self.current) * part;
        self.voltage = next;
    }
}

fn run(
    design: &CurrentLoop,
    motor: Motor,
    reference: impl Fn(usize) -> i16,
    instants: usize,
) -> Vec<f64> {
    let Motor { resistance, inductance, .. } = motor;
    let law = &design.law;
    let (mut follower, mut coil) =
        (Follower::AT_REST, Coil { resistance, inductance, current: 0.0, voltage: 0.0 });
    (0..instants)
        .map(|instant| {
            let current = coil.current;
            let reference = law.amps_per_code * f32::from(reference(instant));
            let wanted = follower.follow(law, reference, current as f32);
            follower.integrate(law, wanted.deviation, false);
            coil.pass(wanted.volts.into());
            current
        })
        .collect()
}

#[test]
fn a_step_is_that_of_the_model_to_rounding() {
    for bandwidth in [20.0, 300.0, 1000.0] {
        let drive = Drive { bandwidth, ..DRIVE };
        let design = CurrentLoop::checked(&drive, &STAGE, &TRANSDUCERS, PERIOD);
        let steps = [(2, FULL_SCALE), (50, -FULL_SCALE), (90, 17)];
        let code = |instant| code_at(&steps, instant);
        for (instant, current) in run(&design, DRIVE.motor, code, 1000).into_iter().enumerate() {
            let off = (current - certified_current(&design, &steps, instant)).abs();
            assert!(off < 2e-5, "{bandwidth} Hz, {instant}: {off}");
        }
    }
}

/// The response to an error of the measurement is `K/(z^2 - z + K)`: never negative, and of the sum 1.
#[test]
fn an_error_of_the_measurement_does_not_come_out_larger() {
    for bandwidth in [20.0, 300.0, 1000.0, 1060.0] {
        let drive = Drive { bandwidth, ..DRIVE };
        let design = CurrentLoop::checked(&drive, &STAGE, &TRANSDUCERS, PERIOD);
        let (mut follower, mut sum) = (Follower::AT_REST, 0.0);
        let Motor { resistance, inductance, .. } = DRIVE.motor;
        let mut coil = Coil { resistance, inductance, current: 0.0, voltage: 0.0 };
        for instant in 0..5000 {
            let error = if instant == 0 { 1.0 } else { 0.0 };
            let wanted = follower.follow(&design.law, 0.0, coil.current as f32 + error);
            follower.integrate(&design.law, wanted.deviation, false);
            coil.pass(wanted.volts.into());
            assert!(coil.current < 1e-5, "{bandwidth}: {}", coil.current);
            sum -= coil.current;
        }
        assert!((sum - 1.0).abs() < 1e-3, "{bandwidth}: {sum}");
    }
}

/// Full scale is 20 A, and the current of 10 A may last.
const HOT: CurrentLoop = {
    let stage = PowerStage { continuous_current: 10.0, ..STAGE };
    let motor = Motor { resistance: 0.1, inductance: 0.05e-3, ..DRIVE.motor };
    let drive = Drive { motor, ..DRIVE };
    let transducers = Transducers { full_scale_torque: 1.0, ..TRANSDUCERS };
    CurrentLoop::checked(&drive, &stage, &transducers, PERIOD)
};

/// The currents in A at the ends of so many seconds, for a servo that wants this current, with a limit that steps by
/// a hundredth of full scale.
fn currents(heating: &mut Heating, limit: &mut f64, wanted: f64, seconds: usize) -> Vec<f64> {
    let second = |limit: &mut f64, heating: &mut Heating| {
        let mut current = 0.0;
        for _ in 0..1000 {
            current = wanted.min(*limit);
            let code = (current / 20.0 * 1791.0).round() as i16;
            match heating.observe(current as f32, code) {
                Some(HeatStep::Lower) => *limit = (*limit - 0.2).max(0.0),
                Some(HeatStep::Raise) => *limit = (*limit + 0.2).min(20.0),
                None => {}
            }
        }
        current
    };
    (0..seconds).map(|_| second(limit, heating)).collect()
}

#[test]
fn the_peak_falls_to_the_continuous_current_and_comes_back_after_a_rest() {
    let (mut heating, mut limit) = (HOT.heating(), 20.0);
    let hot = currents(&mut heating, &mut limit, 20.0, 60);
    // From cold the square of 20 A reaches nine tenths of that of 10 A after 4 s times ln(400/310).
    assert!(hot[0] > 19.9 && hot[4] < 15.0, "{hot:?}");
    let end = hot[59];
    assert!((9.5..=10.3).contains(&end), "{end} A");
    let mean = hot[20..].iter().map(|current| current * current).sum::<f64>() / 40.0;
    assert!(mean.sqrt() < 10.5, "{} A", mean.sqrt());
    currents(&mut heating, &mut limit, 0.0, 5);
    assert!(limit > 19.9, "{limit} A");
}

#[test]
fn the_continuous_current_is_never_limited() {
    let (mut heating, mut limit) = (HOT.heating(), 20.0);
    currents(&mut heating, &mut limit, 9.9, 60);
    assert_eq!(limit, 20.0);
    // Nor any current of a loop whose full scale the board bears.
    let mut heating = BRUSHED.heating();
    assert!((0..100_000).all(|_| heating.observe(4.0, 1791).is_none()));
}
