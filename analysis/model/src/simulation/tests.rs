use haptic_servo::certificate::{
    Assumption, Assumptions, QuantizationBound, Resolution, assess, certify,
    passivity_for_anticogging,
};
use haptic_servo::environment::{Canceller, Coefficients, Environment, Parts, Rational, Wall};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, EncoderReading, Latency, Scene, TimeRange, Timing};
use haptic_servo::torque::LimitReason;

use std::f64::consts::TAU;

use super::method::Method;
use super::*;
use crate::device::{Hand, Motion};
use crate::disturbance::{Cogging, Sine, sine};
use crate::fixture::{STANDARD, on_paddle};
use crate::missed::Missed;

/// On a slower device than the paddle, without a coupling.
fn scene(environment: Environment) -> Scene {
    Scene::of(Device::damped(0.05, 0.5), 1e-3, environment)
}

fn paper(environment: Environment) -> Scene {
    on_paddle(environment, STANDARD)
}

fn moving(scene: &Scene, samples: usize, position: f64) -> Experiment {
    let start = Motion { position, velocity: 0.3 };
    Experiment { samples, start, ..Experiment::still(scene) }
}

fn furthest(is: &[f64], should: &[f64]) -> f64 {
    let size = should.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    is.iter().zip(should).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
}

/// The firmware's law tick by tick against the certificate's transfer function as one matrix.
#[test]
fn both_ways_of_running_a_linear_loop_agree() {
    let numerator = Coefficients::new(&[3.0, -2.5]).unwrap();
    let denominator = Coefficients::new(&[1.0, -0.9, 0.2]).unwrap();
    let environments = [
        Wall::spring(22.0, 1).alone(),
        Wall::damped(22.0, 0.01, 1).alone(),
        Wall::damped(22.0, 0.01, 0).alone(),
        Wall::damped(10.0, 0.008, 2).filtered(0.8).alone(),
        Canceller::to(0.001).alone(),
        Parts {
            canceller: Some(Canceller::to(0.01)),
            wall: Some(Wall::damped(5.0, 0.001, 1)),
            ..Parts::NONE
        }
        .sum(),
        Environment::Rational(Rational { numerator, denominator, delay: 1, unit_zeros: 1 }),
    ];
    for environment in environments {
        for hand_torque in [
            TorqueSignal::Free,
            TorqueSignal::Held(vec![0.01, -0.02, 0.03]),
            TorqueSignal::Sine { amplitude: 0.01, omega: 300.0, phase: 0.4 },
        ] {
            let mut experiment =
                Experiment { hand_torque, ..moving(&paper(environment), 500, 0.01) };
            let hand = Hand { inertia: 1e-5, damping: 0.001, stiffness: 0.3 };
            experiment.plant = experiment.plant.with_hand(hand);
            experiment.latency = 2e-4;
            assert!(experiment.is_linear());
            let fast = simulate(&experiment, Integration::default()).unwrap();
            let mut slow = Trajectory::of_length(500);
            let mut nonlinear = NonlinearLoop::new(&experiment, Integration::default()).unwrap();
            let (columns, limit, host) = slow.columns();
            nonlinear.fill(&experiment.hand_torque, columns, limit, host);
            assert!(
                linear(&experiment, &experiment.tick(Integration::default()).unwrap()).is_some()
            );
            assert!(furthest(&fast.position, &slow.position) < 1e-12, "{environment:?}");
            assert!(furthest(&fast.velocity, &slow.velocity) < 1e-12, "{environment:?}");
            assert!(furthest(&fast.torque, &slow.torque) < 1e-12, "{environment:?}");
        }
    }
}

#[test]
fn chunks_are_one_motion() {
    let hand_torque = TorqueSignal::Sine { amplitude: 0.01, omega: 300.0, phase: 0.4 };
    for limit in [None, Some(0.05)] {
        let mut scene = paper(Wall::damped(22.0, 0.01, 1).alone());
        scene.torque_limit = limit;
        let experiment =
            Experiment { hand_torque: hand_torque.clone(), ..moving(&scene, 30, 0.01) };
        let whole = simulate(&experiment, Integration::default()).unwrap();
        let mut simulator = Simulator::new(&experiment, Integration::default()).unwrap();
        let (mut parts, mut reasons) = (Vec::new(), Vec::new());
        for length in [1, 9, 20] {
            let mut part = Trajectory::of_length(length);
            simulator.fill(&mut part);
            parts.extend(part.position);
            reasons.extend(part.limit);
        }
        assert_eq!((parts, reasons), (whole.position, whole.limit));
    }
}

/// The last of so many ticks.
const fn every(count: u32) -> Missed {
    Missed::Every { count, length: 1 }
}

/// Mean square over the last quarter, over that of the first.
fn decay(experiment: &Experiment) -> f64 {
    let motion = simulate(experiment, Integration::default()).unwrap();
    let quarter = experiment.samples / 4;
    let power = |part: &[f64]| part.iter().map(|v| v * v).sum::<f64>();
    power(&motion.velocity[3 * quarter..]) / power(&motion.velocity[..quarter])
}

/// Theory, section 8, with m = 0.05, b = 0.5 and an undelayed rigid spring, whose limit without
/// missed ticks is 2 b / T = 1000.
#[test]
fn missed_ticks_need_the_longest_time_between_updates() {
    let spring = |stiffness| {
        let scene = scene(Wall::spring(stiffness, 0).alone());
        moving(&scene, 4000, 1e-3)
    };
    // The remaining damping, b - K T / 2, takes seconds.
    assert!(decay(&spring(950.0)) < 0.5);
    let missed = Missed::Random { fraction: 0.1, seed: 1 };
    assert!(decay(&Experiment { missed, ..spring(950.0) }) > 2.0);
    assert!(decay(&Experiment { missed: every(2), ..spring(475.0) }) < 0.5);
    assert!(decay(&Experiment { missed: every(2), ..spring(525.0) }) > 2.0);
}

/// A law of one position holds its torque with its reading; one with a damper does so only where its tick is left
/// out, which takes a longest time between updates.
#[test]
fn a_reading_that_fails_is_the_one_before_or_a_missed_tick() {
    const READING: EncoderReading = EncoderReading { dropped: 1, ..EncoderReading::IDEAL };
    let moves = |wall: Wall, worst_period, [missed, dropped]: [Missed; 2]| {
        let plain = scene(wall.alone());
        let timing = Timing { worst_period, ..plain.timing };
        let scene = Scene { timing, latency: plain.latency.read_by(&READING), ..plain };
        let experiment = Experiment { missed, dropped, ..moving(&scene, 500, 1e-3) };
        simulate(&experiment, Integration::default()).unwrap()
    };
    let (every, none) = (every(3), Missed::None);
    let (spring, damped) = (Wall::spring(100.0, 0), Wall::damped(100.0, 0.2, 0));
    let twice = Some(2.0 * scene(spring.alone()).timing.period);
    for (wall, worst, equal) in [(spring, None, true), (damped, None, false), (damped, twice, true)]
    {
        let [missed, dropped] = [[every, none], [none, every]].map(|laws| moves(wall, worst, laws));
        assert_eq!(missed.position == dropped.position, equal, "{wall:?} {worst:?}");
        let ran = dropped.limit.iter().all(|status| *status == TickStatus::UNLIMITED);
        assert_eq!(ran, worst.is_none());
    }
}

/// Two failed readings in a row, of which the scene allows one.
#[test]
fn more_failed_readings_than_allowed_are_a_fault() {
    const READING: EncoderReading = EncoderReading { dropped: 1, ..EncoderReading::IDEAL };
    let plain = scene(Wall::spring(100.0, 0).alone());
    let scene = Scene { latency: plain.latency.read_by(&READING), ..plain };
    let dropped = Missed::Random { fraction: 0.1, seed: 5 };
    let experiment = Experiment { dropped, ..moving(&scene, 1000, 1e-3) };
    let fails: Vec<_> = dropped.ticks().take(1000).collect();
    let second = fails.windows(2).position(|two| two == [true; 2]).unwrap() + 1;
    let motion = simulate(&experiment, Integration::default()).unwrap();
    assert_eq!(motion.samples(), second);
    let error = experiment.completed(second).unwrap_err().to_string();
    let expected = format!("encoder-reading: at sample {second}, at ");
    assert!(error.contains(&expected) && error.contains("`encoder.dropped` = 1"), "{error}");
}

/// Theory, sections 6 and 8, behind a coupling: the certificate's number for an encoder's step bounds the torque
/// error of that step, and as much friction lets the device rest. `linear` is the torque without steps at an
/// angle.
fn hums_and_rests(still: &Experiment, mut linear: impl FnMut(f64) -> f64) -> QuantizationBound {
    let steps = Resolution { encoder: still.encoder_step, ..Resolution::default() };
    let bound = QuantizationBound::of(&still.scene, Format::F64, &steps).unwrap();
    let run = |friction: f64| {
        simulate(&Experiment { friction, ..still.clone() }, Integration::default()).unwrap()
    };
    let moves = |motion: &Trajectory| {
        motion.velocity[motion.samples() - 500..].iter().any(|&velocity| velocity != 0.0)
    };
    let free = run(0.0);
    assert!(moves(&free), "{still:?}");
    // The encoder rounds down, which is to the nearest of half a step less.
    let half = 0.5 * still.encoder_step.unwrap();
    let errors = free.position.iter().zip(&free.torque).map(|(x, f)| (linear(x - half) - f).abs());
    let (off, hum) = (errors.fold(0.0, f64::max), bound.hum());
    assert!(off <= hum * (1.0 + 1e-6) && off > 0.05 * hum, "{off} {hum}");
    assert!(!moves(&run(hum)), "{still:?}");
    bound
}

#[test]
fn a_device_behind_an_encoder_hums_and_rests_as_the_certificate_says() {
    let scene = paper(Wall::damped(22.0, 0.01, 1).alone());
    let step = 1e-4;
    let still = Experiment { encoder_step: Some(step), ..moving(&scene, 3000, 0.02) };
    let (mut due, mut last) = (0.0, 0.0);
    let bound = hums_and_rests(&still, |x| {
        // One sample late.
        let torque = due;
        let x_e = x - torque / 44.0;
        due = 22.0 * x_e + 10.0 * (x_e - last);
        last = x_e;
        torque
    });
    // K x / (1 - r) adds up to 924 N m/rad (theory, section 6).
    assert!((bound.hum() / (0.5 * step * 924.0) - 1.0).abs() < 1e-9, "{bound:?}");
}

/// The same behind the coupling that remembers torques of a delay of 1.4 samples: its compliances count at
/// rest, too. A wall with a face is in contact in some ticks and not in others.
#[test]
fn a_device_behind_the_matched_coupling_hums_and_rests_as_the_certificate_says() {
    let (step, compliance) = (1e-4, 1e-3 / (2.0 * 0.022));
    for (stiffness, one_sided) in [(10.0, true), (18.0, false), (120.0, false)] {
        let spring = Wall::spring(stiffness, 0);
        let wall = if one_sided { spring.behind(0.0) } else { spring };
        let scene = Scene {
            coupling: Coupling::Matched,
            latency: Latency::delayed(1.4e-3),
            ..paper(wall.alone())
        };
        // Pressed against the wall with half a count of its torque more than a whole number.
        let push = 40.5 * step * stiffness / (1.0 + 2.4 * compliance * stiffness);
        let still = Experiment {
            encoder_step: Some(step),
            hand_torque: TorqueSignal::Held(vec![push; 4000]),
            ..moving(&scene, 4000, 0.0)
        };
        let mut past = [0.0; 2];
        let bound = hums_and_rests(&still, |x| {
            let x_e = x - compliance * (past[0] + 0.4 * past[1]);
            let line = stiffness * x_e / (1.0 + compliance * stiffness);
            let torque = if one_sided { line.max(0.0) } else { line };
            past = [torque, past[0]];
            torque
        });
        if one_sided {
            // Compliances of one sample, of a sample that has not acted yet, and of 0.4 of another.
            let most = 0.5 * step * stiffness / (1.0 - 2.4 * compliance * stiffness);
            assert!(bound.in_any_motion && (bound.hum() / most - 1.0).abs() < 1e-6, "{bound:?}");
        }
    }
}

/// Theory, section 8: with b < K T/2 friction and damping dissipate at least what the controller generates, up to
/// a mean speed. Beyond the speed of a sine with that property, motion grows.
#[test]
fn friction_dissipates_what_the_controller_generates_up_to_the_stated_speed() {
    for (stiffness, friction) in [(1400.0, 0.05), (1200.0, 0.02)] {
        let scene = scene(Wall::spring(stiffness, 0).alone());
        let steps = Resolution { friction: Some(friction), ..Resolution::default() };
        let assumptions = Assumptions::of(&scene, &assess(&scene), &steps);
        let speed = assumptions.iter().find_map(|one| match one {
            Assumption::FrictionOnly { speed, .. } => Some(*speed),
            _ => None,
        });
        let speed = speed.expect("it is short of damping");
        let should = friction / (0.5e-3 * stiffness - 0.5);
        assert!((speed / should - 1.0).abs() < 1e-9, "{speed} {should}");
        let later = |start: f64| {
            let start = Motion { position: 0.0, velocity: start };
            let experiment = Experiment { friction, start, ..moving(&scene, 400, 0.0) };
            let motion = simulate(&experiment, Integration::default()).unwrap();
            motion.velocity[300..].iter().fold(0.0_f64, |most, v| most.max(v.abs()))
        };
        assert!(later(speed) < speed);
        let sine = 4.0 / std::f64::consts::PI * speed;
        assert!(later(1.05 * sine) > 1.05 * sine);
    }
}

#[test]
fn torque_is_limited_before_the_coupling_is_solved() {
    let mut scene = paper(Wall::damped(22.0, 0.0, 0).alone());
    scene.torque_limit = Some(0.1);
    let motion = simulate(&moving(&scene, 50, 0.05), Integration::default()).unwrap();
    // K x / (1 + K / K_vc) would be 0.73.
    assert_eq!(motion.torque[0], 0.1);
    for (torque, status) in motion.torque.iter().zip(&motion.limit) {
        let limited = *status == TickStatus::Ran(LimitReason::Torque);
        assert!(torque.abs() < 0.1 || limited && torque.abs() == 0.1, "{torque} {status:?}");
    }
}

#[test]
fn the_record_says_which_ticks_were_missed_and_where_counts_ended() {
    let scene = paper(Wall::damped(22.0, 0.0, 0).alone());
    let missed = Experiment { missed: every(3), ..moving(&scene, 6, 0.01) };
    let motion = simulate(&missed, Integration::default()).unwrap();
    let (ran, not) = (TickStatus::UNLIMITED, TickStatus::Missed);
    assert_eq!(motion.limit, [ran, ran, not, ran, ran, not]);
    assert_eq!(motion.torque[2], motion.torque[1]);

    // 0.01 rad are more of these steps than 32 bits hold.
    let fine = Experiment { encoder_step: Some(1e-12), ..moving(&scene, 1, 0.01) };
    let motion = simulate(&fine, Integration::default()).unwrap();
    assert_eq!(motion.limit, [TickStatus::Ran(LimitReason::Angle)]);
    let behind = f64::from(i32::MAX) * 1e-12 * 22.0 / (1.0 + 22.0 / 44.0);
    assert!((motion.torque[0] - behind).abs() < 1e-12, "{}", motion.torque[0]);
}

#[test]
fn a_scene_without_a_law_is_refused() {
    let numerator = Coefficients::new(&[1.0, 0.0]).unwrap();
    let denominator = Coefficients::new(&[1.0]).unwrap();
    let rational = Rational { numerator, denominator, delay: 0, unit_zeros: 0 };
    let scene = paper(Environment::Rational(rational));
    let error = simulate(&moving(&scene, 10, 0.0), Integration::default()).unwrap_err();
    assert!(error.to_string().contains("future samples"), "{error}");
}

/// The differences between the loops in the tests of latency.
struct LateLoop {
    latency: Latency,
    matched: bool,
}

/// Steps of the independent integration in a tick: torques begin at one of them.
const FINE: usize = 400;

/// A spring of 30 N m/rad on a rigid device, by Runge and Kutta's rule over many parts of a tick, with the
/// formulas of theory, section 13, and nothing of this module. Positions at the samples.
fn integrated(case: &LateLoop, samples: usize, start: Motion) -> Vec<f64> {
    let (m, b, period, stiffness) = (2.2e-5, 0.022, 1e-3, 30.0);
    let Latency { output_delay, actuator_lag, sensor_lag, .. } = case.latency;
    let [delay, lag, filter] = [output_delay, actuator_lag, sensor_lag].map(|time| time.middle());
    let (whole, part) = ((delay / period) as usize, delay / period - (delay / period).floor());
    let h = period / FINE as f64;
    let updates = case.latency.actuator_updates as usize;
    // Where in a tick an update is: a reading may be older than one.
    let first = (delay / h).round() as usize;
    // Fraction of its error that an updated amplifier removes until the next update.
    let caught_up = 1.0 - (-period / (updates as f64 * lag)).exp();
    // States: position, velocity, torque of the amplifier, angle behind the filter. The command is a torque,
    // or the slope of an updated amplifier's torque.
    let rate = |s: [f64; 4], command: f64| {
        let torque = if lag > 0.0 { s[2] } else { command };
        let amplifier = match updates {
            0 if lag > 0.0 => (command - s[2]) / lag,
            0 => 0.0,
            // A slope.
            _ => command,
        };
        let sensor = if filter > 0.0 { (s[0] - s[3]) / filter } else { 0.0 };
        [s[1], (-b * s[1] - torque) / m, amplifier, sensor]
    };
    let plus = |s: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + by * k[i]);
    let mut state = [start.position, start.velocity, 0.0, start.position];
    let late = whole + 2;
    let (mut torques, mut positions, mut slope) = (vec![0.0; late], Vec::new(), 0.0);
    for _ in 0..samples {
        positions.push(state[0]);
        let read = if filter > 0.0 { state[3] } else { state[0] };
        let tap = if case.matched { period / (2.0 * b) } else { 0.0 };
        let before = |age: usize| torques[torques.len() - age];
        let held: f64 = (1..=whole).map(before).sum();
        let deflection = tap * (held + part * before(whole + 1));
        torques.push(stiffness * (read - deflection) / (1.0 + stiffness * tap));
        for step in 0..FINE {
            let age = if step as f64 + 0.5 < part * FINE as f64 { whole + 1 } else { whole };
            let mut command = torques[torques.len() - 1 - age];
            if let Some(between) = FINE.checked_div(updates) {
                if step % between == first % between {
                    slope = caught_up * (command - state[2]) * updates as f64 / period;
                }
                command = slope;
            }
            let k1 = rate(state, command);
            let k2 = rate(plus(state, k1, 0.5 * h), command);
            let k3 = rate(plus(state, k2, 0.5 * h), command);
            let k4 = rate(plus(state, k3, h), command);
            for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
                state = plus(state, k, weight * h / 6.0);
            }
        }
    }
    positions
}

/// An amplifier with that number of updates in a period, whose torque begins `late` updates after the count.
fn updated(updates: u16, late: f64) -> Latency {
    let latency = Latency::sampled(updates, 2e-4, 1e-3);
    let delay = late * 1e-3 / f64::from(updates);
    Latency { output_delay: TimeRange::exactly(delay), ..latency }
}

/// The same four times a period, read this long before an update.
fn aged(age: f64) -> Latency {
    let encoder = EncoderReading { age: TimeRange::exactly(age), ..EncoderReading::IDEAL };
    Latency::sampled(4, 4e-4, 1e-3).read_by(Box::leak(Box::new(encoder)))
}

fn late_loops() -> [LateLoop; 10] {
    let lag = TimeRange::exactly;
    [
        LateLoop { latency: Latency::delayed(2.5e-4), matched: false },
        LateLoop { latency: Latency::delayed(2e-3), matched: false },
        LateLoop { latency: Latency::delayed(1.3e-3).with_actuator_lag(4e-4), matched: false },
        LateLoop {
            latency: Latency {
                output_delay: TimeRange::between(2e-4, 8e-4),
                sensor_lag: lag(7e-4),
                ..Latency::NONE.with_actuator_lag(3e-4)
            },
            matched: false,
        },
        LateLoop { latency: Latency::delayed(1.3e-3), matched: true },
        LateLoop { latency: Latency::sampled(4, 3e-4, 1e-3), matched: false },
        LateLoop { latency: updated(8, 12.0), matched: false },
        LateLoop { latency: updated(5, 0.0), matched: false },
        LateLoop { latency: aged(6e-5), matched: false },
        // Older than the time between two updates.
        LateLoop { latency: aged(3.1e-4), matched: false },
    ]
}

#[test]
fn delays_lags_and_a_matched_coupling_move_as_many_small_steps_have_it() {
    for case in late_loops() {
        let mut late = paper(Wall::spring(30.0, 0).alone());
        late.latency = case.latency;
        late.coupling = if case.matched { Coupling::Matched } else { Coupling::Rigid };
        let experiment = moving(&late, 60, 0.01);
        let should = integrated(&case, 60, experiment.start);
        let motion = |experiment: &Experiment, method, substeps| {
            simulate(experiment, Integration { method, substeps }).unwrap().position
        };
        let exact = motion(&experiment, Method::Exact, 1);
        let within = |is: &[f64], bound: f64| {
            let off = furthest(is, &should);
            assert!(off < bound, "{off} {:?}", case.latency);
        };
        within(&exact, 1e-8);
        within(&motion(&experiment, Method::Rk4, 100), 1e-6);
        within(&motion(&experiment, Method::Tustin, 400), 1e-3);
        within(&motion(&experiment, Method::SemiImplicit, 4000), 1e-1);
        // As a loop that is not linear: a limit that is never reached, and hardly any friction.
        late.torque_limit = Some(1e9);
        let limited = moving(&late, 60, 0.01);
        assert!(!limited.is_linear());
        within(&motion(&limited, Method::Exact, 1), 1e-8);
        let rubbing = Experiment { friction: 1e-12, ..limited };
        within(&motion(&rubbing, Method::Exact, 1), 1e-6);
    }
}

/// The limit of a slow device is `b / (T/2 + all delays and lags)`, as without latency, and an
/// eigenvalue is on the circle there, also behind a matched coupling.
#[test]
fn stability_ends_where_an_eigenvalue_reaches_the_circle() {
    for case in late_loops() {
        let mut late = scene(Wall::spring(1.0, 1).alone());
        late.latency = case.latency;
        if case.matched {
            late.coupling = Coupling::Matched;
        }
        let experiment = Experiment::still(&late);
        let critical = crate::stability::critical_stiffness(&experiment, Integration::default());
        let critical = critical.unwrap().unwrap();
        let mut border = experiment.clone();
        border.scene.environment = Wall::spring(critical, 1).alone();
        let closed = crate::stability::closed_loop(&border, Integration::default()).unwrap();
        let radius =
            crate::stability::radius(&crate::stability::eigenvalues(&closed.matrix).unwrap());
        assert!((radius - 1.0).abs() < 1e-9, "{radius} {critical}");
        let Latency { output_delay, actuator_lag, sensor_lag, .. } = case.latency;
        let all = output_delay.middle() + actuator_lag.middle() + sensor_lag.middle();
        let should = 0.5 / (1.5e-3 + all);
        assert!(case.matched || (critical / should - 1.0).abs() < 0.03, "{critical} {should}");
    }
}

/// A gimbal motor at 10 kHz whose cogging the servo opposes, with nothing else to feel.
fn gimbal(cogging: Cogging, damping: f64, encoder: &'static EncoderReading) -> Scene {
    let learnt = cogging.learnt(2048).unwrap();
    Scene {
        latency: Latency::NONE.with_actuator_lag(8e-5).read_by(encoder),
        torque_limit: Some(0.1),
        ..Scene::of(
            Device::damped(3e-5, damping),
            1e-4,
            Wall::spring(0.0, 1).alone().beside(learnt),
        )
    }
}

const GIMBAL: Cogging = Cogging { harmonics: &[Sine { torque: 0.005, count: 84.0, phase: 0.0 }] };
const AGED: EncoderReading =
    EncoderReading { age: TimeRange::exactly(1e-5), ..EncoderReading::IDEAL };

/// At a slow speed `v` the torque over a turn is what the mean age of the torque and an encoder's count leave of the
/// cogging: up to `M (abar v + q)` (theory, section 18.6).
#[test]
fn a_slow_hand_feels_what_age_and_counts_leave_of_the_cogging() {
    const INERTIA: f64 = 1e-2;
    let scene = gimbal(GIMBAL, 0.0, &AGED);
    let (speed, step) = (1.0, TAU / 16384.0);
    // The velocity over a turn of a hand so heavy that it hardly changes.
    let bump = |share: f64, encoder_step| {
        let environment = match scene.environment.parts().anticogging {
            Some(learnt) => scene.environment.beside(learnt.sharing(share)),
            None => unreachable!(),
        };
        let scene = Scene { environment, ..scene };
        let mut experiment = Experiment {
            samples: (TAU / speed / 1e-4) as usize,
            start: Motion { position: 0.0, velocity: speed },
            cogging: GIMBAL,
            encoder_step,
            ..Experiment::still(&scene)
        };
        let hand = Hand { inertia: INERTIA - 3e-5, damping: 0.0, stiffness: 0.0 };
        experiment.plant = experiment.plant.with_hand(hand);
        let motion = simulate(&experiment, Integration::default()).unwrap();
        // Less the drift of its mean over a period of the cogging.
        let period = (TAU / GIMBAL.highest() / speed / 1e-4) as usize;
        let ripples = motion.velocity[1000..].windows(period).map(|window| {
            let least = window.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            window.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)) - least
        });
        // A sine of torque A at the rate N v is a ripple of 2 A / (J N v) of the velocity.
        0.5 * ripples.fold(0.0, f64::max) * INERTIA * GIMBAL.highest() * speed
    };
    let felt = bump(0.0, None);
    assert!((felt / GIMBAL.torque() - 1.0).abs() < 0.02, "{felt}");
    assert!((bump(0.5, None) / felt - 0.5).abs() < 0.02);
    let abar = 1e-4 + 1e-5 + 8e-5 + 0.5e-4;
    let left = GIMBAL.slope() * abar * speed;
    let compensated = bump(1.0, None);
    assert!((0.8..1.15).contains(&(compensated / left)), "{compensated} {left}");
    // An encoder rounds down: up to a count.
    let counted = bump(1.0, Some(step));
    assert!(counted < left + GIMBAL.slope() * step, "{counted} {left}");
    assert!(counted < 0.06 * felt, "{counted} {felt}");
}

/// Where the motor does not cog as the map says, the map is all that a hand feels: in a heavy hand that it swings,
/// it gains nothing on a device with what the certificate asks for, and it swings ever farther with less.
#[test]
fn no_hand_gains_energy_from_a_certified_map_and_one_does_from_less() {
    for (cogging, encoder) in
        [(GIMBAL, &AGED), (sine(0.03, 168.0), &AGED), (sine(0.015, 36.0), &EncoderReading::IDEAL)]
    {
        let needed =
            passivity_for_anticogging(&gimbal(cogging, 1.0, encoder), Format::F64).unwrap();
        let grows = |part: f64, inertia: f64, cogs: bool, stiffness: f64| {
            let scene = gimbal(cogging, part * needed, encoder);
            assert_eq!(certify(&scene).is_ok(), part > 1.0);
            // At the steepest place of the map where it pushes back: half a period from zero.
            let rest = 0.5 * cogging.pitch();
            let mut experiment = Experiment {
                samples: 300_000,
                start: Motion { position: rest + 0.002 * cogging.pitch(), velocity: 0.0 },
                cogging: if cogs { cogging } else { Cogging::default() },
                ..Experiment::still(&scene)
            };
            let hand = Hand { inertia, damping: 0.0, stiffness };
            experiment.plant = experiment.plant.with_hand(hand);
            let motion = simulate(&experiment, Integration::default()).unwrap();
            let swing = |part: &[f64]| {
                let least = part.iter().fold(f64::INFINITY, |a, b| a.min(*b));
                part.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)) - least
            };
            let tenth = motion.position.len() / 10;
            swing(&motion.position[9 * tenth..]) / swing(&motion.position[..tenth])
        };
        for inertia in [3e-5, 3e-4, 3e-3] {
            assert!(grows(1.0 / 0.98, inertia, false, 0.0) < 1.0, "{cogging:?} {inertia}");
            // Against the true cogging the hand's own spring swings.
            assert!(grows(1.0 / 0.98, inertia, true, 5.0) < 1.0, "{cogging:?} {inertia}");
        }
        assert!(grows(0.9, 3e-3, false, 0.0) > 1.0, "{cogging:?}");
    }
}
