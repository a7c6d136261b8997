//! The observer against sums of its own definition, the damper against its difference equation,
//! its index, and its effect on a device that has less damping than it was said to have.

use core::f64::consts::TAU;

use proptest::prelude::*;

use super::*;
use crate::encoder::RawCount;
use crate::environment::{Discretize, Environment, Law, LawContext, Wall};
use crate::scene::{Coupling, Latency, Scene};
use crate::servo::{
    AtPhase, Latched, PreparedServo, RenderingOptions, Servo, Simultaneous, Transducers,
};
use crate::test_scene;

const PERIOD: f64 = 1e-3;
const TRANSDUCERS: Transducers =
    Transducers { counts_per_turn: 1e6, full_scale_torque: 2.0, ..test_scene::TRANSDUCERS };

const fn spring(stiffness: f64) -> Scene {
    Scene { torque_limit: Some(1.5), ..test_scene::scene(Wall::spring(stiffness, 1).alone()) }
}

/// Ticks in which the encoder moved by `step` and a code was written.
fn ticks() -> impl Strategy<Value = Vec<(i32, u16)>> {
    proptest::collection::vec((-2000..2000_i32, 1..=4095_u16), 1..200)
}

/// Observes ticks in the mode `M`; gives the net energy after each.
fn observed<M: OutputMode>(ticks: &[(i32, u16)]) -> (Vec<i64>, EnergyMonitor) {
    let mut monitor = EnergyMonitor::default();
    let mut observe = |&(step, code): &(i32, u16)| {
        monitor.observe::<M>(step, DacCode::new(code).unwrap());
        monitor.net()
    };
    (ticks.iter().map(&mut observe).collect(), monitor)
}

/// The work of every period, where a code is at the motor `late` periods after the count that it
/// was computed from.
fn worked(ticks: &[(i32, u16)], late: usize) -> Vec<i64> {
    let mut sum = 0;
    let mut work = |k: usize| {
        // The period that ends with count k began with count k - 1.
        let held = (k > late).then(|| i64::from(ticks[k - 1 - late].1) - 2048);
        sum += held.unwrap_or(0) * i64::from(ticks[k].0);
        sum
    };
    (0..ticks.len()).map(&mut work).collect()
}

proptest! {
    #[test]
    fn every_count_against_the_code_that_was_held(ticks in ticks()) {
        let worst = |work: &[i64]| work.iter().copied().fold(0, i64::max);
        let (net, monitor) = observed::<Latched>(&ticks);
        let work = worked(&ticks, 1);
        prop_assert_eq!(&net, &work);
        prop_assert_eq!(monitor.worst(), worst(&work));
        prop_assert_eq!(monitor.is_deficit(), *work.last().unwrap() > 0);
        let at_once = worked(&ticks, 0);
        prop_assert_eq!(&observed::<Simultaneous>(&ticks).0, &at_once);
    }

    /// A code that is put out a quarter of a period after its count: a quarter of each step was against
    /// the code before, to the last digit.
    #[test]
    fn both_codes_of_a_period_by_their_times(ticks in ticks()) {
        let mut monitor = EnergyMonitor::with_phase(0.25);
        let (newer, older) = (worked(&ticks, 0), worked(&ticks, 1));
        let mut worst = 0;
        for (k, &(step, code)) in ticks.iter().enumerate() {
            monitor.observe::<AtPhase<250_000>>(step, DacCode::new(code).unwrap());
            let exact = 3 * newer[k] + older[k];
            worst = worst.max(exact);
            prop_assert_eq!(monitor.net(), exact.div_euclid(4));
            prop_assert_eq!(monitor.is_deficit(), exact > 0);
        }
        prop_assert_eq!(monitor.worst(), worst.div_euclid(4));
    }

    /// A tick that began late is in a longer step, most of which was against the newer code.
    #[test]
    fn a_late_tick_takes_the_worse_of_both_codes(ticks in ticks(), step in -4000..4000_i32) {
        let mut monitor = EnergyMonitor::with_phase(0.25);
        for &(step, code) in &ticks {
            monitor.observe::<AtPhase<250_000>>(step, DacCode::new(code).unwrap());
        }
        let (mut in_time, before) = (monitor, monitor.net());
        in_time.observe::<AtPhase<250_000>>(step, DacCode::MID_SCALE);
        monitor.missed::<AtPhase<250_000>>(step);
        monitor.observe::<AtPhase<250_000>>(step, DacCode::MID_SCALE);
        let newer = i64::from(ticks.last().unwrap().1) - 2048;
        let all_newer = before + newer * i64::from(step);
        prop_assert!(monitor.net() >= in_time.net() && monitor.net() >= all_newer);
    }

    /// A tick was missed: the latch changed from one code to the next anywhere in the encoder's
    /// step.
    #[test]
    fn after_a_missed_tick_no_less_than_what_can_have_been(
        ticks in ticks(), step in -4000..4000_i32, share in 0.0..=1.0_f64,
    ) {
        let (_, mut monitor) = observed::<Latched>(&ticks);
        let before = monitor;
        let first = (f64::from(step) * share) as i32;
        let mut exact = before;
        exact.observe::<Latched>(first, DacCode::MID_SCALE);
        exact.observe::<Latched>(step - first, DacCode::MID_SCALE);
        monitor.missed::<Latched>(step);
        monitor.observe::<Latched>(step, DacCode::MID_SCALE);
        prop_assert!(monitor.net() >= exact.net());
    }

    /// Theory, section 5: with any input and any switching, the index of the environment with the
    /// damper is at most index plus damping.
    #[test]
    fn a_switched_damper_adds_its_damping_to_the_index(
        stiffness in 0.0..40.0_f64,
        damping in 0.001..0.05_f64,
        moves in proptest::collection::vec((-1e-3..1e-3_f64, any::<bool>()), 1..300),
    ) {
        let setting = LawContext {
            period: PERIOD,
            worst_period: None,
            damping: 0.022,
            passivity: 0.022,
            coupling: Coupling::Spring { stiffness: 44.0 },
            latency: Latency::NONE,
        };
        let mut law = Discretize::<f64>::law(&Wall::spring(stiffness, 1).alone(), &setting).unwrap();
        let mut injector = Injector::<f64>::new(damping, PERIOD).unwrap();
        let (mut x, mut supplied, mut squares) = (0.0, 0.0, 0.0);
        for (step, on) in moves {
            injector.switch(on);
            let Response::Held(torque) = injector.add_to(law.evaluate(x + step)) else { unreachable!() };
            x += step;
            law.update(x);
            injector.update(x);
            supplied += torque * step;
            squares += step * step / PERIOD;
        }
        let index = stiffness * PERIOD / 2.0 + damping;
        prop_assert!(supplied >= -index * squares - 1e-12, "{supplied} {squares}");
    }
}

#[test]
fn the_unit_is_a_turn_at_full_torque() {
    let counts = TRANSDUCERS.counts_per_turn * f64::from(DacCode::CODES_TO_FULL_SCALE);
    let energy = counts * TRANSDUCERS.energy_unit();
    assert!((energy - 2.0 * TAU).abs() < 1e-12);
}

fn rendering<M: OutputMode>(
    stiffness: f64,
    injection: Option<f64>,
) -> PreparedServo<Environment, f64, M>
where
    Environment: crate::servo::SupportsTiming<M>,
{
    let timed = spring(stiffness).certified().timing_checked::<M>();
    let options = RenderingOptions { injection, ..RenderingOptions::DEFAULT };
    let mut rendering = PreparedServo::new(&timed, &TRANSDUCERS, &options).unwrap();
    while !rendering.servo_mut().clamp().open() {}
    rendering
}

/// A monitor that has seen more energy go in than out.
fn deficit() -> EnergyMonitor {
    observed::<Simultaneous>(&[(0, 3000), (10, 2048)]).1
}

fn hand() -> impl Iterator<Item = i32> {
    (0..2000_i32).map(|k| (9000.0 * (f64::from(k) * 0.013).sin() + f64::from(k % 7)) as i32)
}

#[test]
fn without_the_action_and_without_a_deficit_the_codes_are_the_plain_servos() {
    let surplus = observed::<Simultaneous>(&[(0, 1000), (10, 2048)]).1;
    for (injection, energy) in [(None, deficit()), (Some(0.01), surplus)] {
        let mut plain: Servo<_, f64> = Servo::new(&spring(9.0).certified(), &TRANSDUCERS).unwrap();
        let mut rendering = rendering::<Simultaneous>(9.0, injection);
        for count in hand() {
            let (raw, torque) = (RawCount::from(count), rendering.servo().torque_nm());
            assert_eq!(torque.to_bits(), plain.torque_nm().to_bits());
            assert_eq!(rendering.tick(raw, &energy), plain.tick(raw));
        }
    }
}

#[test]
fn the_damper_is_that_of_the_two_samples_before() {
    let (stiffness, damping, coupling) = (9.0, 0.01, 44.0);
    let mut rendering = rendering::<Simultaneous>(stiffness, Some(damping));
    let mut past = [0.0; 2];
    for count in hand() {
        rendering.tick(RawCount::from(count), &deficit());
        let [before, last] = past;
        let torque: f64 = stiffness * last + damping * (last - before) / PERIOD;
        let torque = torque.clamp(-1.5, 1.5);
        let error = rendering.servo().torque_nm() - torque;
        assert!(error.abs() < 1e-9, "{error}");
        past = [last, rendering.servo().angle_rad() - torque / coupling];
    }
}

#[test]
fn no_more_is_injected_than_the_certificate_has_room_for() {
    // The index is 9 * 1e-3 / 2, of 0.022.
    let inject = |damping| {
        let timed = spring(9.0).certified().timing_checked::<Latched>();
        let options = RenderingOptions { injection: Some(damping), ..RenderingOptions::DEFAULT };
        PreparedServo::<_, f32, Latched>::new(&timed, &TRANSDUCERS, &options).map(|_| ())
    };
    assert_eq!(inject(0.01749), Ok(()));
    let refused = inject(0.0176).unwrap_err();
    let BuildError::Injection { damping, room } = refused else { panic!("{refused}") };
    // The coupling's compliance is rounded up to f32, which leaves that much less.
    assert!(damping == 0.0176 && room <= 0.0175 && room > 0.0175 * (1.0 - 2e-7));
    assert!(refused.to_string().starts_with("a damping of 0.0176 N m s/rad that is switched"));
    assert!(matches!(inject(-0.001), Err(BuildError::NotPositive { .. })));
    assert!(matches!(inject(f64::NAN), Err(BuildError::Injection { .. })));
}

/// Largest angle in rad in the second half of a run in which a device of 0.022 N m s/rad as it was
/// certified, and of a tenth of that in truth, is let go at some speed; and the energy monitor.
fn let_go(injection: Option<f64>) -> (f64, EnergyMonitor) {
    let (inertia, damping) = (2.2e-4, 0.0022);
    let mut rendering = rendering::<Latched>(9.0, injection);
    let mut energy = EnergyMonitor::default();
    let (mut angle, mut speed, mut latched, mut largest) = (0.0_f64, 0.3_f64, 0.0, 0.0_f64);
    let mut last = 0;
    for tick in 0..4000 {
        let count = (angle * TRANSDUCERS.counts_per_turn / TAU).floor() as i32;
        let code = rendering.tick(RawCount::from(count), &energy).code;
        energy.observe::<Latched>(count - last, code);
        last = count;
        // An exact hold: the speed decays to its steady state.
        let decay = (-damping / inertia * PERIOD).exp();
        let kept: f64 = latched / damping;
        angle += kept * PERIOD + (speed - kept) * (1.0 - decay) * inertia / damping;
        speed = kept + (speed - kept) * decay;
        latched = f64::from(code.offset()) * 2.0 / 1791.0;
        if tick >= 2000 {
            largest = largest.max(angle.abs());
        }
    }
    (largest, energy)
}

#[test]
fn injection_calms_a_device_that_has_less_damping_than_it_should() {
    let (without, watched) = let_go(None);
    let (with, acted) = let_go(Some(0.015));
    assert!(without > 0.05, "the device was to oscillate, and reached {without} rad");
    assert!(with < 0.2 * without, "{with} against {without} rad");
    assert!(watched.worst() > 10 * acted.worst(), "{} {}", watched.worst(), acted.worst());
}
