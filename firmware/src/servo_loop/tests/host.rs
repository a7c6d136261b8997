//! The torque of a host in the loop: what it gives in each state, and that a hand gets no more than the
//! budget.

use super::*;
use crate::certificate::Certified;
use crate::current::HeatStep;
use crate::dac::DacCode;
use crate::host::{BesideServo, HostTorque, Reported, Taken};
use crate::scene_type::Typed;
use crate::tuning;

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
/// Counts a tick of the device on its way there.
const APPROACH: i32 = 800;

/// N m for a code.
const STEP: f64 = 2.0 / DacCode::CODES_TO_FULL_SCALE as f64;

struct Run {
    bench: Bench<Rendered, f32, Latched>,
    reported: Reported,
    number: u16,
}

impl Run {
    /// A servo that is off.
    fn booted(board: Board) -> Self {
        let scene = *Rendered::certified().scene();
        let program = Program { scene, ..program(scene.environment) };
        let bench = Bench::boot(&program, board).unwrap();
        Self { bench, reported: Reported::default(), number: 0 }
    }

    /// The same with the device at [`FREE`].
    fn moved() -> Self {
        let mut run = Self::booted(Board::new());
        (FREE..=0).rev().step_by(APPROACH as usize).for_each(|count| run.bench.stand(count, 1));
        run
    }

    /// A servo that runs there.
    fn new() -> Self {
        let mut run = Self::moved();
        run.bench.requests.arm();
        run.bench.stand(FREE, 120);
        assert_eq!(run.bench.servo_loop.state(), State::Running);
        run
    }

    /// The servo with this budget, ready to be swapped in.
    fn set(&self, budget: HostTorque) -> PreparedServo<Rendered, f32, Latched> {
        let scene = *Rendered::certified().scene();
        let environment = Rendering::<f32>::with_budget(scene.environment, budget);
        let scene = Scene { environment, ..scene };
        let options = RenderingOptions::DEFAULT;
        tuning::prepare(&scene, &[], &test_scene::PADDLE, &options).unwrap().rendering
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
}

/// The rest is refused, not lost without a word.
#[test]
fn a_torque_beyond_the_hosts_largest_is_refused() {
    let mut run = Run::new();
    let mut tick = |torque| {
        run.send(torque, 0);
        let given = run.tick(FREE);
        let taken = run.report().unwrap();
        (given, f64::from(taken.torque), f64::from(taken.refused), taken.limit)
    };
    assert_eq!(tick(-1.75), (0.0, 0.0, 0.0, LimitReason::None));
    let (given, told, refused, limit) = tick(0.5);
    assert!((given + 0.5).abs() < STEP && (given - told).abs() < 1e-6, "{given} {told}");
    assert!((refused + 1.25).abs() < 2.0 * STEP, "{refused}");
    assert_eq!(limit, LimitReason::Torque);
    let (given, _, refused, limit) = tick(f32::MAX);
    assert!((given - 0.5).abs() < STEP, "{given}");
    assert_eq!((refused, limit), (0.0, LimitReason::None), "the largest is not beyond");
    let (_, _, refused, limit) = tick(0.0);
    assert!(refused > 1e5 && limit == LimitReason::Torque, "{refused}");
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
        let told = run.report().unwrap();
        assert_eq!(
            told.limit == LimitReason::Energy,
            frame.limit == LimitReason::Energy,
            "{told:?}"
        );
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
    run.bench.stand(FREE, 5);
    run.bench.requests.disarm();
    run.bench.stand(FREE, 90);
    assert_eq!(run.bench.servo_loop.state(), State::Disarmed);
    for _ in 0..20 {
        run.send(0.4, 0);
        assert_eq!(run.tick(FREE), 0.0);
    }
    let taken = run.report().unwrap();
    assert!(taken.torque == 0.0 && (taken.refused - 0.4).abs() < STEP as f32, "{taken:?}");
    assert_eq!(taken.limit, LimitReason::Ramp);
    let left = left_by_hand();
    // The torque fades in whole codes, whose steps are not all the same, and the cap is rounded down.
    let rounded = 0.01 * (HOST.energy - left) + 1e-4 * HOST.energy;
    assert!((left - rounded..=left + 1e-8).contains(&f64::from(taken.energy)), "{taken:?} {left}");
}

/// J left of the tank after the device stopped, and 0.4 N m were held in place and faded out in 81 ticks: lost are
/// the steps alone, of the torque and of what a count may hide where the torque rises; as the device stops, what it
/// may hide falls.
fn left_by_hand() -> f64 {
    let (period, torque, ticks) = (1e-3_f64, (0.4 / STEP).round() * STEP, 81.0);
    // A count that is read up to 1 us late takes these parts of the share for the lost steps of the
    // position, and for the steps of the torque.
    let late = 1e-6 / period;
    let eta = 2.0 * late.sqrt();
    let of_steps = (2.0 * late).sqrt();
    let main = HOST.damping / ((1.0 + eta) / (1.0 - eta) + of_steps);
    let held = torque * torque * period / (4.0 * main);
    let count = core::f64::consts::TAU / test_scene::PADDLE.counts_per_turn;
    let hidden = count * torque;
    HOST.energy - (1.0 + 1.0 / ticks) * held * late / of_steps - hidden
}

/// A stream begins before the servo is armed and never ends: its torque comes and goes as slowly as the limit of
/// the scene's torque, at a swap as fast.
#[test]
fn a_hand_feels_no_step_when_the_servo_is_armed_swapped_and_disarmed() {
    let mut run = Run::moved();
    run.bench.requests.arm();
    let mut torques = Vec::new();
    for tick in 0..600 {
        match tick {
            200 => _ = run.bench.requests.submit(run.set(HOST)),
            400 => _ = run.bench.requests.disarm(),
            _ => {}
        }
        run.send(0.3, 0);
        torques.push(run.tick(FREE));
    }
    let steps = |ticks: core::ops::Range<usize>| {
        torques[ticks].windows(2).map(|two| (two[1] - two[0]).abs()).fold(0.0, f64::max)
    };
    // A hundred ticks from zero to the largest torque, and ten at a swap.
    assert!(steps(0..190) <= 0.005 + STEP, "{torques:?}");
    assert!(steps(190..390) <= 0.05 + STEP, "{torques:?}");
    assert!(steps(390..600) <= 0.005 + STEP, "{torques:?}");
    let given = |torque: f64| (torque - 0.3).abs() < STEP;
    assert!(given(torques[150]) && given(torques[300]), "{torques:?}");
    assert!(torques[210..240].contains(&0.0));
    assert_eq!(run.bench.servo_loop.state(), State::Disarmed);
}

/// The amplifier of a reset that is no power-on may have given the energy just before.
#[test]
fn the_tank_is_full_after_a_power_on_alone() {
    for reset in ResetCause::ALL {
        let mut run = Run::booted(Board { reset, ..Board::new() });
        run.bench.stand(0, 20);
        run.send(0.4, 0);
        run.tick(0);
        let energy = run.report().unwrap().energy;
        let is_full = energy > 0.0499;
        assert!(is_full || energy < 0.01 * 0.05, "{reset}: {energy}");
        assert_eq!(is_full, reset == ResetCause::PowerOn, "{reset}");
    }
}

#[test]
fn a_budget_gives_no_energy_and_takes_what_it_has_no_room_for() {
    let mut run = Run::new();
    let mut energy = |budget| {
        let _ = run.bench.requests.submit(run.set(budget));
        run.bench.stand(FREE, 60);
        run.send(0.0, 0);
        run.tick(FREE);
        run.report().unwrap().energy
    };
    let before = energy(HOST);
    assert!((0.0499..=0.05).contains(&before), "{before}");
    let more = energy(HostTorque { energy: 0.2, damping: 0.002, torque: 0.1, ..HOST });
    assert!((0.0499..=0.05).contains(&more), "{more}");
    let less = energy(HostTorque { energy: 0.02, ..HOST });
    assert!((0.0199..=0.02).contains(&less), "{less}");
    let again = energy(HOST);
    assert!((0.0199..=0.02).contains(&again), "{again}");
    let fed = energy(HostTorque { power: 0.5, ..HOST });
    assert!((0.04..=0.05).contains(&fed), "{fed}");
}

/// A torque under way was paid at the price of the last budget, and of an amplifier that was just switched off no
/// torque is known.
#[test]
fn another_budget_waits_for_the_last_torque() {
    let mut run = Run::new();
    run.send(0.4, 0);
    run.bench.stand(FREE, 5);
    let waits = |run: &mut Run| {
        let number = run.bench.requests.submit(run.set(HOST)).ok().unwrap();
        let mut torques = Vec::new();
        while run.bench.requests.swapped() != number {
            run.send(0.4, 0);
            torques.push(run.tick(FREE));
        }
        torques
    };
    // The torque of a tick acts until the tick after the next begins.
    let torques = waits(&mut run);
    assert!(torques.len() > 5 && torques.ends_with(&[0.0, 0.0]), "{torques:?}");
    run.bench.stand(FREE, 60);
    run.bench.requests.disarm();
    while run.bench.servo_loop.state() != State::Disarmed {
        run.tick(FREE);
    }
    assert_eq!(waits(&mut run).len(), 10);
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

/// The work of an alignment is not the hand's: damping pays with it for no torque. A hand that moves the handle as
/// far fills the tank.
#[test]
fn an_alignment_fills_no_tank() {
    let level = |is_aligned: bool| {
        let reset = ResetCause::IndependentWatchdog;
        let mut run = Run::booted(Board { reset, alignment: Some(60), ..Board::new() });
        if is_aligned {
            run.bench.requests.align();
        }
        (0..=80).for_each(|tick| run.bench.stand(-300 * tick.min(50), 1));
        run.send(0.0, 0);
        run.tick(-300 * 50);
        run.report().unwrap().energy
    };
    let (by_hand, aligned) = (level(false), level(true));
    assert!(by_hand > 0.04 && aligned < 0.001, "{by_hand} {aligned}");
}

/// The scene keeps its torque until none of the host's is left; then it falls, too, and both come back.
#[test]
fn a_hot_bridge_lowers_the_host_before_the_scene() {
    const PRESSED: i32 = 1_800;
    let mut run = Run::booted(Board::new());
    (0..=PRESSED).step_by(300).for_each(|count| run.bench.stand(count, 1));
    run.bench.requests.arm();
    run.bench.stand(PRESSED, 120);
    let same = run.set(HOST);
    let ticks = |run: &mut Run, event, ticks, count| {
        let mut frames = Vec::new();
        for _ in 0..ticks {
            run.send(-0.4, 0);
            run.bench.board.output_event = event;
            frames.push(run.bench.tick(count));
        }
        (frames, run.report().unwrap())
    };
    let torque = |frame: &Frame| f64::from(frame.code.offset()) * STEP;
    let (frames, _) = ticks(&mut run, None, 5, PRESSED);
    assert!((torque(&frames[4]) + 1.4).abs() < STEP, "{frames:?}");
    // By a hundredth of 0.5 N m a tick, from the tick after the event on.
    let (frames, taken) = ticks(&mut run, Some(OutputEvent::Heat(HeatStep::Lower)), 79, PRESSED);
    for (tick, frame) in frames.iter().enumerate() {
        let left = 0.4 - 0.005 * tick as f64;
        // Both torques are whole codes.
        assert!((torque(frame) + 1.0 + left).abs() < 2.0 * STEP, "{tick}: {frame:?}");
        assert_eq!(frame.limit, LimitReason::Torque);
    }
    assert!(taken.torque.abs() < 0.012 && taken.refused < -0.38, "{taken:?}");
    assert_eq!(taken.limit, LimitReason::Heat);
    let (frames, _) = ticks(&mut run, Some(OutputEvent::Heat(HeatStep::Lower)), 21, PRESSED);
    assert_eq!(frames[20].limit, LimitReason::Heat);
    assert!((torque(&frames[20]) + 0.81).abs() < 0.02, "{frames:?}");
    for count in (-300..PRESSED).rev().step_by(300) {
        ticks(&mut run, None, 1, count);
    }
    // Another set does not cool it.
    let _ = run.bench.requests.submit(same);
    assert_eq!(ticks(&mut run, None, 60, -300).1.torque, 0.0);
    let (frames, taken) = ticks(&mut run, Some(OutputEvent::Heat(HeatStep::Raise)), 110, -300);
    assert!((torque(&frames[109]) + 0.4).abs() < STEP, "{frames:?}");
    assert_eq!(taken.refused, 0.0);
}

/// In both directions: a share that the scene does not leave over, and a scene that leaves less than the share.
#[test]
fn a_share_and_a_scene_that_leaves_less_are_refused() {
    use crate::certificate::Parameter;
    let certified = Rendered::certified();
    let judge = |budget, stiffness| {
        let scene = certified.scene();
        let environment = Rendering::<f32>::with_budget(scene.environment, budget);
        let scene = Scene { environment, ..*scene };
        let changes = [(Parameter::Stiffness, stiffness)];
        let options = RenderingOptions::DEFAULT;
        let prepared =
            tuning::prepare::<_, f32, Latched>(&scene, &changes, &test_scene::PADDLE, &options);
        let explained =
            tuning::explain::<_, f32, Latched>(&scene, &changes, &test_scene::PADDLE, &options);
        (prepared.map(|_| ()), explained.map_err(|error| error.to_string()))
    };
    assert_eq!(judge(HOST, 9.0), (Ok(()), Ok(())));
    let greedy = HostTorque { damping: 0.02, ..HOST };
    let timeless = HostTorque { timeout: 1e-3, ..HOST };
    let poor = HostTorque { energy: 1e-6, ..HOST };
    for (budget, stiffness, part) in [
        (HOST, 36.0, "below the margin of"),
        (greedy, 10.0, "below the margin of"),
        (timeless, 10.0, "two periods"),
        (HostTorque { timeout: 20.001, ..HOST }, 10.0, "at most 20 s"),
        (poor, 10.0, "must be above"),
        (HostTorque { torque: 1.5, ..HOST }, 10.0, "full scale"),
        (HostTorque { power: f64::NAN, ..HOST }, 10.0, "power"),
    ] {
        let (step, sentence) = judge(budget, stiffness);
        assert_eq!(step, Err(Step::Servo), "{budget:?}");
        let sentence = sentence.unwrap_err();
        assert!(sentence.contains(part), "{sentence}");
    }
}
