use haptic_servo::certificate::{Certified, Rejection, certify_scene, timing_checked};
use haptic_servo::encoder::RawCount;
use haptic_servo::environment::{Environment, Wall};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Scene};
use haptic_servo::servo::{Latched, PreparedServo, RenderingOptions, Servo, Step, Transducers};
use haptic_servo::tuning;
use proptest::prelude::*;

use super::*;

type Pedal = Scene<ProgressiveSpring<1>>;

const PEDAL: Pedal = Scene {
    coupling: Coupling::Spring { stiffness: 44.0 },
    torque_limit: Some(1.0),
    ..Scene::of(
        Device::damped(2.2e-5, 0.022),
        0.001,
        ProgressiveSpring { soft: 4.0, stiff: 24.0, knee: 0.1 },
    )
};

const CERTIFIED: Certified<Pedal> = PEDAL.certified_as(PEDAL.environment.stated_at(0.001));

const TRANSDUCERS: Transducers = Transducers::of(61_440.0, 2.0);

const fn pedal(stiff: f64) -> Pedal {
    Scene { environment: ProgressiveSpring { stiff, ..PEDAL.environment }, ..PEDAL }
}

#[test]
fn the_certificate_is_about_what_the_type_states() {
    let bound = CERTIFIED.assessment().bound.unwrap();
    // K T / 2, with the rounding of the coefficients.
    assert!(bound.lo() > 0.012 && bound.hi() < 0.012_001, "{bound:?}");
    let again = certify_scene(PEDAL, Format::F64).unwrap();
    assert_eq!(again, CERTIFIED);
    // 44 N m/rad is the limit: K T / 2 = delta.
    assert!(certify_scene(pedal(43.99), Format::F64).is_ok());
    let refused = certify_scene(pedal(44.01), Format::F64).unwrap_err();
    assert!(matches!(refused, Rejection::Shortage { .. }), "{refused:?}");
    assert_eq!(
        refused.to_string(),
        "rejected: the environment needs alpha = 0.02200501025 N m s/rad of damping, not below the \
         delta = 0.022 N m s/rad that the device has"
    );
}

#[test]
fn what_is_no_spring_states_no_bound_and_is_refused() {
    let refused = certify_scene(pedal(-1.0), Format::F64).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "rejected: the stated index is NaN N m s/rad, and must be finite and not below 0"
    );
    // Its torque would be 0.4 N m everywhere: a motor, without any slope.
    let motor = [(Parameter::Stiffness, 0.0), (Parameter::Face, -0.1)];
    let options = RenderingOptions::DEFAULT;
    let refused = tuning::prepare::<_, f32, Latched>(&PEDAL, &motor, &TRANSDUCERS, &options);
    assert_eq!(refused.unwrap_err(), Step::Certificate);
}

#[test]
fn a_constant_that_states_too_little_is_found_out_when_a_servo_is_built() {
    let bound = StatedBound { index: 0.001, gain: 0.001 };
    let modest = StatedModel::Bounded { delay: 1, bound };
    let too_stiff = pedal(60.0);
    assert!(too_stiff.certify_as(modest).is_ok());
    assert_eq!(
        timing_checked::<_, Latched>(too_stiff, Format::F32).unwrap_err(),
        Step::Certificate
    );
    assert!(timing_checked::<_, Latched>(PEDAL, Format::F32).is_ok());
    let told = too_stiff.certified_as(modest).certified_in(Format::F32);
    assert!(!told.is_what_is_stated() && CERTIFIED.is_what_is_stated());
    assert!(Servo::<_, f32>::new(&told, &TRANSDUCERS).is_err());
    let timed = told.timing_checked::<Latched>();
    let options = RenderingOptions::DEFAULT;
    assert!(PreparedServo::<_, f32, Latched>::new(&timed, &TRANSDUCERS, &options).is_err());
}

/// As data a statement has no law: nothing is built of it.
#[test]
fn a_statement_alone_is_not_rendered() {
    let scene = *CERTIFIED.as_data();
    let certified = scene.certify().unwrap();
    let error = Servo::<_, f32>::new(&certified, &TRANSDUCERS).unwrap_err();
    assert_eq!(error, BuildError::LawElsewhere);
}

/// A spring without delay that says that it is late.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hasty;

impl NamedParameters for Hasty {
    fn value(&mut self, _: Parameter) -> Option<&mut f64> {
        None
    }
}

impl StatedEnvironment for Hasty {
    fn stated(&self, _: &LawContext) -> StatedModel {
        StatedModel::Bounded { delay: 1, bound: StatedBound { index: 0.001, gain: 0.02 } }
    }
}

impl Delayed for Hasty {}

impl<N: Number> Discretize<N> for Hasty {
    type Law = <Environment as Discretize<N>>::Law;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        Wall::spring(20.0, 0).alone().law(context)
    }
}

#[test]
fn a_law_that_is_not_late_is_not_latched() {
    let scene = PEDAL.in_environment(Hasty);
    let options = RenderingOptions::DEFAULT;
    let timed = timing_checked::<_, Latched>(scene, Format::F32).unwrap();
    let error = PreparedServo::<_, f32, Latched>::new(&timed, &TRANSDUCERS, &options).unwrap_err();
    assert_eq!(error, BuildError::NotLate);
}

#[test]
fn the_servo_renders_both_slopes_a_sample_late() {
    let mut servo: Servo<_, f64> = Servo::new(&CERTIFIED, &TRANSDUCERS).unwrap();
    for (angle, slope, from) in [(0.05, 4.0, 0.02), (0.14, 24.0, 0.115)] {
        let mut torque = |angle| {
            // Until the coupling's deflection has settled.
            (0..200).map(|_| servo.tick_at(angle).unwrap()).last().unwrap()
        };
        let (below, at) = (torque(from), torque(angle));
        // Behind the coupling the slope is s / (1 + s / K_vc).
        let coupled = slope / (1.0 + slope / 44.0);
        let felt = (at - below) / (angle - from);
        assert!((felt / coupled - 1.0).abs() < 1e-6, "{angle}: {felt} {coupled}");
    }
    let mut late: Servo<_, f32> = Servo::new(&CERTIFIED, &TRANSDUCERS).unwrap();
    assert_eq!(late.tick(RawCount::from(500_u32)).code.get(), 2048);
    assert!(late.tick(RawCount::from(500_u32)).code.get() < 2048);
}

#[test]
fn it_is_tuned_like_any_other() {
    let options = RenderingOptions::DEFAULT;
    let prepare = |changes: &[(Parameter, f64)]| {
        tuning::prepare::<_, f32, Latched>(&PEDAL, changes, &TRANSDUCERS, &options)
    };
    assert_eq!(
        tuning::parameters(&PEDAL).to_string(),
        "stiffness, face, coupling.stiffness, torque_limit"
    );
    let set = prepare(&[(Parameter::Stiffness, 30.0), (Parameter::Face, 0.2)]).unwrap();
    assert_eq!(set.scene.environment, ProgressiveSpring { soft: 4.0, stiff: 30.0, knee: 0.2 });
    assert!(set.margin.is_some_and(|margin| margin > 0.0));
    assert_eq!(prepare(&[(Parameter::Stiffness, 50.0)]).unwrap_err(), Step::Certificate);
    assert_eq!(prepare(&[(Parameter::Damping, 0.0)]).unwrap_err(), Step::Change);
}

/// The index that a spring states.
fn index<const DELAY: usize>(spring: ProgressiveSpring<DELAY>) -> f64 {
    match spring.stated_at(0.001) {
        StatedModel::Bounded { bound, .. } => bound.index,
        StatedModel::Linear(_) => panic!("a bound is stated"),
    }
}

/// Torques over a motion, one a tick, limited to a level.
fn torques<const DELAY: usize>(
    spring: ProgressiveSpring<DELAY>,
    positions: &[f64],
    level: f64,
) -> Vec<f64> {
    let context = Scene { coupling: Coupling::Rigid, ..PEDAL }.context();
    let mut law = <ProgressiveSpring<DELAY> as Discretize<f64>>::law(&spring, &context).unwrap();
    let tick = |x: &f64| {
        let Response::Held(torque) = law.evaluate(*x) else { panic!("it is late") };
        law.update(*x);
        torque.clamp(-level, level)
    };
    positions.iter().map(tick).collect()
}

/// Energy that a spring of the index `alpha` may not give: `sum F d + alpha / T sum d^2` over a motion
/// that begins and ends at rest at zero, where the spring has no energy.
fn least_energy<const DELAY: usize>(
    spring: ProgressiveSpring<DELAY>,
    positions: &[f64],
    level: f64,
) -> f64 {
    let index = index(spring);
    let torques = torques(spring, positions, level);
    let steps = positions.windows(2).map(|pair| pair[1] - pair[0]);
    steps.zip(&torques[1..]).map(|(step, torque)| step * (torque + index / 0.001 * step)).sum()
}

proptest! {
    // The statement is what the certificate rests on, and the only part of it that is not proved by the
    // firmware: random motions try to take more energy out than it allows.
    #[test]
    fn no_motion_takes_more_energy_out_than_is_stated(
        (soft, stiff, knee) in (0.0..30.0_f64, 0.0..60.0_f64, 0.0..0.2_f64),
        moves in prop::collection::vec((-0.3..0.3_f64, 1..5_usize), 2..30),
        level in prop_oneof![Just(1e9), 0.1..5.0_f64],
    ) {
        // Back and forth, ending at zero for longer than the delay.
        let mut positions = vec![0.0; 4];
        for (target, ticks) in moves {
            let from = positions[positions.len() - 1];
            positions.extend((1..=ticks).map(|i| from + (target - from) * i as f64 / ticks as f64));
        }
        positions.extend([0.0; 4]);
        let one = least_energy(ProgressiveSpring::<1> { soft, stiff, knee }, &positions, level);
        let two = least_energy(ProgressiveSpring::<2> { soft, stiff, knee }, &positions, level);
        prop_assert!(one > -1e-9 && two > -1e-9, "{} {}", one, two);
    }
}

/// The search above would find an index that is too small: a motion takes more than half of the stated index.
#[test]
fn a_smaller_index_is_disproved() {
    let spring = ProgressiveSpring::<1> { soft: 20.0, stiff: 20.0, knee: 0.1 };
    // The fastest motion that there is: back and forth, each tick.
    let mut positions = vec![0.0; 4];
    positions.extend((0..1000).map(|k| if k % 2 == 0 { 0.05 } else { -0.05 }));
    positions.extend([0.0; 4]);
    let torques = torques(spring, &positions, 1e9);
    let steps: Vec<f64> = positions.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let given: f64 = steps.iter().zip(&torques[1..]).map(|(step, torque)| step * torque).sum();
    let squares: f64 = steps.iter().map(|step| step * step).sum();
    let needed = -given / squares * 0.001;
    let stated = index(spring);
    assert!(needed > 0.99 * stated && needed < stated, "{needed} of {stated}");
}
