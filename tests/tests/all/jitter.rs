//! Torques and counts that deviate in time from tick to tick (theory, equation 56): limits and compliances to many
//! digits, computed independently, and what the conditions of linear scenes have to pass and to refuse.

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::environment::Wall;
use haptic_servo::matched::MatchedCoupling;
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange, Timing};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use tests::scenes::log_uniform;

/// Relative error of a limit or a compliance: rounding errors, and the room that the coupling has for them.
const TOLERANCE: f64 = 1e-11;
fn cases(group: &str) -> Vec<Value> {
    let all: Value = serde_json::from_str(include_str!("../../data/jitter.json")).expect("JSON");
    let all = all["cases"].as_array().expect("a list").clone();
    all.into_iter().filter(|case| case["group"] == group).collect()
}

fn number(value: &Value) -> f64 {
    match value {
        Value::String(digits) => digits.parse().expect("digits"),
        other => other.as_f64().expect("a number"),
    }
}

fn scene(case: &Value) -> Scene {
    let of = |key: &str| number(&case[key]);
    let exactly = |key: &str| TimeRange::exactly(of(key));
    let wall = &case["environment"];
    Scene {
        device: Device { inertia: 2.2e-5, damping: of("passivity"), passivity: None },
        timing: Timing { period: of("period"), worst_period: None },
        coupling: match case["coupling"].as_f64() {
            Some(stiffness) => Coupling::Spring { stiffness },
            None => Coupling::Matched,
        },
        environment: Wall::damped(
            number(&wall["stiffness"]),
            number(&wall["damping"]),
            wall["delay"].as_u64().unwrap() as usize,
        )
        .alone(),
        latency: Latency {
            output_delay: exactly("output_delay"),
            output_jitter: of("output_jitter"),
            actuator_lag: exactly("actuator_lag"),
            sensor_lag: exactly("sensor_lag"),
            ..Latency::NONE
        },
        torque_limit: Some(of("torque_limit")),
    }
}

fn linear(scene: &Scene) -> Scene {
    Scene { torque_limit: None, ..*scene }
}

fn coupling_of(scene: &Scene) -> Option<MatchedCoupling> {
    let Timing { period, worst_period } = scene.timing;
    let delta = scene.device.passivity();
    MatchedCoupling::of(period, worst_period, delta, &scene.latency, Format::F64)
}

fn is_near(found: f64, wanted: f64) -> bool {
    (found - wanted).abs() <= TOLERANCE * wanted.abs().max(1e-9)
}

/// The compliances of a coupling and of a coupling spring, `v_0` first: as many as a motion has left a trace
/// of.
fn compliances(scene: &Scene) -> Vec<f64> {
    if let Coupling::Spring { stiffness } = scene.coupling {
        return vec![1.0 / stiffness];
    }
    let coupling = coupling_of(scene).expect("a matched coupling");
    let mut taps = vec![coupling.compliance];
    taps.extend(std::iter::repeat_n(coupling.held, coupling.whole));
    taps.push(coupling.arriving);
    for later in 0..200 {
        let trail = |trail: &haptic_servo::matched::Trail| trail.gain * trail.decay.powi(later);
        taps.push(coupling.trails.iter().map(trail).sum());
    }
    while taps.last().is_some_and(|tap| tap.abs() < 1e-18 * taps[0]) {
        taps.pop();
    }
    taps
}

#[test]
fn limits_and_compliances_have_their_digits() {
    let cases = cases("limit");
    assert_eq!(cases.len(), 24);
    for case in &cases {
        let scene = scene(case);
        let posed = PassivityProblem::of(&scene).unwrap();
        let (limit, alpha) = (posed.paper_limit().unwrap(), posed.bound().unwrap());
        assert!(is_near(limit.midpoint(), number(&case["limit"])), "{limit:?} {case}");
        assert!(is_near(alpha.midpoint(), number(&case["alpha"])), "{alpha:?} {case}");
        assert_eq!(posed.is_certified(), case["certified"] == true, "{case}");
        let Some(wanted) = case["compliances"].as_array() else { continue };
        let found = compliances(&scene);
        for (i, wanted) in wanted.iter().map(number).enumerate() {
            let found = found.get(i).copied().unwrap_or(0.0);
            let error = (found - wanted).abs() / number(&case["compliances"][0]);
            assert!(error <= TOLERANCE, "{i}: {found} {case}");
        }
    }
}

/// Of two equal lags the rest of a step is `(1 + t / tau) exp(-t / tau)`, whose integral from a time on is
/// `(2 tau + t) exp(-t / tau)`. The coupling absorbs at least that, and its limit is little less than that of lags that
/// differ.
#[test]
fn equal_lags_are_absorbed() {
    const TAU: f64 = 0.5;
    let of = |sensor_lag: f64, format| {
        let latency = Latency { sensor_lag: TimeRange::exactly(sensor_lag), ..Latency::NONE }
            .with_actuator_lag(TAU);
        (
            latency.trails(),
            MatchedCoupling::of(1.0, None, 1.0, &latency, format).expect("a coupling"),
        )
    };
    // Times `T / (2 delta)`.
    let rest = |t: f64| 0.5 * (2.0 * TAU + t) * (-t / TAU).exp();
    let differ = of(0.99 * TAU, Format::F64).1.limit;
    for nearly in [0.0, 1e-15, -1e-9, 1e-5, -1e-4] {
        let (trails, coupling) = of(TAU * (1.0 + nearly), Format::F64);
        assert!(trails >= coupling.trails.iter().filter(|trail| trail.gain != 0.0).count());
        let limit = coupling.limit.lo() / differ.lo();
        assert!(limit > 0.999 && limit < 1.0, "{nearly}: {limit}");
        let absorbs = |m: i32| match m {
            0 => coupling.compliance,
            1 => coupling.arriving,
            _ => coupling.trails.iter().map(|trail| trail.gain * trail.decay.powi(m - 2)).sum(),
        };
        for m in 0..20 {
            let all: f64 = (m..200).map(absorbs).sum();
            // From the count on; before its torque begins all of a step is left.
            let exact = if m == 0 { 0.5 + rest(0.0) } else { rest(f64::from(m - 1)) };
            // No less, and no more than a thousandth of a tick's.
            let is_enough = all > exact * (1.0 - 1e-9);
            assert!(is_enough && all < exact + 1e-3, "{nearly}, {m}: {all} {exact}");
        }
        for format in [Format::F32, Format::Fixed { fraction_bits: 24 }] {
            let limit = of(TAU * (1.0 + nearly), format).1.limit.lo() / differ.lo();
            assert!(limit > 0.99, "{nearly} {format:?}: {limit}");
        }
    }
}

/// Loops of an independent computation that grow beyond their limit, and that do not below it.
#[test]
fn scenes_next_to_their_limit_are_judged_as_their_loops_behave() {
    for (group, count) in [("oscillates", 8), ("stable", 4)] {
        let cases = cases(group);
        assert_eq!(cases.len(), count);
        for case in &cases {
            let posed = PassivityProblem::of(&scene(case)).unwrap();
            assert_eq!(posed.is_certified(), case["certified"] == true, "{case}");
            let (limit, wanted) = (posed.paper_limit().unwrap().midpoint(), number(&case["limit"]));
            assert!((limit / wanted - 1.0).abs() < 1e-9, "{limit} {case}");
        }
    }
}

/// A limited scene with jitter at a part of its limit.
fn limited(rng: &mut ChaCha8Rng, part: f64) -> Option<Scene> {
    let period = log_uniform(rng, 1e-4, 4e-3);
    let delta = log_uniform(rng, 1e-3, 1.0);
    let share = [0.001, 0.01, 0.1, 0.3][rng.random_range(0..4)];
    let delay = [0.0, share, 0.4, 1.0, 1.3][rng.random_range(0..5)];
    let lag = [0.0, 0.0, 0.05, 0.6][rng.random_range(0..4)];
    let coupling = if rng.random_bool(0.7) {
        Coupling::Matched
    } else {
        Coupling::Spring { stiffness: 2.0 * delta / period / log_uniform(rng, 1.05, 16.0) }
    };
    let damping = if rng.random_bool(0.5) { 0.0 } else { delta * rng.random_range(0.0..0.3) };
    let (stiffness, whole) = (delta / period, rng.random_range(1..=2));
    let scene = |factor: f64| Scene {
        device: Device { inertia: 2.2e-5, damping: delta, passivity: None },
        timing: Timing { period, worst_period: None },
        coupling,
        environment: Wall::damped(factor * stiffness, factor * damping, whole).alone(),
        latency: Latency {
            output_jitter: share * period,
            ..Latency::delayed(delay * period).with_actuator_lag(lag * period)
        },
        torque_limit: Some(1.0),
    };
    let posed = PassivityProblem::of(&scene(1.0)).ok()?;
    let (bound, limit) = (posed.bound()?.hi(), posed.paper_limit()?.lo());
    Some(scene(part * limit / bound))
}

/// What equation 41 proves for every environment of an index, the conditions for linear scenes prove too.
#[test]
fn what_the_bound_allows_passes_at_the_port() {
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let mut judged = 0;
    while judged < 100 {
        let Some(mut scene) = limited(&mut rng, 0.9999) else { continue };
        if rng.random_bool(0.3) {
            let lag = scene.timing.period * rng.random_range(0.01..0.9);
            scene.latency.sensor_lag = TimeRange::exactly(lag);
        }
        if rng.random_bool(0.2) {
            let lag = scene.latency.actuator_lag.middle();
            scene.latency.actuator_lag = TimeRange::between(0.9 * lag, 1.1 * lag);
        }
        let posed = PassivityProblem::of(&linear(&scene)).unwrap();
        if posed.passes_paper() {
            assert!(posed.passes_exact(), "{scene:?}");
            let kept = posed.kept_responses::<Vec<_>>().unwrap();
            assert_eq!(posed.answer_with(&kept), posed.answer(), "{scene:?}");
            judged += 1;
        }
    }
}

/// Ticks of up to two periods, in which count and torque are missed together.
#[test]
fn missed_updates_behind_a_matched_coupling_have_their_limit() {
    for (delay, jitter, longest) in
        [(0.3, 0.0, 2.0), (0.3, 0.1, 1.5), (0.9, 0.001, 3.0), (0.6, 0.2, 2.0)]
    {
        let (period, delta) = (1e-3, 0.022);
        let scene = |stiffness: f64, torque_limit| Scene {
            device: Device { inertia: 2.2e-5, damping: delta, passivity: None },
            timing: Timing { period, worst_period: Some(longest * period) },
            coupling: Coupling::Matched,
            environment: Wall::spring(stiffness, 1).alone(),
            latency: Latency { output_jitter: jitter * period, ..Latency::delayed(delay * period) },
            torque_limit,
        };
        let limit = delta / (longest + 2.0 * jitter);
        let stiffest = 2.0 * limit / period;
        for limited in [None, Some(1.0)] {
            let passes = |part: f64| {
                PassivityProblem::of(&scene(part * stiffest, limited)).unwrap().is_certified()
            };
            assert!(passes(0.999) && !passes(1.001), "{delay} {jitter} {longest}");
        }
        let scene = scene(0.999 * stiffest, Some(1.0));
        // Not covered: a lag, and torques that may be latched a period after their counts.
        for latency in [scene.latency.with_actuator_lag(1e-5), Latency::delayed(0.0)] {
            let undecided = Scene { latency, ..scene };
            let posed = PassivityProblem::of(&undecided).unwrap();
            assert!(!posed.is_certified() && posed.paper_limit().is_none());
        }
    }
}
