//! More than 2^16 ticks of contact and of free motion: into the wall and out of it, turns that wrap the
//! encoder's counter, and parameters that are changed while it is felt.

use std::num::NonZeroU32;

use analysis::hand::HandTrajectory;
use analysis::link::Message;
use analysis::lockstep::SimulatedDevice;
use analysis::program::Program;
use haptic_servo::certificate::Parameter;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{Outcome, Status, ToBoard};
use virtual_board::chip::Chip;
use virtual_board::device::Device;

use crate::bench::{Bench, MID_SCALE, on_both};
use crate::device::{HandHeldDevice, Sample};

/// Samples of the servo in a round of use: a little more than half of 2^16.
const ROUND: u64 = 35_000;
/// Rounds, the second of which begins with what the first has left.
const ROUNDS: u64 = 2;

/// A device in a hand that does the same over and over; and once a round the encoder is spun away
/// from the wall and back, far enough for a counter of 16 bits to wrap.
struct Spun {
    hand: HandHeldDevice,
    /// Samples so far.
    sample: u64,
}

/// Counts of a spin a sample, and its samples each way: 1.6 turns, beyond 16 bits.
const SPEED: i32 = 500;
const WAY: u64 = 200;

impl Spun {
    fn of(program: &Program) -> Self {
        let trajectory =
            HandTrajectory::push_and_let_go().repeated_until((ROUND * (ROUNDS + 1)) as f64 * 1e-3);
        let (scene, transducers) = (&program.scene, &program.transducers);
        let device = SimulatedDevice::new(scene, trajectory, transducers).unwrap();
        Self { hand: HandHeldDevice::with(device), sample: 0 }
    }
}

impl Device for Spun {
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32 {
        let turned = self.hand.sample(code, amplifier);
        let spun = match self.sample % ROUND {
            at if at < WAY => -SPEED,
            at if at < 2 * WAY => SPEED,
            _ => 0,
        };
        self.sample += 1;
        turned + spun
    }
}

/// What the host has found out so far.
struct Use {
    bench: Bench,
    /// Sets that were answered as done.
    sets: u32,
    /// Ticks missing from the streams.
    gaps: u32,
    /// The last of them.
    last: Option<u32>,
}

impl Use {
    fn boot(chip: &'static Chip) -> Self {
        let program = Program::find("damper_wall").unwrap();
        let mut bench = Bench::boot(chip, program.name, Spun::of(program));
        // They would take much memory.
        bench.board_mut().events = None;
        bench.armed();
        Self { bench, sets: 0, gaps: 0, last: None }
    }

    /// Asks for another set, and holds the board to its answer.
    fn set(&mut self, changes: &[(Parameter, f64)], passes: bool) {
        let changes = changes.iter().copied().collect();
        let outcome = self.bench.request(|id| ToBoard::Set { id, changes });
        assert_eq!(outcome == Outcome::Done, passes, "{outcome:?}");
        self.sets += u32::from(passes);
    }

    /// Has every tick of some samples told.
    fn stream(&mut self, samples: u64) {
        self.bench.say(&ToBoard::Stream(NonZeroU32::new(1)));
        for _ in 0..samples {
            self.bench.run(1);
            self.hear();
        }
        self.bench.say(&ToBoard::Stream(None));
        self.bench.run(50);
        self.hear();
        self.last = None;
    }

    fn hear(&mut self) {
        for message in self.bench.hear() {
            let Message::Telemetry(batch) = message else { continue };
            for tick in batch.ticks() {
                if let Some(last) = self.last {
                    self.gaps += tick.tick - last - 1;
                }
                self.last = Some(tick.tick);
            }
        }
    }

    /// A round in which all of it happens.
    fn round(&mut self) {
        let end = self.bench.board().samples + ROUND;
        self.bench.run(2 * WAY + 100);
        self.set(&[(Parameter::Stiffness, 18.0)], true);
        self.bench.run(5000);
        self.set(&[(Parameter::Damping, 0.0115)], true);
        self.bench.run(5000);
        // Past the line: the certificate says no, and what runs goes on.
        self.set(&[(Parameter::Stiffness, 22.0)], false);
        self.stream(1000);
        self.set(&[(Parameter::Damping, 0.01), (Parameter::Stiffness, 22.0)], true);
        let left = end - self.bench.board().samples;
        self.bench.run(left);
    }

    /// What the board says at the end.
    fn check(&mut self, what: &str) {
        let status = self.bench.status();
        let Status { state, fault, missed, sets, dropped, thinned, .. } = status;
        assert_eq!((state, fault), (State::Running, None), "{what}");
        assert_eq!((missed, sets), (0, self.sets), "{what}");
        assert_eq!(self.gaps, dropped + thinned, "{what}: ticks that were not told");
        assert_eq!(status.discarded.total(), 0, "{what}: {:?}", status.discarded);
        let board = self.bench.board();
        assert_eq!(board.serial.lost(), 0, "{what}");
        // The answer is a few samples old.
        let late = board.samples - u64::from(status.tick);
        assert!(late < 20, "{what}: tick {} in sample {}", status.tick, board.samples);
        let mut pins = self.bench.pins();
        let then = pins.samples.len() - 1 - late as usize;
        assert_eq!(status.count, i64::from(pins.samples[then].count), "{what}");
        check_contact(&pins.samples, what);
        pins.samples.clear();
        drop(pins);
        assert_eq!(self.bench.machine.resets(), [], "{what}");
    }
}

/// The hand was in the wall, out of it, and where only the spin leads.
fn check_contact(samples: &[Sample], what: &str) {
    let share = |is: fn(&Sample) -> bool| {
        samples.iter().filter(|sample| is(sample)).count() as f64 / samples.len() as f64
    };
    let pushed = share(|sample| sample.code.is_some_and(|code| code + 50 < MID_SCALE));
    let free = share(|sample| sample.code == Some(MID_SCALE));
    assert!(pushed > 0.2 && free > 0.2, "{what}: {pushed} in the wall, {free} without torque");
    let furthest = samples.iter().map(|sample| sample.count).min().unwrap();
    assert!(furthest < -(1 << 16), "{what}: {furthest} counts");
}

#[test]
fn long_use_misses_no_tick_and_loses_no_count() {
    on_both(|chip| {
        let mut used = Use::boot(chip);
        for round in 0..ROUNDS {
            used.round();
            used.check(&format!("round {round}"));
        }
    });
}
