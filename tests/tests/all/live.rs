//! The emulated board under host messages: whatever the host sends, in every tick the board gives what the
//! certified sets ask for.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use analysis::emulator::Emulator;
use analysis::emulator::plant_thread::{PlantModel, PlantThread};
use analysis::link::{Address, Link, RequestResult};
use analysis::program::{damper_wall, knob_modes};
use haptic_servo::board::lockstep_protocol::{TickInput, TickOutput};
use haptic_servo::boot::Program;
use haptic_servo::certificate::Parameter;
use haptic_servo::environment::KNOB_MODES;
use haptic_servo::servo::{RenderingOptions, Simultaneous, SupportsTiming};
use haptic_servo::servo_loop::{Options, State};
use haptic_servo::tuning::Tunable;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::replica::Replica;

use crate::toolchain::scene;

const MID_SCALE: u16 = 2048;

/// What a tick of the board was.
type Tick = (TickInput, TickOutput);

/// Changes of one set.
type Set = Vec<(Parameter, f64)>;

/// A hand that moves the device, and all that was put out so far.
#[derive(Clone)]
struct Hand {
    /// The count at each tick.
    path: fn(f64) -> f64,
    ticks: Arc<Mutex<Vec<Tick>>>,
}

impl PlantModel for Hand {
    fn next_input(&mut self) -> TickInput {
        let tick = self.ticks.lock().unwrap().len() as f64;
        TickInput { count: ((self.path)(tick) as i32).cast_unsigned(), missed: 0 }
    }

    fn observe(&mut self, input: TickInput, output: TickOutput) {
        self.ticks.lock().unwrap().push((input, output));
    }
}

impl Hand {
    fn wait_until_it_runs(&self) {
        let state = || self.ticks.lock().unwrap().last().map(|(_, output)| output.state);
        let patience = Instant::now() + Duration::from_secs(60);
        while state() != Some(State::Running) {
            assert!(Instant::now() < patience, "it runs within a minute; {:?}", state());
            std::thread::sleep(Duration::from_micros(200));
        }
    }
}

/// Sends sets to a program while a hand moves its device, and compares every tick with the host's. Gives the ticks
/// and how many sets were refused.
fn compare<E: Tunable<f32> + SupportsTiming<Simultaneous>>(
    name: &str,
    program: Program<E>,
    path: fn(f64) -> f64,
    sets: Vec<Set>,
) -> (Vec<Tick>, Vec<String>) {
    let mut emulator = Emulator::boot(&scene(name)).unwrap();
    let mut replica = Replica::<_, Simultaneous>::boot(program);
    let mut is_on = false;
    let mut engaged = Vec::new();
    emulator.arm_and_observe(|output| engaged.push(output)).unwrap();
    for output in engaged {
        // In the tick in which the board has taken the request.
        if output.amplifier && !is_on {
            replica.arm();
        }
        is_on = output.amplifier;
        assert_eq!(replica.tick(0), (output.code, output.state));
    }

    let hand = Hand { path, ticks: Arc::default() };
    let world = PlantThread::start(emulator, hand.clone());
    let mut link = Link::open(&Address::Unix(world.port().to_owned())).unwrap();
    let (mut taken, mut refused) = (VecDeque::new(), Vec::new());
    for set in sets {
        match link.set(set.iter().copied().collect()).unwrap() {
            RequestResult::Done => taken.push_back(set),
            RequestResult::Refused(sentence) => refused.push(sentence),
        }
        // One swap after the other, so that each begins with a fade.
        hand.wait_until_it_runs();
    }
    let status = link.status().unwrap();
    assert_eq!((status.missed, status.sets as usize), (0, taken.len()));
    world.end().unwrap().finish().unwrap();

    let mut last = State::Running;
    let ticks = hand.ticks.lock().unwrap().clone();
    for (tick, (input, output)) in ticks.iter().enumerate() {
        if output.state == State::FadingOut && last != State::FadingOut {
            replica.submit(&taken.pop_front().expect("a swap for each set"));
        }
        let expected = replica.tick(input.count.cast_signed());
        assert_eq!((output.code, output.state), expected, "tick {tick}");
        last = output.state;
    }
    assert!(taken.is_empty(), "{} sets never ran", taken.len());
    (ticks, refused)
}

/// Slowly in and out of a wall, by more than its torque limit lets it push.
#[test]
fn every_code_is_that_of_the_sets_that_were_taken() {
    let program = Program {
        scene: damper_wall::SCENE,
        transducers: damper_wall::TRANSDUCERS,
        rendering: RenderingOptions::DEFAULT,
        options: Options::DEFAULT,
    };
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut set = || {
        vec![
            (Parameter::Stiffness, random.random_range(1.0..44.0)),
            (Parameter::Damping, random.random_range(0.0..0.02)),
            (Parameter::Face, random.random_range(-0.01..0.01)),
        ]
    };
    let sets: Vec<_> = (0..60).map(|_| set()).collect();
    let path = |tick: f64| 700.0 * (0.01 * tick).sin();
    let (_, refused) = compare("damper_wall", program, path, sets);
    assert!((11..50).contains(&refused.len()), "{} refused", refused.len());
}

/// Each mode of a knob, under a hand that turns it to and fro through a third of a turn: no code is farther from the
/// code before than a fade and the hand account for.
#[test]
#[ignore = "builds for minutes"]
fn every_mode_is_selected_while_the_knob_turns() {
    // Through all of them, back, and to a mode that does not exist.
    let modes = (1..KNOB_MODES.len()).chain((0..KNOB_MODES.len()).rev()).chain([11]);
    let sets = modes.map(|mode| vec![(Parameter::Mode, mode as f64)]).collect();
    // At most 5 counts a tick, and from rest at zero.
    let path = |tick: f64| 10_000.0 - 10_000.0 * (5e-4 * tick).cos();
    let (ticks, refused) = compare("knob_modes", knob_modes::PROGRAM, path, sets);
    assert_eq!(refused, ["rejected: the mode is 11, and must be a whole number from 0 to 10"]);
    let codes: Vec<_> = ticks.iter().map(|(_, output)| i32::from(output.code)).collect();
    let step = codes.windows(2).map(|codes| (codes[1] - codes[0]).abs()).max();
    // A tenth of the torque limit's 895.5 codes, and an end stop in 6 counts.
    assert!(step <= Some(90 + 9), "a step of {step:?} codes");
    let torques = codes.iter().filter(|code| **code != i32::from(MID_SCALE)).count();
    assert!(torques > 100, "torque in {torques} ticks");
}
