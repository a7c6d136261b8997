//! The torque of a host in the loop: what it gives in each state, and that a hand gets no more than the
//! budget.

use super::*;
use crate::certificate::Certified;
use crate::dac::DacCode;
use crate::host::{BesideServo, HostTorque, Reported, Taken};
use crate::scene_type::Typed;

const CERTIFIED: Certified<Scene> = Scene {
    torque_limit: Some(1.0),
    ..test_scene::scene(Wall::damped(10.0, 0.002, 1).behind(0.0).alone())
}
.certified();

const HOST: HostTorque =
    HostTorque { energy: 0.05, power: 0.0, damping: 0.004, torque: 0.5, timeout: 0.02 };

crate::scene_type!(Of: CERTIFIED, host: HOST);

type Rendered = Typed<Of>;
type Host = <Rendered as Rendering<f32>>::Host;

/// Counts of a device out of contact, where the scene has no torque.
const FREE: i32 = -20_000;

/// N m for a code.
const STEP: f64 = 2.0 / DacCode::CODES_TO_FULL_SCALE as f64;

struct Run {
    bench: Bench<Rendered, f32, Latched>,
    reported: Reported,
    number: u16,
}

impl Run {
    /// A servo that runs, with the device at [`FREE`].
    fn new() -> Self {
        let scene = *Rendered::certified().scene();
        let program = Program { scene, ..program(scene.environment) };
        let mut bench = Bench::boot(&program, Board::new()).unwrap();
        (FREE..=0).rev().step_by(800).for_each(|count| bench.stand(count, 1));
        bench.requests.arm();
        bench.stand(FREE, 120);
        assert_eq!(bench.servo_loop.state(), State::Running);
        Self { bench, reported: Reported::default(), number: 0 }
    }

    fn send(&mut self, torque: f32, ramp: u16) {
        self.number += 1;
        Host::send(self.bench.requests.host(), self.number, torque, ramp);
        self.bench.requests.host_alive();
    }

    /// A tick; the torque in N m of its code, to the step of the DAC.
    fn tick(&mut self, count: i32) -> f64 {
        f64::from(self.bench.tick(count).code.offset()) * STEP
    }

    fn report(&mut self) -> Option<Taken> {
        Host::report(self.bench.requests.host(), &mut self.reported)
    }
}

#[test]
fn a_torque_is_held_and_fades_when_it_is_stale() {
    let mut run = Run::new();
    run.send(0.3, 0);
    assert_eq!(run.tick(FREE), 0.0);
    let taken = run.report().unwrap();
    assert_eq!((taken.number, taken.count, taken.torque, taken.invalid), (1, FREE, 0.0, 0));
    assert!((0.0499..=0.05).contains(&taken.energy), "{taken:?}");
    assert!((run.tick(FREE) - 0.3).abs() < STEP);
    assert_eq!(run.report(), None);
    let torques: Vec<_> = (0..25).map(|_| run.tick(FREE)).collect();
    assert!(torques[..8].iter().all(|torque| (torque - 0.3).abs() < STEP), "{torques:?}");
    assert!(
        torques.is_sorted_by(|a, b| a >= b) && torques[20..].iter().all(|torque| *torque == 0.0)
    );
}

#[test]
fn a_torque_that_is_no_number_is_zero_and_reported() {
    let mut run = Run::new();
    for torque in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        run.send(torque, 0);
        run.tick(FREE);
        assert_eq!(run.tick(FREE), 0.0);
    }
    assert_eq!(run.report().unwrap().invalid, 3);
    run.send(-9.0, 0);
    run.tick(FREE);
    assert!((run.tick(FREE) + 0.5).abs() < STEP, "the host's largest");
}

/// The hand moves as it gets most from the torque that acts: that of the tick before.
#[test]
fn a_hand_gets_no_more_than_the_budget() {
    let mut run = Run::new();
    let radians = core::f64::consts::TAU / test_scene::PADDLE.counts_per_turn;
    let (mut count, mut acting) = (FREE, 0.0);
    let (mut got, mut rounded, mut refused) = (0.0, 0.0, 0);
    for _ in 0..400 {
        run.send(0.5, 0);
        let frame = run.bench.tick(count);
        refused += usize::from(frame.limit == LimitReason::Energy);
        let best = acting * 1e-3 / (2.0 * HOST.damping);
        let moved = (best / radians).round();
        count += moved as i32;
        let step = moved * radians;
        got += acting * step - HOST.damping * step * step / 1e-3;
        rounded += 0.5 * STEP * step.abs();
        acting = f64::from(frame.code.offset()) * STEP;
        if count > -100 {
            break;
        }
    }
    assert!(refused > 10, "{refused}");
    assert!(got <= HOST.energy + rounded, "{got} {rounded}");
    assert!(got >= 0.5 * HOST.energy, "{got}");
}

#[test]
fn a_servo_that_does_not_run_gives_no_torque_and_keeps_the_level() {
    let mut run = Run::new();
    run.send(0.4, 0);
    run.bench.stand(FREE, 2);
    run.bench.requests.disarm();
    run.tick(FREE);
    for _ in 0..20 {
        run.send(0.4, 0);
        assert_eq!(run.tick(FREE), 0.0);
    }
    let taken = run.report().unwrap();
    assert_eq!((taken.torque, taken.refused), (0.0, 0.4));
    let left = left_by_hand();
    // In each tick 16 roundoffs of the level are taken away.
    let leak = f64::from(taken.tick) * 16.0 * HOST.energy / f64::from(1 << 24);
    assert!((left - leak..=left).contains(&f64::from(taken.energy)), "{taken:?} {left} {leak}");
}

/// J left of the tank after a disarming while 0.4 N m were held: lost are the torque that acted when the
/// amplifier went off, the torque after it that never reached the motor, and the step from zero.
fn left_by_hand() -> f64 {
    let (period, torque) = (1e-3_f64, 0.4_f64);
    // A count that is read up to 1 us late takes these parts of the share for the lost steps of the
    // position, and for the steps of the torque.
    let late = 1e-6 / period;
    let eta = 2.0 * late.sqrt();
    let of_steps = (2.0 * late).sqrt();
    let main = HOST.damping / ((1.0 + eta) / (1.0 - eta) + of_steps);
    let held = torque * torque * period / (4.0 * main);
    let count = core::f64::consts::TAU / test_scene::PADDLE.counts_per_turn;
    let step = held * late / of_steps + 0.5 * count * torque;
    HOST.energy - 2.0 * held - step
}

/// After a fault nothing is known of the last torque, and a new arming does not fill the tank.
#[test]
fn a_fault_empties_the_tank() {
    let mut run = Run::new();
    run.send(0.4, 0);
    run.bench.stand(FREE, 3);
    run.tick(FREE + 5000);
    assert_eq!(run.bench.servo_loop.state(), State::Faulted);
    run.bench.stand(FREE + 5000, 30);
    run.bench.requests.arm();
    run.bench.stand(FREE + 5000, 120);
    assert_eq!(run.bench.servo_loop.state(), State::Running);
    run.send(0.4, 0);
    run.tick(FREE + 5000);
    assert_eq!(run.tick(FREE + 5000), 0.0);
    run.send(0.4, 0);
    run.tick(FREE + 5000);
    let taken = run.report().unwrap();
    assert!(taken.refused > 0.39 && taken.energy < 0.01, "{taken:?}");
}

#[test]
fn a_swap_fills_nothing_and_too_soft_a_margin_is_refused() {
    use crate::certificate::Parameter;
    use crate::tuning;
    let certified = Rendered::certified();
    let scene = certified.scene();
    let change = |value| {
        let options = RenderingOptions::DEFAULT;
        let changes = [(Parameter::Stiffness, value)];
        let prepared =
            tuning::prepare::<_, f32, Latched>(scene, &changes, &test_scene::PADDLE, &options);
        let explained =
            tuning::explain::<_, f32, Latched>(scene, &changes, &test_scene::PADDLE, &options);
        (prepared.map(|_| ()), explained.map_err(|error| error.to_string()))
    };
    assert_eq!(change(9.0), (Ok(()), Ok(())));
    let (step, sentence) = change(36.0);
    assert_eq!(step, Err(Step::Servo));
    assert!(sentence.unwrap_err().contains("below the margin of"));
}
