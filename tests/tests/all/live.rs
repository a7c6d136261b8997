//! The emulated board under host messages, impossible encoder motion, or a stopped processor.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock, Mutex};
use std::time::{Duration, Instant};

use analysis::emulator::Emulator;
use analysis::emulator::plant_thread::{PlantModel, PlantThread};
use analysis::link::{Address, Link, RequestResult};
use analysis::program::damper_wall;
use analysis::toolchain::{NumberFormat, Tools, prepare};
use haptic_servo::board::lockstep_protocol::{TickInput, TickOutput};
use haptic_servo::boot::Program;
use haptic_servo::certificate::Parameter;
use haptic_servo::fault::Fault;
use haptic_servo::reset::ResetCause;
use haptic_servo::servo::{RenderingOptions, Simultaneous};
use haptic_servo::servo_loop::{Options, State};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::debugger::Debugger;
use tests::replica::Replica;

static PROGRAM: LazyLock<PathBuf> = LazyLock::new(|| {
    prepare(Tools::CompilerAndEmulator, |step| eprintln!("{step}"))
        .unwrap_or_else(|error| panic!("{error}"))
        .build_scene("damper_wall", NumberFormat::F32)
        .unwrap_or_else(|error| panic!("{error}"))
});

const MID_SCALE: u16 = 2048;
/// Codes of the torque limit, 1 N m of 2 N m at full scale.
const LIMIT: f64 = 895.5;
/// Ticks in which the clamp opens.
const FADING: f64 = 100.0;
/// The most counts that the program's device moves in a tick: 100 rad/s, and an edge.
const LARGEST_STEP: u32 = 978;

/// What a tick of the board was.
type Tick = (TickInput, TickOutput);

/// A hand that goes in and out of the wall, with its past and its next actions.
#[derive(Clone, Default)]
struct Hand {
    count: Arc<Mutex<i32>>,
    next: Arc<Mutex<VecDeque<TickInput>>>,
    ticks: Arc<Mutex<Vec<Tick>>>,
    moves: bool,
}

impl PlantModel for Hand {
    fn next_input(&mut self) -> TickInput {
        if let Some(input) = self.next.lock().unwrap().pop_front() {
            *self.count.lock().unwrap() = input.count.cast_signed();
            return input;
        }
        let mut count = self.count.lock().unwrap();
        if self.moves {
            // Slowly in and out, by more than the torque limit lets the wall push.
            let tick = self.ticks.lock().unwrap().len() as f64;
            *count = (700.0 * (0.01 * tick).sin()) as i32;
        }
        TickInput { count: count.cast_unsigned(), missed: 0 }
    }

    fn observe(&mut self, input: TickInput, output: TickOutput) {
        self.ticks.lock().unwrap().push((input, output));
    }
}

impl Hand {
    fn last(&self) -> Option<TickOutput> {
        self.ticks.lock().unwrap().last().map(|(_, output)| *output)
    }

    /// Waits until the board shows the requested state.
    fn wait(&self, what: &str, is_so: impl Fn(&TickOutput) -> bool) {
        let patience = Instant::now() + Duration::from_secs(60);
        while !self.last().is_some_and(|output| is_so(&output)) {
            assert!(Instant::now() < patience, "{what} within a minute; {:?}", self.last());
            std::thread::sleep(Duration::from_micros(200));
        }
    }

    /// Does something to the board and gives the ticks from there on, this one and some more.
    fn provoke(&self, input: TickInput) -> Vec<Tick> {
        let before = self.ticks.lock().unwrap().len();
        self.next.lock().unwrap().push_back(input);
        while self.ticks.lock().unwrap().len() < before + 20 {
            std::thread::sleep(Duration::from_micros(200));
        }
        let ticks = self.ticks.lock().unwrap()[before..].to_vec();
        ticks.into_iter().skip_while(|(done, _)| *done != input).collect()
    }
}

/// A running board in a world with this hand.
fn board(hand: &Hand, mut emulator: Emulator) -> (PlantThread, Link) {
    emulator.arm_and_wait().unwrap();
    let world = PlantThread::start(emulator, hand.clone());
    let link = Link::open(&Address::Unix(world.port().to_owned())).unwrap();
    (world, link)
}

/// A device that is deep enough in the wall for a torque, at rest.
fn pressed() -> Hand {
    Hand { count: Arc::new(Mutex::new(300)), ..Hand::default() }
}

/// Whatever the host sends, in every tick the board gives what the certified sets ask for.
#[test]
fn every_code_is_that_of_the_sets_that_were_taken() {
    let mut emulator = Emulator::boot(&PROGRAM).unwrap();
    let program = Program {
        scene: damper_wall::SCENE,
        transducers: damper_wall::TRANSDUCERS,
        rendering: RenderingOptions::DEFAULT,
        options: Options::DEFAULT,
    };
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

    let hand = Hand { moves: true, ..Hand::default() };
    let world = PlantThread::start(emulator, hand.clone());
    let mut link = Link::open(&Address::Unix(world.port().to_owned())).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut taken = VecDeque::new();
    let mut refused = 0;
    for _ in 0..60 {
        let set = [
            (Parameter::Stiffness, random.random_range(1.0..44.0)),
            (Parameter::Damping, random.random_range(0.0..0.02)),
            (Parameter::Face, random.random_range(-0.01..0.01)),
        ];
        match link.set(set.into_iter().collect()).unwrap() {
            RequestResult::Done => taken.push_back(set),
            RequestResult::Refused(_) => refused += 1,
        }
        // One swap after the other, so that each begins with a fade.
        hand.wait("it runs again", |output| output.state == State::Running);
    }
    let status = link.status().unwrap();
    assert_eq!((status.missed, status.sets as usize), (0, taken.len()));
    world.end().unwrap().finish().unwrap();
    assert!(refused > 10 && taken.len() > 10, "{refused} refused, {} taken", taken.len());

    let mut last = State::Running;
    for (tick, (input, output)) in hand.ticks.lock().unwrap().iter().enumerate() {
        if output.state == State::FadingOut && last != State::FadingOut {
            replica.submit(&taken.pop_front().expect("a swap for each set"));
        }
        let expected = replica.tick(input.count.cast_signed());
        assert_eq!((output.code, output.state), expected, "tick {tick}");
        last = output.state;
    }
    assert!(taken.is_empty(), "{} sets never ran", taken.len());
}

/// However the device moves, there is no torque before arming; then the clamp opens step by step,
/// however large the wall's torque.
#[test]
fn the_board_boots_in_an_order_in_which_nothing_can_move() {
    let hand = Hand { count: Arc::new(Mutex::new(5000)), ..Hand::default() };
    let world = PlantThread::start(Emulator::boot(&PROGRAM).unwrap(), hand.clone());
    let off = TickOutput { code: MID_SCALE, amplifier: false, state: State::Disarmed };
    hand.wait("it has booted", |output| *output == off);
    // Where the device was is its zero: into the wall by as much as it goes in a tick, and again.
    for count in [5500, 6000] {
        let ticks = hand.provoke(TickInput { count, missed: 0 });
        assert!(ticks.iter().all(|(_, output)| *output == off), "{ticks:?}");
    }
    let mut link = Link::open(&Address::Unix(world.port().to_owned())).unwrap();
    assert_eq!(link.status().unwrap().reset, ResetCause::PowerOn);
    assert_eq!(link.arm().unwrap(), RequestResult::Done);
    hand.wait("it runs", |output| output.state == State::Running);
    let ticks = hand.ticks.lock().unwrap().clone();
    let armed = ticks.iter().skip_while(|(_, output)| *output == off).map(|(_, output)| output);
    for (tick, output) in armed.enumerate().take_while(|(_, output)| output.state != State::Running)
    {
        let torque = f64::from(MID_SCALE) - f64::from(output.code);
        let level = LIMIT / FADING * tick as f64;
        assert!((-0.01..=level + 0.51).contains(&torque), "tick {tick}: {torque} of {level}");
        assert_eq!((output.amplifier, output.state), (true, State::FadingIn));
        assert!((tick as f64) < FADING + 1.0, "tick {tick}");
    }
    assert!(hand.last().unwrap().code < MID_SCALE - 200, "{:?}", hand.last());
    world.end().unwrap().end().unwrap();
}

/// A fault takes the torque away in its own tick, stays until the servo is armed again, and says
/// what it was.
#[test]
fn a_jump_of_the_encoder_and_a_missed_tick_stop_the_motor_until_it_is_armed() {
    let hand = pressed();
    let (world, mut link) = board(&hand, Emulator::boot(&PROGRAM).unwrap());
    hand.wait("torque", |output| output.code < MID_SCALE - 100);
    // The first tick in the wall was a step of 300 counts, which a hand can do.
    let jumped = TickInput { count: 300 + LARGEST_STEP + 1, missed: 0 };
    let missed = TickInput { count: jumped.count, missed: 2 };
    for (input, fault) in [
        (jumped, Fault::EncoderJump { counts: LARGEST_STEP + 1, largest: LARGEST_STEP }),
        (missed, Fault::MissedTick { missed: 2, tolerated: 0 }),
    ] {
        let ticks = hand.provoke(input);
        assert!(!ticks.is_empty());
        let off = TickOutput { code: MID_SCALE, amplifier: false, state: State::Faulted };
        assert!(ticks.iter().all(|(_, output)| *output == off), "{ticks:?}");
        let status = link.status().unwrap();
        assert_eq!(status.fault.and_then(|fault| fault.fault()), Some(fault));
        assert_eq!(hand.last(), Some(off));
        assert_eq!(link.arm().unwrap(), RequestResult::Done);
        hand.wait("torque again", |output| {
            output.state == State::Running && output.amplifier && output.code < MID_SCALE - 100
        });
        assert_eq!(link.status().unwrap().fault, None);
    }
    // The largest step of a hand is not among them.
    let far = TickInput { count: jumped.count - LARGEST_STEP, missed: 0 };
    assert!(hand.provoke(far).iter().all(|(_, output)| output.state == State::Running));
    assert_eq!(link.disarm().unwrap(), RequestResult::Done);
    hand.wait("the amplifier is off", |output| !output.amplifier && output.code == MID_SCALE);
    world.end().unwrap().end().unwrap();
}

/// A processor that faults takes the torque away, remembers why through the reset, and does not arm
/// itself.
#[test]
fn a_fault_of_the_processor_is_remembered_through_the_reset() {
    let hand = pressed();
    let emulator = Emulator::boot_for_debugger(&PROGRAM).unwrap();
    let (world, link) = board(&hand, emulator);
    hand.wait("torque", |output| output.code < MID_SCALE - 100);
    drop(link);
    let before = hand.ticks.lock().unwrap().len();
    let mut debugger = Debugger::attach(&world.port().with_file_name("debugger")).unwrap();
    // An address at which nothing can be executed.
    debugger.jump(NOWHERE).unwrap();
    debugger.detach().unwrap();
    hand.wait("it has stopped", |output| !output.amplifier);
    let mut link = Link::open(&Address::Unix(world.port().to_owned())).unwrap();
    let remembered = link.previous_fault().expect("it remembers").fault.fault();
    assert!(
        matches!(remembered, Some(Fault::HardFault { address: NOWHERE, status }) if status != 0),
        "{remembered:?}"
    );
    let status = link.status().unwrap();
    assert_eq!(status.fault.and_then(|fault| fault.fault()), remembered);
    assert_eq!(status.reset, ResetCause::Software);
    let after = hand.ticks.lock().unwrap()[before..].to_vec();
    let stopped = after.iter().skip_while(|(_, output)| output.amplifier);
    assert!(stopped.clone().all(|(_, output)| !output.amplifier && output.code == MID_SCALE));
    assert_eq!(link.arm().unwrap(), RequestResult::Done);
    hand.wait("it runs again", |output| output.state == State::Running && output.amplifier);
    world.end().unwrap().end().unwrap();
}

/// The chip's reserved addresses, even as addresses of code are.
const NOWHERE: u32 = 0xe000_0000;
