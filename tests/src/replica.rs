//! The board's cycle on this machine, which has to do in every tick what the emulated board does.

use firmware::board::in_time::{InTime, Lines};
use firmware::boot::{Booted, Program, boot};
use firmware::certificate::Parameter;
use firmware::cycle::{Cycle, FrameQueue, Frames, Inbox, Mailbox, Notice, Requests, State};
use firmware::dac::DacCode;
use firmware::encoder::RawCount;
use firmware::servo::{OutputMode, Rendering, Renders};
use firmware::tuning::{self, Tunable};

/// Timer counts in a period.
const PERIOD: u32 = 1000;
/// Frames that the queue holds; nobody reads them here.
const FRAMES: usize = 2;

/// The board's lines, as the test sets and reads them.
struct Board {
    count: i32,
    code: DacCode,
}

impl Lines for Board {
    fn count(&mut self) -> RawCount {
        RawCount::from(self.count)
    }

    fn write(&mut self, code: DacCode) {
        self.code = code;
    }
}

/// A cycle in f32 on a board that is in time, in the mode `M`.
pub struct Replica<E: Tunable<f32>, M: 'static> {
    board: InTime<Board>,
    cycle: Cycle<E, f32, M>,
    requests: Requests<'static, Rendering<E, f32, M>>,
    inbox: Inbox<'static, Rendering<E, f32, M>>,
    frames: Frames<'static, FRAMES>,
    program: Program<E>,
}

impl<E: Tunable<f32> + Renders<M>, M: OutputMode> Replica<E, M> {
    /// Boots a program, whose scene is certified; it is off until it is armed.
    pub fn boot(program: Program<E>) -> Self {
        let lines = Board { count: 0, code: DacCode::MID_SCALE };
        let mut board = InTime::new(lines, PERIOD);
        // A replica for a test: its memory lives as long as the test.
        let (requests, inbox) = Box::leak(Box::new(Mailbox::new())).split();
        let (frames, _) = Box::leak(Box::new(FrameQueue::new())).split();
        let Booted { cycle, .. } = boot(&program, &mut board, &requests).expect("it is certified");
        Self { board, cycle, requests, inbox, frames, program }
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
        self.cycle.run(&mut self.board, &mut self.inbox, &mut self.frames);
        while let Some(notice) = self.requests.notice() {
            assert!(matches!(notice, Notice::Armed | Notice::Applied), "{notice:?}");
        }
        (self.board.lines.code.get(), self.cycle.state())
    }
}
