//! Computed one tick early, and put out one tick late: the same codes.

use super::*;

/// In every format: each code that is computed ahead is the next one of the servo that computes in
/// time, to the bit, and the first code of that one is mid-scale.
fn is_ahead(environment: Environment, coupling: Coupling, latency: Latency) {
    let scene = Scene { coupling, latency, torque_limit: Some(0.5), ..scene(environment) };
    is_ahead_in::<f32>(&scene);
    is_ahead_in::<f64>(&scene);
    is_ahead_in::<FixedI32<U16>>(&scene);
    is_ahead_in::<FixedI32<U20>>(&scene);
}

fn is_ahead_in<N: Number>(scene: &Scene) {
    let mut in_time = Servo::<_, N>::build(scene, &TRANSDUCERS).unwrap();
    let mut early = in_time.clone();
    let mut latched = DacCode::MID_SCALE;
    let mut codes = Vec::new();
    for count in hand() {
        let raw = RawCount::from(count);
        let (output, torque) = (in_time.tick(raw), early.torque_nm());
        assert_eq!(output.code, latched, "{scene:?} at {count}");
        assert_eq!(in_time.torque_nm().to_bits(), torque.to_bits());
        latched = early.timed_tick::<Latched>(raw, &mut NoAction).code;
        codes.push(output.code);
    }
    assert!(codes.iter().any(|code| *code != DacCode::MID_SCALE), "{scene:?}");
}

static KNOB: Knots<16> = Knots::of(&[Shape::detents(24, 0.02), Shape::end_stops(-2.0, 2.0, 5.0)]);

#[test]
fn what_is_latched_is_what_would_have_been_computed_in_time() {
    let damper = Wall::damped(12.0, 0.005, 1);
    let filtered = Wall::damped(5.0, 0.01, 2).filtered(0.8);
    let rational = Rational {
        numerator: Coefficients::new(&[8.0, -2.0]).unwrap(),
        denominator: Coefficients::new(&[1.0, -0.5]).unwrap(),
        delay: 1,
        unit_zeros: 0,
    };
    let displaced = |wall: Wall, at| Wall { side: Side::Displaced(at), ..wall };
    for wall in [
        Wall::spring(22.0, 1),
        Wall::spring(2.0, 8),
        damper,
        Wall::damped(1.0, 0.005, 8),
        filtered,
        displaced(damper, 0.05),
        displaced(filtered, -0.02),
        damper.behind(0.05),
        filtered.behind(-0.02),
        Wall::spring(4.0, 3).behind(0.02),
    ] {
        is_ahead(wall.alone(), Coupling::Spring { stiffness: 44.0 }, Latency::NONE);
    }
    let sum = Parts {
        wall: Some(Wall::damped(3.0, 0.001, 2).behind(0.05)),
        profile: Some(Profile::of(&KNOB, 1)),
        drag: Some(Drag::of(0.004, 3)),
        ..Parts::NONE
    };
    for environment in [
        sum.sum(),
        Canceller { residual: 0.015, delay: 1 }.alone(),
        Canceller { residual: 0.02, delay: 4 }.alone(),
        Environment::Rational(rational),
    ] {
        is_ahead(environment, Coupling::Spring { stiffness: 44.0 }, Latency::NONE);
    }
}

/// The coupling that absorbs a lag remembers torques, which the servo ahead has one tick later.
#[test]
fn so_it_is_behind_the_matched_coupling() {
    for environment in [
        Wall::spring(12.0, 1).alone(),
        Wall::damped(12.0, 0.005, 1).behind(0.05).alone(),
        Canceller { residual: 0.015, delay: 2 }.alone(),
    ] {
        is_ahead(environment, Coupling::Matched, Latency::NONE.with_actuator_lag(4e-4));
    }
}
