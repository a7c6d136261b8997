//! Plays a sweep on a real device and tells the host what came of it, as the lines of a record that
//! `haptic identify` reads.
//!
//! The motor is driven open loop, so nothing is certified and nothing runs by itself: the letter
//! `g` on the serial port begins, and any other byte ends it.

use core::fmt::Write;
use core::sync::atomic::{AtomicBool, Ordering};

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use heapless::String;
use static_cell::StaticCell;

use super::registers::Registers;
use super::serial::Serial;
use super::start::{begin, connect, period, width};
use super::wiring::ENCODER;
use crate::board::link::Port;
use crate::board::place::Place;
use crate::boot::Startup;
use crate::cycle::{Frame, FrameQueue, FrameReader, FrameSink, Frames, Hardware, State};
use crate::dac::DacCode;
use crate::encoder::Position;
use crate::excitation::{Exciter, Sweep};
use crate::text::Written;
use crate::torque::LimitReason;

/// Where the sweep's interrupt finds what it works with.
pub type SweepPlace = Place<Player>;

/// Rows that may wait to be sent: 64 ms at 1 kHz.
const ROWS: usize = 64;
/// The byte that begins the sweep.
const BEGIN: u8 = b'g';

/// Whether the host wants the sweep to be played.
static WANTED: AtomicBool = AtomicBool::new(false);

/// What the sweep's interrupt works with.
pub struct Player {
    beginning: Exciter<'static>,
    exciter: Exciter<'static>,
    /// Samples of the sweep, and those that are still to come.
    samples: u64,
    left: u64,
    tick: u32,
    position: Position,
    /// What the converter has held since this tick's update.
    held: DacCode,
    hardware: Registers,
    rows: Frames<'static, ROWS>,
}

impl Player {
    /// One tick: the sweep's next sample while it is wanted, none while it is not.
    #[inline(always)]
    pub fn tick(&mut self) {
        let passed = self.hardware.passed();
        let count = self.position.update(self.hardware.count()).count;
        // A missed tick has held a torque for too long: what follows would not be the sweep.
        if self.left > 0 && (passed != 1 || !WANTED.load(Ordering::Relaxed)) {
            self.left = 0;
        }
        let playing = self.left > 0;
        let code = if playing { self.exciter.next().code } else { DacCode::MID_SCALE };
        self.hardware.write(code);
        self.hardware.amplifier(playing);
        if playing {
            self.tell(count);
            self.left -= 1;
            WANTED.store(self.left > 0, Ordering::Relaxed);
        } else if WANTED.load(Ordering::Relaxed) {
            (self.exciter, self.left, self.tick) = (self.beginning.clone(), self.samples, 0);
        }
        self.held = code;
        self.hardware.feed();
    }

    fn tell(&mut self, count: i32) {
        let (code, limit, state) = (self.held, LimitReason::None, State::Running);
        self.rows.push(Frame { tick: self.tick, count, code, limit, state, slack: 0 });
        self.tick = self.tick.wrapping_add(1);
    }
}

/// Waits for the host, and plays the sweep whenever it asks.
pub fn measure<const N: usize>(sweep: &'static Sweep<N>, place: &'static SweepPlace) -> ! {
    let mut serial = connect().serial;
    let mut hardware = Registers::new(period(sweep.period()));
    hardware.zero();
    defmt::info!("last reset: {=str}", hardware.reset_cause().as_str());
    static QUEUE: StaticCell<FrameQueue<ROWS>> = StaticCell::new();
    let (rows, mut told) = QUEUE.init_with(FrameQueue::new).split();
    let exciter = Exciter::new(sweep);
    hardware.guard();
    begin(&mut hardware);
    let player = Player {
        beginning: exciter.clone(),
        exciter,
        samples: sweep.ticks(),
        left: 0,
        tick: 0,
        position: Position::new(width(ENCODER)),
        held: DacCode::MID_SCALE,
        hardware,
        rows,
    };
    // SAFETY: the interrupt that uses the place is not enabled yet.
    unsafe { place.fill(player) };
    // SAFETY: its handler finds its place filled.
    unsafe { interrupt::TIM6_DAC.enable() };
    let step = sweep.full_scale_torque() / f64::from(DacCode::CODES_TO_FULL_SCALE);
    let mut writer = Writer { period: sweep.period(), step, row: String::new() };
    loop {
        listen(&mut serial);
        writer.send(&mut serial, &mut told);
        cortex_m::asm::wfi();
    }
}

/// What the host wants now.
fn listen(serial: &mut Serial) {
    let mut bytes = [0; 8];
    let count = serial.read(&mut bytes);
    if let Some(&last) = bytes.get(..count).and_then(<[u8]>::last) {
        WANTED.store(last == BEGIN, Ordering::Relaxed);
    }
}

/// Writes rows of the record.
struct Writer {
    period: f64,
    /// Torque of one code in N m.
    step: f64,
    /// What was not sent yet. The longest row, the heading with the first tick, has 60 bytes.
    row: String<64>,
}

impl Writer {
    /// Sends rows as long as there are any and the port takes them.
    fn send(&mut self, serial: &mut Serial, told: &mut FrameReader<'_, ROWS>) {
        loop {
            if self.row.is_empty() {
                let Some(frame) = told.take() else { return };
                self.write(&frame);
            }
            if serial.write(self.row.as_bytes()) == 0 {
                return;
            }
            self.row.clear();
        }
    }

    fn write(&mut self, frame: &Frame) {
        let heading = if frame.tick == 0 { "time,torque,counts\n" } else { "" };
        let time = Written(f64::from(frame.tick) * self.period);
        let torque = Written(f64::from(frame.code.offset()) * self.step);
        // It fits; what did not would be cut off.
        let _ = writeln!(self.row, "{heading}{time},{torque},{}", frame.count);
    }
}

/// The program of a sweep on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_sweep {
    ($sweep:ident) => {
        $crate::board_chip!();

        static PLACE: $crate::board::stm32::SweepPlace = $crate::board::place::Place::empty();

        $crate::board_tick!();

        #[cortex_m_rt::entry]
        fn main() -> ! {
            $crate::board::stm32::measure(&$sweep, &PLACE)
        }
    };
}
