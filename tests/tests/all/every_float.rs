//! `certify` over all of `f64`: no input makes it panic, none that is not finite passes, and what
//! it says is consistent.

use haptic_servo::certificate::{
    Assumptions, Rejection, Resolution, Rule, RuleAnswer, assess_in, certify,
};
use haptic_servo::environment::{
    Canceller, Coefficients, Damper, Environment, Parts, Rational, Side, Wall,
};
use haptic_servo::number::Format;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use proptest::prelude::*;

/// Any bits, the edges of the format, and numbers such as people write.
fn float() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => any::<u64>().prop_map(f64::from_bits),
        1 => proptest::num::f64::ANY,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, f64::NAN, f64::INFINITY, f64::MAX, 5e-324]),
        4 => 1e-4..1e3,
        1 => -1e3..-1e-4,
    ]
}

/// Numbers that make sense, so that the rest of the scene is looked at.
fn positive() -> impl Strategy<Value = f64> {
    prop_oneof![8 => (-12.0..9.0).prop_map(|x: f64| x.exp2()), 1 => float()]
}

fn wall() -> impl Strategy<Value = Wall> {
    let filter = prop::option::of(prop_oneof![0.0..1.0, float()]);
    let damper = (float(), filter).prop_map(|(damping, filter)| Damper { damping, filter });
    let side = prop_oneof![
        Just(Side::Centred),
        float().prop_map(Side::Displaced),
        float().prop_map(Side::Face),
    ];
    let delay = prop_oneof![0_usize..9, any::<usize>()];
    (float(), prop::option::of(damper), side, delay)
        .prop_map(|(stiffness, damper, side, delay)| Wall { stiffness, damper, side, delay })
}

fn coefficients() -> impl Strategy<Value = Coefficients> {
    prop::collection::vec(prop_oneof![4 => -2.0..2.0, 1 => float()], 1..=9)
        .prop_map(|c| Coefficients::new(&c).expect("one to nine coefficients"))
}

fn environment() -> impl Strategy<Value = Environment> {
    let small = || prop_oneof![4 => 0_usize..9, 1 => any::<usize>()];
    let rational = (coefficients(), coefficients(), small(), small());
    prop_oneof![
        2 => wall().prop_map(Wall::alone),
        1 => (float(), small()).prop_map(|(residual, delay)| Canceller { residual, delay }.alone()),
        1 => (float(), wall()).prop_map(|(residual, wall)| {
            let (canceller, wall) = (Some(Canceller::to(residual)), Some(wall));
            Parts { canceller, wall, profile: None }.sum()
        }),
        1 => rational.prop_map(|(numerator, denominator, delay, unit_zeros)| {
            Environment::Rational(Rational { numerator, denominator, delay, unit_zeros })
        }),
    ]
}

fn scene() -> impl Strategy<Value = Scene> {
    // Mostly no more passivity than damping, which alone is judged.
    let device = (positive(), positive(), prop::option::of(positive()), prop::bool::weighted(0.9))
        .prop_map(|(inertia, damping, passivity, in_order)| match passivity {
            Some(other) if in_order => {
                let (damping, passivity) = (damping.max(other), Some(damping.min(other)));
                Device { inertia, damping, passivity }
            }
            _ => Device { inertia, damping, passivity },
        });
    let timing = (positive(), prop::option::weighted(0.2, positive()))
        .prop_map(|(period, worst_period)| Timing { period, worst_period });
    let coupling = prop_oneof![
        Just(Coupling::Rigid),
        positive().prop_map(|stiffness| Coupling::Spring { stiffness }),
    ];
    (device, timing, coupling, environment(), prop::option::weighted(0.2, positive())).prop_map(
        |(device, timing, coupling, environment, torque_limit)| Scene {
            device,
            timing,
            coupling,
            environment,
            latency: Latency::NONE,
            torque_limit,
        },
    )
}

fn format() -> impl Strategy<Value = Format> {
    prop_oneof![
        Just(Format::F64),
        Just(Format::F32),
        (0..=32_u32).prop_map(|fraction_bits| Format::Fixed { fraction_bits }),
    ]
}

/// Whether every number of the scene is finite.
fn is_finite(scene: &Scene) -> bool {
    let wall = |w: &Wall| {
        let all = [w.stiffness, w.damping(), w.filter().unwrap_or(0.0), w.face()];
        all.iter().all(|x| x.is_finite())
    };
    let polynomials = scene.environment.rational().is_none_or(|r| {
        let all = r.numerator.as_slice().iter().chain(r.denominator.as_slice());
        all.into_iter().all(|x| x.is_finite())
    });
    let environment = scene.environment.wall().is_none_or(wall)
        && scene.environment.canceller().is_none_or(|canceller| canceller.residual.is_finite())
        && polynomials;
    let stiffness = match scene.coupling {
        Coupling::Rigid => 1.0,
        Coupling::Matched => unreachable!("not drawn"),
        Coupling::Spring { stiffness } => stiffness,
    };
    let device = &scene.device;
    let rest = [
        device.inertia,
        device.damping,
        device.passivity.unwrap_or(1.0),
        scene.timing.period,
        scene.timing.worst_period.unwrap_or(1.0),
        stiffness,
        scene.torque_limit.unwrap_or(1.0),
    ];
    environment && rest.iter().all(|x| x.is_finite())
}

/// A pass that the numbers beside it do not bear out would be an unsafe machine.
fn consistent(scene: &Scene, format: Format) -> Result<(), TestCaseError> {
    let assessment = assess_in(scene, format);
    let intervals =
        [assessment.alpha, assessment.alpha_coupled, assessment.bound, assessment.cos_theta];
    for interval in intervals.into_iter().flatten().chain([assessment.delta]) {
        prop_assert!(interval.lo() <= interval.hi(), "{interval:?}");
    }
    let below =
        |index: Option<Interval>| index.is_some_and(|index| index.hi() < assessment.delta.lo());
    if assessment.exact == RuleAnswer::Pass {
        prop_assert!(is_finite(scene) && below(assessment.alpha_coupled), "{assessment:?}");
    }
    if assessment.paper == RuleAnswer::Pass {
        let index =
            if assessment.rule == Rule::Exact { assessment.alpha } else { assessment.bound };
        prop_assert!(is_finite(scene) && below(index), "{assessment:?}");
        // Without a coupling, the index at the port decides.
        let is_at_port = assessment.rule == Rule::Nonlinear && scene.coupling == Coupling::Rigid;
        let is_spring = matches!(scene.coupling, Coupling::Spring { .. });
        prop_assert!(is_spring || is_at_port, "{assessment:?}");
    }
    let deciding = match assessment.rule {
        Rule::Exact => assessment.exact,
        Rule::Nonlinear => assessment.paper,
    };
    prop_assert_eq!(assessment.outcome.is_ok(), deciding == RuleAnswer::Pass);
    if assessment.outcome.is_ok() {
        prop_assert!(below(assessment.deciding_index()), "{assessment:?}");
        let margin = assessment.margin(scene);
        let delta = assessment.delta.lo();
        prop_assert!(margin.is_some_and(|m| m >= 0.0 && m <= delta), "{margin:?} {assessment:?}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn what_is_said_is_consistent(scene in scene(), format in format()) {
        consistent(&scene, format)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..Default::default() })]

    /// The whole answer, remedies, sentence and assumptions included.
    #[test]
    fn every_scene_gets_an_answer(scene in scene(), encoder in float(), friction in float()) {
        let steps = Resolution {
            encoder: Some(encoder),
            friction: Some(friction),
            ..Resolution::default()
        };
        let assumptions = Assumptions::of(&scene, &assess_in(&scene, Format::F32), &steps);
        prop_assert!(assumptions.iter().all(|one| one.to_string().len() > 40));
        match certify(&scene) {
            Ok(assessment) => prop_assert!(assessment.outcome.is_ok()),
            Err(rejection) => {
                let sentence = rejection.to_string();
                prop_assert!(sentence.starts_with("rejected: ") || sentence.starts_with("undecided: "));
                prop_assert!(!rejection.reason().is_empty() && rejection.reason() != "ok");
                for remedy in rejection.remedies().iter() {
                    prop_assert!(!remedy.to_string().is_empty());
                }
            }
        }
    }
}

/// Nothing is calculated from numbers that are out of range: a delay that no integer of the
/// mathematics holds has a sentence, and assumptions beside it.
#[test]
fn a_delay_of_any_size_gets_an_answer() {
    for samples in [9, 1 << 31, usize::MAX] {
        let coefficients = Coefficients::new(&[1.0]).expect("one coefficient");
        let (numerator, denominator) = (coefficients, coefficients);
        let environment = Environment::Rational(Rational {
            numerator,
            denominator,
            delay: samples,
            unit_zeros: samples,
        });
        let scene = Scene {
            device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
            timing: Timing { period: 0.001, worst_period: None },
            coupling: Coupling::Spring { stiffness: 44.0 },
            environment,
            latency: Latency::NONE,
            torque_limit: None,
        };
        let steps = Resolution {
            encoder: Some(1e-4),
            full_scale: Some(1.0),
            friction: Some(0.01),
            ..Resolution::default()
        };
        let assessment = assess_in(&scene, Format::F32);
        assert!(matches!(assessment.outcome, Err(Rejection::Invalid(_))), "{assessment:?}");
        assert!(Assumptions::of(&scene, &assessment, &steps).iter().count() > 0);
    }
}
