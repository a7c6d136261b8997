//! Limits, refusals, and robustness.

use super::*;

#[test]
fn the_limit_and_its_reason_belong_together() {
    let spring = scene(Wall::spring(22.0, 1).alone());
    for (torque_limit, reason, far) in [
        (None, LimitReason::DacRange, 1791),
        (Some(1.0), LimitReason::Torque, 1791),
        (Some(0.5), LimitReason::Torque, 896),
    ] {
        let scene = Scene { torque_limit, ..spring };
        let certified = scene.certify().unwrap();
        let mut servo: Servo<_, f32> = Servo::new(&certified, &TRANSDUCERS).unwrap();
        let at = |code: i32| DacCode::new(code as u16).unwrap();
        let mut tick = |count: i32| servo.tick(RawCount::from(count));
        assert_eq!(tick(3000), Output { code: at(2048), limit: LimitReason::None });
        assert_eq!(tick(3000), Output { code: at(2048 - far), limit: reason });
        tick(-3000);
        assert_eq!(tick(-3000), Output { code: at(2048 + far), limit: reason });
    }
}

#[test]
fn an_encoder_and_a_dac_in_one_call() {
    struct Counter(i16);
    struct Held(Option<DacCode>);
    impl Encoder for Counter {
        fn read(&mut self) -> RawCount {
            self.0 = self.0.wrapping_add(100);
            RawCount::from(self.0)
        }
    }
    impl Dac for Held {
        fn write(&mut self, code: DacCode) {
            self.0 = Some(code);
        }
    }
    let narrow = Transducers { counter: CounterWidth::Bits16, ..TRANSDUCERS };
    let certified = scene(Wall::spring(22.0, 1).alone()).certified();
    let mut servo: Servo<_, f32> = Servo::new(&certified, &narrow).unwrap();
    let (mut counter, mut held) = (Counter(0), Held(None));
    for ticks in 1..=1000 {
        servo.update(&mut counter, &mut held);
        assert_eq!(servo.count(), ticks * 100);
    }
    assert_eq!(held.0, DacCode::new(2048 - 1791).ok());
    assert!((servo.angle_rad() - 100_000.0 / 61_440.0 * core::f64::consts::TAU).abs() < 1e-12);
    assert_eq!(servo.torque_nm(), 1.0);
}

#[test]
fn what_cannot_be_built_is_refused_in_a_sentence() {
    let spring = scene(Wall::spring(22.0, 1).alone());
    let build = |scene: &Scene<_>, transducers: Transducers| {
        Servo::<_, f32>::build(scene, &transducers).unwrap_err().to_string()
    };
    assert_eq!(
        build(&spring, Transducers { counts_per_turn: 0.0, ..TRANSDUCERS }),
        "the counts per turn must be positive and finite, and is 0"
    );
    assert_eq!(
        build(&spring, Transducers { full_scale_torque: f64::NAN, ..TRANSDUCERS }),
        "the full-scale torque must be positive and finite, and is NaN"
    );
    assert_eq!(
        build(&Scene { torque_limit: Some(1.5), ..spring }, TRANSDUCERS),
        "the torque limit of 1.5 N m is above the DAC's full scale of 1 N m: lower it to \
         that, or scale the amplifier up"
    );
    let stiff = scene(Wall::spring(1e300, 1).alone());
    assert_eq!(
        build(&stiff, TRANSDUCERS),
        "the wall stiffness: 1e300 does not fit f32: its magnitude may be at most 1.099511628e12"
    );
    let weak = Transducers { full_scale_torque: 1e-5, ..TRANSDUCERS };
    assert_eq!(
        Servo::<_, FixedI32<U16>>::build(&spring, &weak).unwrap_err().to_string(),
        "the torque limit in the servo's number format must be positive and finite, and is 0"
    );
    let of = |data: Rational| {
        let scene = scene(Environment::Rational(data));
        Servo::<_, f32>::build(&scene, &TRANSDUCERS).unwrap_err()
    };
    let coefficients = |c: &[f64]| Coefficients::new(c).unwrap();
    let data = Rational {
        numerator: coefficients(&[1.0, 0.0]),
        denominator: coefficients(&[0.0, 1.0, 0.5]),
        delay: 0,
        unit_zeros: 1,
    };
    assert_eq!(of(data), BuildError::Improper { numerator: 2, denominator: 1 });
    let data = Rational { unit_zeros: 0, delay: 9, ..data };
    assert_eq!(of(data), BuildError::Delay { delay: 9, largest: 8 });
}

/// Any double, with those that people write more often than chance has it.
fn number() -> impl Strategy<Value = f64> {
    use proptest::num::f64::ANY;
    prop_oneof![ANY, -100.0..100.0_f64, 0.0..1.0_f64, Just(0.0), Just(f64::INFINITY)]
}

fn any_wall() -> impl Strategy<Value = Wall> {
    let filter = proptest::option::of(number());
    (number(), number(), filter, 0..12_usize, number(), any::<bool>()).prop_map(
        |(stiffness, damping, filter, delay, face, one_sided)| {
            let damper = Some(Damper { damping, filter });
            let side = if one_sided { Side::Face(face) } else { Side::Displaced(face) };
            Wall { stiffness, damper, side, delay }
        },
    )
}

fn any_environment() -> impl Strategy<Value = Environment> {
    let polynomial = || {
        proptest::collection::vec(number(), 1..=MAX_DEGREE + 1)
            .prop_map(|c| Coefficients::new(&c).unwrap())
    };
    let rational =
        (polynomial(), polynomial(), 0..12_usize, prop_oneof![0..3_usize, any::<usize>()])
            .prop_map(|(numerator, denominator, delay, unit_zeros)| {
                Environment::Rational(Rational { numerator, denominator, delay, unit_zeros })
            });
    prop_oneof![
        any_wall().prop_map(|wall| Wall { damper: None, ..wall }.alone()),
        any_wall().prop_map(Wall::alone),
        (number(), 0..12_usize).prop_map(|(residual, delay)| Canceller { residual, delay }.alone()),
        (number(), any_wall()).prop_map(|(residual, wall)| free_mode_wall(residual, wall)),
        rational,
    ]
}

/// Every servo that builds: no panic, and torque within its limit.
fn endures<N: Number>(scene: &Scene<Environment>, transducers: &Transducers, raw: &[u32])
where
    Environment: Rendering<N>,
{
    let Ok(mut servo) = Servo::<Environment, N>::build(scene, transducers) else { return };
    let largest = scene.torque_limit.unwrap_or(transducers.full_scale_torque);
    for raw in raw {
        let output = servo.tick(RawCount::from(*raw));
        // No board's DAC outputs more.
        assert!(output.code.offset().unsigned_abs() <= DacCode::CODES_TO_FULL_SCALE);
        assert!(servo.torque_nm().abs() <= largest);
        if output.limit == LimitReason::NotANumber {
            assert_eq!(output.code, DacCode::MID_SCALE);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]
    #[test]
    fn nothing_panics_and_no_torque_exceeds_the_limit(
        environment in any_environment(),
        (damping, period, torque_limit) in (number(), number(), proptest::option::of(number())),
        stiffness in proptest::option::of(number()),
        (counts_per_turn, full_scale_torque) in (number(), number()),
        narrow: bool,
        raw in proptest::collection::vec(any::<u32>(), 0..40),
    ) {
        let coupling = match stiffness {
            Some(stiffness) => Coupling::Spring { stiffness },
            None => Coupling::Rigid,
        };
        let scene = Scene::of(Device::damped(1e-5, damping), period, environment);
        let scene = Scene { coupling, torque_limit, ..scene };
        let counter = if narrow { CounterWidth::Bits16 } else { CounterWidth::Bits32 };
        let transducers = Transducers { counts_per_turn, counter, full_scale_torque, ..TRANSDUCERS };
        endures::<f32>(&scene, &transducers, &raw);
        endures::<f64>(&scene, &transducers, &raw);
        endures::<FixedI32<U16>>(&scene, &transducers, &raw);
    }
}
