//! The exact method against trajectories of sixty digits over a thousand samples.
//!
//! The reference is written from the equations of motion and the environments' difference equations as
//! theory, section 5, has them, in fixed point of 240 places; it shares no code with the simulation, and its
//! inputs are the exact values of the floats that the simulation is given.

use crate::reference::{Matrix, Real, characteristic, exponential, image, modulus_of_root};
use analysis::chain::{Link, Mass};
use analysis::device::{Hand, Motion};
use analysis::simulation::plant::Plant;
use analysis::simulation::torque_signal::TorqueSignal;
use analysis::simulation::{Experiment, Integration, Trajectory, simulate};
use analysis::stability::{closed_loop, eigenvalues};
use haptic_servo::environment::{Canceller, Environment, Wall};
use haptic_servo::scene::{Coupling, Device, Scene};

const SAMPLES: usize = 1000;
const DEVICE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };
const PERIOD: f64 = 1e-3;

fn r(value: f64) -> Real {
    Real::of(value)
}

/// `A` and the columns of the motor's and the hand's torque, row by row.
type Rates = Vec<Vec<Real>>;

/// The plant over a tick with its inputs held: state, motor, hand.
fn tick(rates: &Rates, period: f64) -> Matrix {
    let size = rates[0].len();
    let mut generator: Matrix =
        rates.iter().map(|row| row.iter().map(|x| x * &r(period)).collect()).collect();
    generator.resize(size, vec![r(0.0); size]);
    exponential(&generator)
}

/// Mass and damper in a hand.
fn rigid(hand: Hand) -> Rates {
    let inertia = r(DEVICE.inertia) + r(hand.inertia);
    let damping = r(DEVICE.damping) + r(hand.damping);
    let per = |x: Real| x / inertia.clone();
    vec![
        vec![r(0.0), r(1.0), r(0.0), r(0.0)],
        vec![per(-r(hand.stiffness)), per(-damping), per(r(1.0)), per(r(1.0))],
    ]
}

/// Runs the loop: `servo` from the position to the coupling torque, `hand` from the sample to the
/// torque of the hand.
fn run(
    rates: &Rates,
    start: &[f64],
    mut servo: impl FnMut(&Real) -> Real,
    hand: impl Fn(usize) -> f64,
) -> Trajectory {
    let tick = tick(rates, PERIOD);
    let mut state: Vec<Real> = start.iter().map(|&x| r(x)).collect();
    let mut trajectory = Trajectory::of_length(0);
    for k in 0..SAMPLES {
        let torque = servo(&state[0]);
        trajectory.position.push(state[0].to_f64());
        trajectory.velocity.push(state[1].to_f64());
        trajectory.torque.push(torque.to_f64());
        state.truncate(rates.len());
        state.extend([-torque, r(hand(k))]);
        state = image(&tick, &state);
    }
    trajectory
}

fn experiment(environment: Environment, coupling: Option<f64>, start: Motion) -> Experiment {
    let coupling = coupling.map_or(Coupling::Rigid, |stiffness| Coupling::Spring { stiffness });
    let scene = Scene { coupling, ..Scene::of(DEVICE, PERIOD, environment) };
    Experiment { start, samples: SAMPLES, ..Experiment::still(&scene) }
}

/// Largest difference in each column, over the column's largest value.
fn compare(name: &str, experiment: &Experiment, reference: &Trajectory) {
    let found = simulate(experiment, Integration::default()).unwrap();
    for (column, is, should) in [
        ("position", &found.position, &reference.position),
        ("velocity", &found.velocity, &reference.velocity),
        ("torque", &found.torque, &reference.torque),
    ] {
        let size = should.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
        assert!(size > 0.0 && size.is_finite());
        let furthest = is.iter().zip(should).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("{name:<24} {column:<8} off by {:.1e} of {size:.3e}", furthest / size);
        assert!(furthest <= 1e-12 * size, "{name} {column}: {furthest} of {size}");
    }
}

/// Equation 24 behind a coupling: `F(k) = K x_E(k-1) + B (x_E(k-1) - x_E(k-2)) / T`.
fn delayed_wall(stiffness: f64, damping: f64, coupling: f64) -> impl FnMut(&Real) -> Real {
    let (mut due, mut last) = (r(0.0), r(0.0));
    move |x| {
        let torque = due.clone();
        let here = x.clone() - torque.clone() / r(coupling);
        due = r(stiffness) * here.clone() + r(damping) / r(PERIOD) * (here.clone() - last.clone());
        last = here;
        torque
    }
}

/// The paper's wall; the same in a hand that pushes; and a loop just past the line, whose motion must grow by
/// the right factor.
#[test]
fn walls() {
    let held = Hand { inertia: 1e-4, damping: 0.003, stiffness: 6.0 };
    let push: Vec<f64> = (0..700).map(|k| 0.05 * f64::from((k * 37) % 101) / 101.0).collect();
    let free = Hand::default();
    for (name, [stiffness, damping], hand, push, [position, velocity]) in [
        ("paper's wall", [22.0, 0.01], free, Vec::new(), [0.001, 0.0]),
        ("wall in a hand", [22.0, 0.01], held, push, [0.0, 0.0]),
        ("loop that grows", [50.0, 0.0], free, Vec::new(), [0.0, 0.1]),
    ] {
        let environment = Wall::damped(stiffness, damping, 1).alone();
        let mut experiment = experiment(environment, Some(44.0), Motion { position, velocity });
        experiment.plant = Plant::rigid(DEVICE).with_hand(hand);
        experiment.hand_torque = TorqueSignal::Held(push.clone());
        let at = |k: usize| push.get(k).copied().unwrap_or(0.0);
        let servo = delayed_wall(stiffness, damping, 44.0);
        compare(name, &experiment, &run(&rigid(hand), &[position, velocity], servo, at));
    }
}

/// Equation 23: `(3b - eps) F(k) = (b - eps) F(k-1) - (2 b be / T) (x_E(k) - x_E(k-1))`, solved
/// together with `x_E = x - F / K_vc`.
#[test]
fn free_mode() {
    let (residual, coupling) = (0.001, 44.0);
    let start = Motion { position: 0.2, velocity: -1.5 };
    let environment = Canceller::to(residual).alone();
    let be = r(DEVICE.damping) - r(residual);
    // Of any coupling: K T in place of 2 b.
    let kt = r(coupling) * r(PERIOD);
    let leading = kt + be.clone();
    let gain = -(be.clone() * r(coupling)) / leading.clone();
    let pole = be / leading;
    let (mut last_torque, mut last) = (r(0.0), r(0.0));
    let servo = |x: &Real| {
        let free = pole.clone() * last_torque.clone() + gain.clone() * (x.clone() - last.clone());
        let torque = free / (r(1.0) + gain.clone() / r(coupling));
        last = x.clone() - torque.clone() / r(coupling);
        last_torque = torque.clone();
        torque
    };
    let reference = run(&rigid(Hand::default()), &[0.2, -1.5], servo, |_| 0.0);
    compare("free mode", &experiment(environment, Some(coupling), start), &reference);
}

/// One-sided wall with a face and a torque limit: the coupling is solved with the limited torque.
#[test]
fn limited_wall_with_a_face() {
    let (stiffness, coupling, face, limit) = (18.0, 30.0, 0.0004, 0.1);
    let start = Motion { position: -0.02, velocity: 5.0 };
    let environment = Wall::spring(stiffness, 1).behind(face).alone();
    let mut experiment = experiment(environment, Some(coupling), start);
    experiment.scene.torque_limit = Some(limit);
    let hand = Hand { inertia: 3e-4, damping: 0.001, stiffness: 0.5 };
    experiment.plant = Plant::rigid(DEVICE).with_hand(hand);
    let mut due = r(0.0);
    let servo = |x: &Real| {
        let torque = due.clone().limited(&r(limit));
        let depth = x.clone() - torque.clone() / r(coupling) - r(face);
        due = if depth > r(0.0) { r(stiffness) * depth } else { r(0.0) };
        torque
    };
    let reference = run(&rigid(hand), &[-0.02, 5.0], servo, |_| 0.0);
    assert!(reference.torque.iter().any(|&torque| torque > 0.0));
    compare("limited wall", &experiment, &reference);
}

/// Two masses, an amplifier that lags, and a hand whose torque is a continuous sine.
#[test]
fn chain_with_lag_and_sine() {
    let masses = [Mass { inertia: 3e-5, damping: 0.02 }, Mass { inertia: 6e-5, damping: 0.004 }];
    let links = [Link { stiffness: 80.0, damping: 0.002 }];
    let hand = Hand { inertia: 1e-5, damping: 0.001, stiffness: 0.4 };
    let (lag, stiffness) = (2e-4, 9.0);
    let (amplitude, omega, phase) = (0.03, 411.0, 0.7);
    let environment = Wall::spring(stiffness, 0).alone();
    let mut experiment = experiment(environment, None, Motion::default());
    experiment.plant = Plant::chain(&masses, &links).with_hand(hand).with_actuator_lag(lag);
    experiment.hand_torque = TorqueSignal::Sine { amplitude, omega, phase };
    let last = r(masses[1].inertia) + r(hand.inertia);
    let (k, c) = (r(links[0].stiffness), r(links[0].damping));
    let first = r(masses[0].inertia);
    let over = |x: &Real, m: &Real| x.clone() / m.clone();
    // States: x1, v1, x2, v2, motor torque, hand's sine and cosine; then the motor's command. Each row has its
    // numbers that are not zero.
    let rows: [&[(usize, Real)]; 7] = [
        &[(1, r(1.0))],
        &[
            (0, over(&-k.clone(), &first)),
            (1, over(&-(c.clone() + r(masses[0].damping)), &first)),
            (2, over(&k, &first)),
            (3, over(&c, &first)),
            (4, over(&r(1.0), &first)),
        ],
        &[(3, r(1.0))],
        &[
            (0, over(&k, &last)),
            (1, over(&c, &last)),
            (2, over(&-(k.clone() + r(hand.stiffness)), &last)),
            (3, over(&-(c.clone() + r(masses[1].damping) + r(hand.damping)), &last)),
            (5, over(&r(1.0), &last)),
        ],
        &[(4, -r(1.0) / r(lag)), (7, r(1.0) / r(lag))],
        &[(6, r(omega))],
        &[(5, -r(omega))],
    ];
    let rates = rows.map(|row| {
        let mut full = vec![r(0.0); 8];
        row.iter().for_each(|(at, x)| full[*at] = x.clone());
        full
    });
    let rates = rates.to_vec();
    let tick = tick(&rates, PERIOD);
    let (s, c) = r(phase).sin_cos();
    let mut state = vec![r(0.0); 5];
    state.extend([r(amplitude) * s, r(amplitude) * c]);
    let mut reference = Trajectory::of_length(0);
    for _ in 0..SAMPLES {
        let torque = r(stiffness) * state[0].clone();
        reference.position.push(state[0].to_f64());
        reference.velocity.push(state[1].to_f64());
        reference.torque.push(torque.to_f64());
        state.truncate(7);
        state.push(-torque);
        state = image(&tick, &state);
    }
    compare("chain, lag and sine", &experiment, &reference);
}

/// The largest eigenvalue in `f64` against the root of the characteristic polynomial next to it.
#[test]
fn spectral_radius() {
    let light = Hand { inertia: 1e-6, damping: 0.0, stiffness: 3.0 };
    let heavy = Hand { inertia: 0.03, damping: 0.001, stiffness: 900.0 };
    for hand in [Hand::default(), light, heavy] {
        for (stiffness, damping, coupling) in [(22.0, 0.01, 44.0), (30.0, 0.004, 100.0)] {
            let matrix = closed_wall(&rigid(hand), [stiffness, damping, coupling]);
            let environment = Wall::damped(stiffness, damping, 1).alone();
            let mut experiment = experiment(environment, Some(coupling), Motion::default());
            experiment.plant = Plant::rigid(DEVICE).with_hand(hand);
            let closed = closed_loop(&experiment, Integration::default()).unwrap();
            let found = eigenvalues(&closed.matrix).unwrap();
            let largest = found.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap();
            let root = modulus_of_root(&characteristic(&matrix), (largest.re, largest.im));
            println!("{root} off by {:.1e}", largest.norm() - root);
            assert!((largest.norm() - root).abs() < 1e-12, "{largest} {root}");
        }
    }
}

/// Position, velocity, the torque that is due and the last `x_E` of equation 24 in closed loop.
fn closed_wall(rates: &Rates, [stiffness, damping, coupling]: [f64; 3]) -> Matrix {
    let tick = tick(rates, PERIOD);
    let zero = || r(0.0);
    let compliance = r(1.0) / r(coupling);
    let slope = r(damping) / r(PERIOD);
    let both = r(stiffness) + slope.clone();
    let moved = |row: usize| {
        vec![tick[row][0].clone(), tick[row][1].clone(), -tick[row][2].clone(), zero()]
    };
    vec![
        moved(0),
        moved(1),
        vec![both.clone(), zero(), -(both * compliance.clone()), -slope],
        vec![r(1.0), zero(), -compliance, zero()],
    ]
}
