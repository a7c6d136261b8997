//! A board in memory only that records every access.

use super::*;
use crate::boot::{Booted, Program, Startup, boot};
use crate::current::{AlignmentError, PowerFault};
use crate::encoder::RawCount;
use crate::fault::FaultRecord;
use crate::reset::ResetCause;
use crate::servo::{Step, SupportsTiming};
use crate::tuning::Tunable;

/// Timer counts in a period of every board here.
pub const PERIOD: u32 = 1000;

/// An access to the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    Amplifier(bool),
    Write(u16),
    Zero,
    Guard,
    Feed,
}

/// What a board says that has no motor to be aligned.
pub const NO_MOTOR: Fault = Fault::Power(PowerFault::Alignment(AlignmentError::NotNeeded));

pub struct Board {
    pub events: Vec<Event>,
    pub count: i32,
    /// What the next tick finds; in time and without trouble again after it.
    pub passed: u32,
    pub elapsed: u32,
    pub output_event: Option<OutputEvent>,
    pub start_up_ticks: u32,
    /// Ticks that an alignment still takes; `None`: there is no motor for one.
    pub alignment: Option<u32>,
    pub stored: [u32; FaultRecord::WORDS],
    pub reset: ResetCause,
}

impl Board {
    pub fn new() -> Self {
        Self {
            events: Vec::new(),
            count: 0,
            passed: 1,
            elapsed: 300,
            start_up_ticks: 0,
            output_event: None,
            alignment: None,
            stored: FaultRecord::NOTHING,
            reset: ResetCause::PowerOn,
        }
    }

    /// Whether the amplifier is on; it is off out of reset.
    pub fn is_on(&self) -> bool {
        let switched = self.events.iter().rev().find_map(|event| match event {
            Event::Amplifier(on) => Some(*on),
            _ => None,
        });
        switched.unwrap_or(false)
    }

    /// The last written code; out of reset the DAC holds mid-scale.
    #[cfg(feature = "wire")]
    pub fn code(&self) -> DacCode {
        let written = self.events.iter().rev().find_map(|event| match event {
            Event::Write(code) => DacCode::new(*code).ok(),
            _ => None,
        });
        written.unwrap_or(DacCode::MID_SCALE)
    }

    /// The codes that were written, in order.
    pub fn codes(&self) -> Vec<i32> {
        let code = |event: &Event| match event {
            Event::Write(code) => Some(i32::from(*code)),
            _ => None,
        };
        self.events.iter().filter_map(code).collect()
    }
}

impl Hardware for Board {
    fn count(&mut self) -> RawCount {
        RawCount::from(self.count)
    }
    fn write(&mut self, code: DacCode) {
        self.events.push(Event::Write(code.get()));
    }
    fn amplifier(&mut self, on: bool) {
        self.events.push(Event::Amplifier(on));
    }
    fn start_up_ticks(&self) -> u32 {
        self.start_up_ticks
    }

    fn output_event(&mut self) -> Option<OutputEvent> {
        self.output_event.take()
    }
    fn align(&mut self) -> Result<(), Fault> {
        self.alignment.map(|_| ()).ok_or(NO_MOTOR)
    }
    fn is_aligning(&mut self) -> bool {
        self.alignment = self.alignment.map(|ticks| ticks.saturating_sub(1));
        self.alignment.is_some_and(|ticks| ticks > 0)
    }
    fn periods_since_last(&mut self) -> u32 {
        core::mem::replace(&mut self.passed, 1)
    }
    fn time_in_period(&mut self) -> u32 {
        core::mem::replace(&mut self.elapsed, 300)
    }
    fn feed_watchdog(&mut self) {
        self.events.push(Event::Feed);
    }
    fn store_fault(&mut self, record: &[u32; FaultRecord::WORDS]) {
        self.stored = *record;
    }
}

impl Startup for Board {
    fn zero_encoder(&mut self) {
        self.events.push(Event::Zero);
        self.count = 0;
    }
    fn start_watchdog(&mut self) {
        self.events.push(Event::Guard);
    }
    fn stored_fault(&mut self) -> [u32; FaultRecord::WORDS] {
        self.stored
    }
    fn reset_cause(&mut self) -> ResetCause {
        self.reset
    }
    fn period(&self) -> u32 {
        PERIOD
    }
}

/// A change of what the interrupt has published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    Armed,
    NotArmed(Fault),
    Aligning,
    NotAligning(Option<Fault>),
    Disarmed,
    Stopped(Fault),
    Applied,
}

/// What the interrupt had published at the last look.
#[derive(Default)]
struct Seen {
    arming: u32,
    alignment: u32,
    off: u32,
    is_stopped: bool,
    swapped: u32,
}

/// A board with its cycle, and both ends of its connection.
pub struct Bench<E: Rendering<N> + 'static, N: Number, M: 'static> {
    pub board: Board,
    pub servo_loop: ServoLoop<E, N, M>,
    pub inbox: Inbox<'static, PreparedServo<E, N, M>>,
    pub requests: Requests<'static, PreparedServo<E, N, M>>,
    pub frames: Frames<'static, 8>,
    pub seen: FrameReader<'static, 8>,
    pub reset: ResetCause,
    pub previous_fault: Option<FaultRecord>,
    pub arms_because: Option<Reason>,
    noticed: Seen,
}

impl<E: Tunable<N> + SupportsTiming<M>, N: Number, M: OutputMode> Bench<E, N, M> {
    /// Boots the board.
    pub fn boot(program: &Program<E>, mut board: Board) -> Result<Self, Step> {
        let (requests, inbox) = Box::leak(Box::new(Mailbox::new())).split();
        let (frames, seen) = Box::leak(Box::new(FrameQueue::<8>::new())).split();
        let Booted { servo_loop, reset, previous_fault, arms_because, .. } =
            boot(program, &mut board, &requests)?;
        Ok(Self {
            board,
            servo_loop,
            inbox,
            requests,
            frames,
            seen,
            reset,
            previous_fault,
            arms_because,
            noticed: Seen::default(),
        })
    }

    /// Boots the board and requests arming.
    pub fn armed(program: &Program<E>, board: Board) -> Result<Self, Step> {
        let bench = Self::boot(program, board)?;
        bench.requests.arm();
        Ok(bench)
    }

    /// One tick with the device at this count; gives its frame.
    pub fn tick(&mut self, count: i32) -> Frame {
        self.board.count = count;
        self.servo_loop.run(&mut self.board, &mut self.inbox, &mut self.frames);
        self.seen.take().expect("every tick leaves a frame")
    }

    /// Ticks with the device standing still.
    pub fn stand(&mut self, count: i32, ticks: usize) {
        for _ in 0..ticks {
            self.tick(count);
        }
    }

    /// What has changed since the last call.
    pub fn notices(&mut self) -> Vec<Notice> {
        let (seen, requests, mut notices) = (&mut self.noticed, &self.requests, Vec::new());
        if let Some((number, reply)) = requests.arming()
            && number != core::mem::replace(&mut seen.arming, number)
        {
            notices.push(match reply {
                Reply::Done => Notice::Armed,
                Reply::Fault(fault) => Notice::NotArmed(fault),
                Reply::Armed | Reply::Disarming => panic!("{reply:?}"),
            });
        }
        if let Some((number, reply)) = requests.alignment()
            && number != core::mem::replace(&mut seen.alignment, number)
        {
            notices.push(match reply {
                Reply::Done => Notice::Aligning,
                Reply::Fault(fault) => Notice::NotAligning(Some(fault)),
                Reply::Armed => Notice::NotAligning(None),
                Reply::Disarming => panic!("{reply:?}"),
            });
        }
        if requests.off() != core::mem::replace(&mut seen.off, requests.off()) {
            notices.push(Notice::Disarmed);
        }
        let is_stopped = self.servo_loop.state() == State::Faulted;
        if !core::mem::replace(&mut seen.is_stopped, is_stopped) && is_stopped {
            notices.extend(self.servo_loop.fault().map(Notice::Stopped));
        }
        if requests.swapped() != core::mem::replace(&mut seen.swapped, requests.swapped()) {
            notices.push(Notice::Applied);
        }
        notices
    }

    /// The status, a tick later.
    pub fn status(&mut self) -> Status {
        let requested = self.requests.request_status();
        self.tick(self.board.count);
        let (number, status) = self.requests.status().expect("an answer");
        assert_eq!(number, requested);
        status
    }
}
