//! The board's cycle on this machine, which has to do in every tick what the emulated board does.

use haptic_servo::board::sim_hardware::{SimHardware, SimIo};
use haptic_servo::boot::{Booted, Program, boot};
use haptic_servo::certificate::Parameter;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::RawCount;
use haptic_servo::servo::{OutputMode, PreparedServo, SupportsTiming};
use haptic_servo::servo_loop::{FrameQueue, Frames, Inbox, Mailbox, Requests, ServoLoop, State};
use haptic_servo::tuning::{self, Tunable};

/// Timer counts in a period.
const PERIOD: u32 = 1000;
/// Length of the frame queue, which is never read here.
const FRAMES: usize = 2;

/// The board's lines, as the test sets and reads them.
struct Board {
    count: i32,
    code: DacCode,
}

impl SimIo for Board {
    fn count(&mut self) -> RawCount {
        RawCount::from(self.count)
    }

    fn write(&mut self, code: DacCode) {
        self.code = code;
    }
}

/// A cycle in f32 on a board that is in time, in the mode `M`.
pub struct Replica<E: Tunable<f32>, M: 'static> {
    board: SimHardware<Board>,
    servo_loop: ServoLoop<E, f32, M>,
    requests: Requests<'static, PreparedServo<E, f32, M>>,
    inbox: Inbox<'static, PreparedServo<E, f32, M>>,
    frames: Frames<'static, FRAMES>,
    program: Program<E>,
}

impl<E: Tunable<f32> + SupportsTiming<M>, M: OutputMode> Replica<E, M> {
    /// Boots a program, whose scene is certified; it is off until it is armed.
    pub fn boot(program: Program<E>) -> Self {
        let lines = Board { count: 0, code: DacCode::MID_SCALE };
        let mut board = SimHardware::new(lines, PERIOD);
        // A replica for a test: its memory lives as long as the test.
        let (requests, inbox) = Box::leak(Box::new(Mailbox::new())).split();
        let (frames, _) = Box::leak(Box::new(FrameQueue::new())).split();
        let Booted { servo_loop, .. } =
            boot(&program, &mut board, &requests).expect("it is certified");
        Self { board, servo_loop, requests, inbox, frames, program }
    }

    /// Asks for it to be armed in the next tick.
    pub fn arm(&self) {
        self.requests.arm();
    }

    /// Hands a set over, to be swapped in from the next tick on.
    pub fn submit(&mut self, changes: &[(Parameter, f64)]) {
        let Program { scene, transducers, rendering, .. } = &self.program;
        let set = tuning::prepare(scene, changes, transducers, rendering).expect("it is certified");
        self.program.scene = set.scene;
        assert!(self.requests.submit(set.rendering).is_ok(), "one set at a time");
    }

    /// One tick: the code and the state.
    pub fn tick(&mut self, count: i32) -> (u16, State) {
        self.board.lines.count = count;
        self.servo_loop.run(&mut self.board, &mut self.inbox, &mut self.frames);
        assert_eq!(self.servo_loop.fault(), None);
        (self.board.lines.code.get(), self.servo_loop.state())
    }
}
