//! The program of several modes on the emulated board: each is selected over the wire while a hand turns the
//! knob.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use analysis::emulator::Emulator;
use analysis::emulator::plant_thread::{PlantModel, PlantThread};
use analysis::link::{Address, Link, RequestResult};
use analysis::program::knob_modes;
use analysis::toolchain::{NumberFormat, Tools, prepare};
use haptic_servo::board::lockstep_protocol::{TickInput, TickOutput};
use haptic_servo::certificate::Parameter;
use haptic_servo::environment::KNOB_MODES;
use haptic_servo::servo::Simultaneous;
use haptic_servo::servo_loop::State;
use tests::replica::Replica;

/// A hand that turns the knob to and fro through a third of a turn, and all that was put out so far.
#[derive(Clone, Default)]
struct Turning(Arc<Mutex<Vec<(TickInput, TickOutput)>>>);

impl PlantModel for Turning {
    fn next_input(&mut self) -> TickInput {
        let tick = self.0.lock().unwrap().len() as f64;
        // At most 5 counts a tick, and from rest at zero.
        let count = 10_000.0 - 10_000.0 * (5e-4 * tick).cos();
        TickInput { count: count as u32, missed: 0 }
    }

    fn observe(&mut self, input: TickInput, output: TickOutput) {
        self.0.lock().unwrap().push((input, output));
    }
}

impl Turning {
    fn state(&self) -> Option<State> {
        self.0.lock().unwrap().last().map(|(_, output)| output.state)
    }

    fn wait_until_it_runs(&self) {
        let patience = Instant::now() + Duration::from_secs(60);
        while self.state() != Some(State::Running) {
            assert!(Instant::now() < patience, "it runs within a minute; {:?}", self.state());
            std::thread::sleep(Duration::from_micros(200));
        }
    }
}

/// Whichever mode is selected, the board gives in every tick the code that the same modes give here, and no
/// code is farther from the one before than a fade and the hand account for.
#[test]
fn every_mode_is_selected_on_the_emulated_board() {
    let toolchain = prepare(Tools::CompilerAndEmulator, |step| eprintln!("{step}"));
    let toolchain = toolchain.unwrap_or_else(|error| panic!("{error}"));
    let program = toolchain.build_scene("knob_modes", NumberFormat::F32);
    let program = program.unwrap_or_else(|error| panic!("{error}"));
    let mut emulator = Emulator::boot(&program).unwrap();
    let mut replica = Replica::<_, Simultaneous>::boot(knob_modes::PROGRAM);
    let mut is_on = false;
    let mut armed = Vec::new();
    emulator.arm_and_observe(|output| armed.push(output)).unwrap();
    for output in armed {
        if output.amplifier && !is_on {
            replica.arm();
        }
        is_on = output.amplifier;
        assert_eq!(replica.tick(0), (output.code, output.state));
    }

    let hand = Turning::default();
    let world = PlantThread::start(emulator, hand.clone());
    let mut link = Link::open(&Address::Unix(world.port().to_owned())).unwrap();
    // Through all of them, back, and to a mode that does not exist.
    let modes: Vec<usize> = (1..KNOB_MODES.len()).chain((0..KNOB_MODES.len()).rev()).collect();
    for mode in &modes {
        let selecting = [(Parameter::Mode, *mode as f64)];
        let outcome = link.set(selecting.into_iter().collect()).unwrap();
        assert_eq!(outcome, RequestResult::Done, "mode {mode}");
        hand.wait_until_it_runs();
    }
    let none = [(Parameter::Mode, 11.0)].into_iter().collect();
    let RequestResult::Refused(sentence) = link.set(none).unwrap() else { panic!("there is none") };
    assert_eq!(sentence, "rejected: the mode is 11, and must be a whole number from 0 to 10");
    let status = link.status().unwrap();
    assert_eq!((status.missed, status.sets as usize), (0, modes.len()));
    world.end().unwrap().finish().unwrap();

    let mut next = modes.iter();
    let mut last = TickOutput { code: 2048, amplifier: true, state: State::Running };
    let mut torques = 0;
    for (tick, (input, output)) in hand.0.lock().unwrap().iter().enumerate() {
        if output.state == State::FadingOut && last.state != State::FadingOut {
            let mode = next.next().expect("a swap for each mode");
            replica.submit(&[(Parameter::Mode, *mode as f64)]);
        }
        let expected = replica.tick(input.count.cast_signed());
        assert_eq!((output.code, output.state), expected, "tick {tick}");
        let step = i32::from(output.code) - i32::from(last.code);
        // A tenth of the torque limit's 895.5 codes, and an end stop in 6 counts.
        assert!(step.abs() <= 90 + 9, "tick {tick}: a step of {step} codes");
        torques += usize::from(output.code != 2048);
        last = *output;
    }
    assert!(next.next().is_none(), "not every mode ran");
    assert!(torques > 100, "torque in {torques} ticks");
}
