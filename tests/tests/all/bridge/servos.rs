//! Servos for a [`Rig`](super::rig::Rig): as a board runs them, by counts, and without steps.

use haptic_servo::certificate::Certified;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::RawCount;
use haptic_servo::scene::Scene;
use haptic_servo::servo::{Latched, PreparedServo, RenderingOptions, Servo};
use haptic_servo::servo_loop::{Frame, FrameSink, Hardware, Mailbox, Options, ServoLoop, State};

use super::rig::{Codes, Machine, Torques};

/// Timer counts in a period, of a board whose ticks take no time.
const PERIOD: u32 = 1000;

/// A servo that gives a code for the instant of its count: that of a board's tick before.
pub fn counted(machine: &Machine, scene: &Certified<Scene>) -> Codes {
    let machine = *machine;
    let mut servo = Servo::<_, f32>::new(scene, &machine.transducers).unwrap();
    Box::new(move |angle| servo.tick(machine.count(angle)).code.offset())
}

/// The torque of a motor on a servo that knows its angles.
pub fn exact(machine: &Machine, scene: &Certified<Scene>) -> Torques {
    let mut servo = Servo::<_, f64>::new(scene, &machine.transducers).unwrap();
    Box::new(move |angle| -servo.tick_at(angle).unwrap())
}

/// Codes of a motor on a servo that knows its angles.
pub fn rounded(machine: &Machine, mut exact: Torques) -> Codes {
    let codes = f64::from(DacCode::CODES_TO_FULL_SCALE) / machine.transducers.full_scale_torque;
    Box::new(move |angle| (exact(angle) * codes).round() as i16)
}

/// What a board's interrupt runs, armed in its first tick. It puts a code out at the next count.
pub fn board(machine: &Machine, scene: &Certified<Scene>) -> Codes {
    let machine = *machine;
    let timed = (*scene).time::<Latched>().unwrap();
    let options = RenderingOptions::DEFAULT;
    let rendering = PreparedServo::<_, f32, Latched>::new(&timed, &machine.transducers, &options);
    let mut servo_loop = ServoLoop::new(rendering.unwrap(), &Options::DEFAULT, PERIOD, None);
    let (requests, mut inbox) = Box::leak(Box::new(Mailbox::new())).split();
    requests.arm();
    let mut board = Board { count: RawCount::from(0_u32), code: DacCode::MID_SCALE };
    Box::new(move |angle| {
        let latched = board.code.offset();
        board.count = machine.count(angle);
        servo_loop.run(&mut board, &mut inbox, &mut NoFrames);
        assert_ne!(servo_loop.state(), State::Faulted, "{:?}", servo_loop.fault());
        latched
    })
}

struct Board {
    count: RawCount,
    code: DacCode,
}

impl Hardware for Board {
    fn count(&mut self) -> RawCount {
        self.count
    }

    fn write(&mut self, code: DacCode) {
        self.code = code;
    }

    fn amplifier(&mut self, _on: bool) {}

    fn periods_since_last(&mut self) -> u32 {
        1
    }

    fn time_in_period(&mut self) -> u32 {
        0
    }

    fn feed_watchdog(&mut self) {}
}

struct NoFrames;

impl FrameSink for NoFrames {
    fn push(&mut self, _frame: Frame) {}

    fn dropped(&self) -> u32 {
        0
    }
}
