//! Computed one tick early, and put out one tick late: the same codes.

use super::*;
use crate::servo::Delayed;

/// In every format: each code that is computed ahead is the next one of the servo that computes in
/// time, to the bit, and the first code of that one is mid-scale.
macro_rules! ahead {
    ($($environment:expr),* $(,)?) => {
        ahead!(@ [$($environment),*], Coupling::Spring { stiffness: 44.0 }, Latency::NONE);
    };
    (@ [$($environment:expr),*], $coupling:expr, $latency:expr) => {$({
        let (coupling, latency) = ($coupling, $latency);
        let scene = Scene {
            coupling, latency, torque_limit: Some(0.5), ..scene($environment)
        };
        fn is_delayed<E: Delayed>(_: &Scene<E>) {}
        is_delayed(&scene);
        ahead!(@ scene, f32);
        ahead!(@ scene, f64);
        ahead!(@ scene, FixedI32<U16>);
        ahead!(@ scene, FixedI32<U20>);
    })*};
    (@ $scene:ident, $number:ty) => {
        let mut in_time = Servo::<_, $number>::build(&$scene, &TRANSDUCERS).unwrap();
        let mut early = in_time.clone();
        let mut latched = DacCode::MID_SCALE;
        let mut codes = Vec::new();
        for count in hand() {
            let raw = RawCount::from(count);
            let (output, torque) = (in_time.tick(raw), early.torque_nm());
            assert_eq!(output.code, latched, "{:?} at {count}", $scene);
            assert_eq!(in_time.torque_nm().to_bits(), torque.to_bits());
            latched = early.timed_tick::<Latched>(raw, &mut NoAction).code;
            codes.push(output.code);
        }
        assert!(codes.iter().any(|code| *code != DacCode::MID_SCALE), "{:?}", $scene);
    };
}

#[test]
fn what_is_latched_is_what_would_have_been_computed_in_time() {
    let damper = DamperWall::<1> { stiffness: 12.0, damping: 0.005 };
    let filtered = FilteredWall::<2> { stiffness: 5.0, damping: 0.01, filter: 0.8 };
    let rational = Rational {
        numerator: Coefficients::new(&[8.0, -2.0]).unwrap(),
        denominator: Coefficients::new(&[1.0, -0.5]).unwrap(),
        delay: 1,
        unit_zeros: 0,
    };
    ahead![
        DelayedSpring::<1> { stiffness: 22.0 },
        DelayedSpring::<8> { stiffness: 2.0 },
        damper,
        DamperWall::<8> { stiffness: 1.0, damping: 0.005 },
        filtered,
        Placed { face: 0.05, wall: damper },
        Placed { face: -0.02, wall: filtered },
        OneSided { face: 0.05, wall: damper },
        OneSided { face: -0.02, wall: filtered },
        OneSided { face: 0.02, wall: DelayedSpring::<3> { stiffness: 4.0 } },
        FreeMode::<1> { residual: 0.015 },
        FreeMode::<4> { residual: 0.02 },
        damper.as_data(),
        OneSided { face: 0.02, wall: filtered }.as_data(),
        FreeMode::<2> { residual: 0.015 }.as_data(),
        rational,
        rational.as_data(),
    ];
}

/// The coupling that absorbs a lag remembers torques, which the servo ahead has one tick later.
#[test]
fn so_it_is_behind_the_matched_coupling() {
    let damper = DamperWall::<1> { stiffness: 12.0, damping: 0.005 };
    let latency = Latency::NONE.with_actuator_lag(4e-4);
    ahead!(
        @ [
            Matched::<_, 0, 1> { environment: DelayedSpring::<1> { stiffness: 12.0 } },
            Matched::<_, 0, 1> { environment: OneSided { face: 0.05, wall: damper } },
            Matched::<_, 0, 1> { environment: FreeMode::<2> { residual: 0.015 } },
            damper.as_data()
        ],
        Coupling::Matched,
        latency
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]
    #[test]
    fn so_it_is_for_any_wall_coupling_and_hand(
        mut wall in wall(),
        coupling in coupling(),
        torque_limit in proptest::option::of(0.05..1.0_f64),
        steps in proptest::collection::vec(-150..150_i32, TICKS),
    ) {
        wall.delay = wall.delay.max(1);
        let environment = Environment::DamperWall(wall);
        let scene = Scene { coupling, torque_limit, ..scene(environment) };
        let Ok(mut in_time) = Servo::<_, f32>::build(&scene, &TRANSDUCERS) else { return Ok(()) };
        let mut early = in_time.clone();
        let (mut count, mut latched) = (0, DacCode::MID_SCALE);
        for step in steps {
            count += step - count / 16;
            prop_assert_eq!(in_time.tick(RawCount::from(count)).code, latched);
            latched = early.timed_tick::<Latched>(RawCount::from(count), &mut NoAction).code;
        }
    }
}
