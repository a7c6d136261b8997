//! `certify` over all of `f64`: no input makes it panic, none that is not finite passes, and what
//! it says is consistent.

use std::panic::catch_unwind;

use haptic_servo::certificate::{
    Assumptions, Parameter, Rejection, Resolution, Rule, RuleAnswer, assess_in, certify,
};
use haptic_servo::environment::{Coefficients, Environment, Rational, Side};
use haptic_servo::number::Format;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::scene::{Coupling, Device, Scene};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::{floats, scenes};

/// Any bits, the edges of the format, and numbers such as people write instead of some numbers of a scene.
fn draw(rng: &mut ChaCha8Rng) -> Scene {
    let mut scene = scenes::any(rng).scene;
    if let Some(wall) = scene.environment.wall_mut() {
        let face = floats::any(rng);
        wall.side = [Side::Centred, Side::Displaced(face), Side::Face(0.0), Side::Face(face)]
            [rng.random_range(0..4)];
    }
    if let Environment::Rational(rational) = &mut scene.environment
        && rng.random_bool(0.3)
    {
        let mut values = rational.numerator.as_slice().to_vec();
        let place = rng.random_range(0..values.len());
        values[place] = floats::any(rng);
        rational.numerator = Coefficients::new(&values).expect("as many as before");
    }
    for _ in 0..rng.random_range(0..4) {
        let parameter = Parameter::ALL[rng.random_range(0..Parameter::ALL.len())];
        let usual = scene.get(parameter).unwrap_or(1.0) * rng.random_range(-4.0..4.0_f64).exp2();
        let value = if rng.random_bool(0.5) { floats::any(rng) } else { usual };
        scene = scene.with(parameter, value).unwrap_or(scene);
    }
    scene
}

/// Whether every number of the scene is finite.
fn is_finite(scene: &Scene) -> bool {
    let numbers = Parameter::ALL.iter().filter_map(|parameter| scene.get(*parameter));
    let coefficients = scene.environment.rational().into_iter().flat_map(|rational| {
        rational.numerator.as_slice().iter().chain(rational.denominator.as_slice()).copied()
    });
    numbers.chain(coefficients).all(f64::is_finite)
}

/// A pass that the numbers beside it do not bear out would be an unsafe machine.
fn consistent(scene: &Scene, format: Format) {
    let assessment = assess_in(scene, format);
    let intervals =
        [assessment.alpha, assessment.alpha_coupled, assessment.bound, assessment.cos_theta];
    for interval in intervals.into_iter().flatten().chain([assessment.delta]) {
        assert!(interval.lo() <= interval.hi(), "{interval:?}");
    }
    let below =
        |index: Option<Interval>| index.is_some_and(|index| index.hi() < assessment.delta.lo());
    // Where torques lag the index at the port decides.
    let is_prompt = scene.latency.is_none();
    if assessment.exact == RuleAnswer::Pass && is_prompt {
        assert!(is_finite(scene) && below(assessment.alpha_coupled), "{assessment:?}");
    }
    if assessment.paper == RuleAnswer::Pass && is_prompt {
        let index =
            if assessment.rule == Rule::Exact { assessment.alpha } else { assessment.bound };
        assert!(is_finite(scene) && below(index), "{assessment:?}");
        // Without a coupling, the index at the port decides.
        let is_at_port = assessment.rule == Rule::Nonlinear && scene.coupling == Coupling::Rigid;
        let is_spring = matches!(scene.coupling, Coupling::Spring { .. });
        assert!(is_spring || is_at_port, "{assessment:?}");
    }
    let deciding = match assessment.rule {
        Rule::Exact => assessment.exact,
        Rule::Nonlinear => assessment.paper,
    };
    assert_eq!(assessment.outcome.is_ok(), deciding == RuleAnswer::Pass);
    if assessment.outcome.is_ok() {
        assert!(is_finite(scene));
        assert!(!is_prompt || below(assessment.deciding_index()), "{assessment:?}");
        let margin = assessment.margin(scene);
        let delta = assessment.delta.lo();
        // No margin is known behind a coupling where torques lag and a bound decides.
        let is_known =
            is_prompt || assessment.rule == Rule::Exact || scene.coupling == Coupling::Rigid;
        let is_within = margin.map_or(!is_known, |m| m >= 0.0 && m <= delta);
        assert!(is_within, "{margin:?} {assessment:?}");
    }
}

/// The whole answer, remedies, sentence and assumptions included.
fn answers(scene: &Scene, rng: &mut ChaCha8Rng) {
    let steps = Resolution {
        encoder: Some(floats::any(rng)),
        friction: Some(floats::any(rng)),
        ..Resolution::default()
    };
    let assumptions = Assumptions::of(scene, &assess_in(scene, Format::F32), &steps);
    assert!(assumptions.iter().all(|one| one.to_string().len() > 20));
    match certify(scene) {
        Ok(assessment) => assert!(assessment.outcome.is_ok()),
        Err(rejection) => {
            let sentence = rejection.to_string();
            assert!(sentence.starts_with("rejected: ") || sentence.starts_with("undecided: "));
            assert!(!rejection.reason().is_empty() && rejection.reason() != "ok");
            assert!(rejection.remedies().iter().all(|remedy| !remedy.to_string().is_empty()));
        }
    }
}

#[test]
fn every_scene_gets_a_consistent_answer() {
    let mut certified = 0;
    for seed in 0..10_000 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let scene = draw(&mut rng);
        let fixed = Format::Fixed { fraction_bits: rng.random_range(0..=32) };
        let format = [Format::F64, Format::F32, fixed][rng.random_range(0..3)];
        let judged = catch_unwind(move || {
            consistent(&scene, format);
            if seed % 10 == 0 {
                answers(&scene, &mut rng);
            }
        });
        assert!(judged.is_ok(), "seed {seed}, {format}: {scene:?}");
        certified += u32::from(assess_in(&scene, format).outcome.is_ok());
    }
    assert!(certified > 1000, "{certified}");
}

/// Nothing is calculated from numbers that are out of range: a delay that no integer of the
/// mathematics holds has a sentence, and assumptions beside it.
#[test]
fn a_delay_of_any_size_gets_an_answer() {
    for samples in [9, 1 << 31, usize::MAX] {
        let one = Rational::of(&[1.0], &[1.0]).expect("one coefficient");
        let environment =
            Environment::Rational(Rational { delay: samples, unit_zeros: samples, ..one });
        let scene = Scene {
            coupling: Coupling::Spring { stiffness: 44.0 },
            ..Scene::of(Device::damped(2.2e-5, 0.022), 0.001, environment)
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
