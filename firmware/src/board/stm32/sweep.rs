//! Plays a sweep on a real device and sends the measurement to the host as lines of text.
//!
//! The motor is driven open loop, so nothing is certified and nothing starts by itself: the host begins the
//! sweep, keeps it alive and ends it by requests with a checksum ([`SweepRequest`]). The sweep also ends at
//! bytes that are no request, and if the device moves farther or faster than its limits.

use core::fmt::Write;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::interrupt::InterruptExt;
use heapless::String;
use static_cell::StaticCell;

use super::output;
use super::registers::Registers;
use super::serial::Serial;
use super::start::{EncoderSetup, TICK, init_chip, registers};
use crate::board::ProgramMode;
use crate::board::isr_cell::IsrCell;
use crate::boot::Startup;
use crate::current::TorqueSource;
use crate::dac::DacCode;
use crate::encoder::{CounterWidth, Position};
use crate::excitation::{Exciter, Guard, MotionLimits, SILENCE, SWEEP_PROTOCOL, Sweep, SweepEnd};
use crate::output_timing::OutputMode;
use crate::servo::Transducers;
use crate::servo_loop::{Frame, FrameQueue, FrameReader, FrameSink, Frames, Hardware, State};
use crate::text::ShortF64;
use crate::torque::LimitReason;
use crate::wire::Port;
use crate::wire::sweep::{SweepReceiver, SweepRequest};

/// The state of the sweep's interrupt.
pub type SweepCell<const FROZEN: u32> = IsrCell<SweepIsr<FROZEN>>;

/// Transducers and limits of a sweep.
pub struct Setup {
    /// The transducers that the sweep was planned for.
    pub transducers: Transducers,
    /// The limits of the device's motion.
    pub limits: MotionLimits,
    /// The limits in counts.
    pub guard: Guard,
    /// The encoder's data: a reading that fails ends the sweep.
    pub encoder: EncoderSetup,
    /// The output's data of the program.
    pub output: output::Setup,
}

/// Capacity for rows to be sent: 64 ms at 1 kHz.
const ROWS: usize = 64;
/// Bytes of the longest line: the description, with fourteen numbers of at most 17 bytes.
const LINE: usize = 256;

/// Whether the host has requested a sweep.
static BEGIN: AtomicBool = AtomicBool::new(false);
/// Whether the host has requested the end of the running sweep.
static STOP: AtomicBool = AtomicBool::new(false);
/// Ticks until the host counts as lost.
static LISTENING: AtomicU32 = AtomicU32::new(0);
/// The end of the last sweep, as its number plus one; 0 after it has been sent.
static ENDED: AtomicU32 = AtomicU32::new(0);

/// The state of the sweep's interrupt.
pub struct SweepIsr<const FROZEN: u32> {
    beginning: Exciter<'static>,
    exciter: Exciter<'static>,
    /// Samples of the sweep, and the remaining samples.
    samples: u64,
    left: u64,
    /// Ticks until the torque output follows the code, without those of the alignment of a brushless motor.
    starting: u32,
    guard: Guard,
    tick: u32,
    position: Position,
    /// The position at the sweep's beginning, and in the last tick.
    start: i32,
    last: i32,
    /// The DAC's code since this tick's update.
    held: DacCode,
    /// The board's registers.
    pub hardware: Registers<FROZEN>,
    rows: Frames<'static, ROWS>,
    /// Rows dropped before the sweep's beginning.
    dropped: u32,
}

impl<const FROZEN: u32> SweepIsr<FROZEN> {
    /// One tick: the sweep's next sample while a sweep is requested, otherwise none.
    #[inline(always)]
    pub fn tick(&mut self) {
        let passed = self.hardware.periods_since_last();
        let count = self.position.update(self.hardware.count()).count;
        let step = count.wrapping_sub(core::mem::replace(&mut self.last, count));
        if self.left > 0
            && let Some(end) = self.end(passed, count, step)
        {
            self.left = 0;
            tell_end(end);
        }
        let is_on = self.left > 0;
        let playing = is_on && self.starting == 0;
        let code = if playing { self.exciter.next().code } else { DacCode::MID_SCALE };
        self.hardware.write(code);
        // Before the amplifier, which can only be switched on after the alignment.
        let is_aligning = is_on && !playing && self.hardware.is_aligning();
        self.hardware.amplifier(is_on);
        if is_aligning {
            // Its field moves the device.
            self.start = count;
        } else if is_on && !playing {
            self.starting -= 1;
        } else if playing {
            self.tell(count);
            self.left -= 1;
            if self.left == 0 {
                tell_end(SweepEnd::Done);
            }
        } else if BEGIN.swap(false, Ordering::Relaxed) {
            (self.exciter, self.left, self.tick) = (self.beginning.clone(), self.samples, 0);
            (self.start, self.dropped) = (count, self.rows.dropped());
            self.starting = self.hardware.start_up_ticks();
            // An error: the motor is brushed, and needs none.
            let _ = self.hardware.align();
        }
        self.held = code;
        self.hardware.feed_watchdog();
    }

    /// The reason if the sweep ends in this tick.
    fn end(&mut self, passed: u32, count: i32, step: i32) -> Option<SweepEnd> {
        let listening = LISTENING.load(Ordering::Relaxed);
        // The task below cannot write between the load and the store.
        LISTENING.store(listening.saturating_sub(1), Ordering::Relaxed);
        if self.hardware.output_event().is_some()
            || self.hardware.reading_fault().is_some()
            || self.has_stopped(step)
        {
            Some(SweepEnd::OutputFault)
        } else if STOP.load(Ordering::Relaxed) || BEGIN.swap(false, Ordering::Relaxed) {
            // A request to begin is not kept for the time after this sweep.
            Some(SweepEnd::Stopped)
        } else if listening == 0 {
            Some(SweepEnd::Silent)
        } else if passed != 1 {
            // A torque was held for too long: the rest would not be the sweep.
            Some(SweepEnd::MissedTick)
        } else if self.rows.dropped() != self.dropped {
            Some(SweepEnd::LostRow)
        } else {
            self.guard.check(count.wrapping_sub(self.start), step)
        }
    }

    /// Whether the encoder has stopped. The sweep's own numbers of ticks stand still before its first.
    fn has_stopped(&mut self, step: i32) -> bool {
        step == 0 && self.hardware.rested(self.tick)
    }

    fn tell(&mut self, count: i32) {
        let (code, limit, state) = (self.held, LimitReason::None, State::Running);
        self.rows.push(Frame { tick: self.tick, count, code, limit, state, slack: 0 });
        self.tick = self.tick.wrapping_add(1);
    }
}

#[cfg(not(feature = "magnetic"))]
fn counter_width(_: EncoderSetup) -> CounterWidth {
    super::start::width(super::wiring::ENCODER)
}

#[cfg(feature = "magnetic")]
fn counter_width(encoder: EncoderSetup) -> CounterWidth {
    encoder.chip.width
}

/// Reports the end of the sweep to the task below, after its last row.
fn tell_end(end: SweepEnd) {
    ENDED.store(end as u32 + 1, Ordering::Release);
}

/// Waits for the host, and plays the sweep at its request.
pub fn measure<const N: usize, const FROZEN: u32>(
    sweep: &'static Sweep<N>,
    setup: &Setup,
    cell: &'static SweepCell<FROZEN>,
) -> ! {
    let mut serial = init_chip(setup.encoder);
    let mut hardware = registers(setup.output, sweep.period(), <ProgramMode>::TIMING);
    hardware.zero_encoder();
    defmt::info!("last reset: {=str}", hardware.reset_cause().as_str());
    static QUEUE: StaticCell<FrameQueue<ROWS>> = StaticCell::new();
    let (rows, mut told) = QUEUE.init_with(FrameQueue::new).split();
    let exciter = Exciter::new(sweep);
    hardware.start_watchdog();
    hardware.start(<ProgramMode>::TIMING);
    let player = SweepIsr {
        beginning: exciter.clone(),
        exciter,
        samples: sweep.ticks(),
        left: 0,
        starting: 0,
        guard: setup.guard,
        tick: 0,
        position: Position::new(counter_width(setup.encoder)),
        start: 0,
        last: 0,
        held: DacCode::MID_SCALE,
        hardware,
        rows,
        dropped: 0,
    };
    // SAFETY: the interrupt that uses the place is not enabled yet.
    unsafe { cell.init(player) };
    // SAFETY: its handler finds its place filled.
    unsafe { TICK.enable() };
    let step = sweep.full_scale_torque() / f64::from(DacCode::CODES_TO_FULL_SCALE);
    let mut writer = Writer { period: sweep.period(), step, line: String::new(), count: 0 };
    let (mut receiver, mut describe) = (SweepReceiver::new(), false);
    let patience = (SILENCE / sweep.period()) as u32;
    loop {
        describe |= listen(&mut serial, &mut receiver, patience);
        // Not into a line that is half sent.
        if describe && writer.line.is_empty() {
            describe = false;
            writer.describe(setup, sweep.ticks());
        }
        writer.send(&mut serial, &mut told);
        cortex_m::asm::wfi();
    }
}

/// Handles the bytes of the host; returns whether it requested the description.
fn listen(serial: &mut Serial, receiver: &mut SweepReceiver, patience: u32) -> bool {
    let mut bytes = [0; 32];
    let count = serial.read(&mut bytes);
    let mut describe = false;
    for &byte in bytes.get(..count).unwrap_or_default() {
        let Some(request) = receiver.push(byte) else { continue };
        let (begin, stop) = match request {
            SweepRequest::Describe => {
                describe = true;
                continue;
            }
            SweepRequest::Listening => (false, false),
            SweepRequest::Begin { .. } => (true, false),
            SweepRequest::Stop => (false, true),
        };
        LISTENING.store(patience, Ordering::Relaxed);
        if stop || begin {
            STOP.store(stop, Ordering::Relaxed);
            BEGIN.store(begin, Ordering::Relaxed);
        }
    }
    describe
}

/// Writes the lines of the record.
struct Writer {
    period: f64,
    /// Torque of one code in N m.
    step: f64,
    /// Unsent bytes.
    line: String<LINE>,
    /// The position of the last row.
    count: i32,
}

// Every line fits; a longer line would be cut off.
impl Writer {
    /// Sends lines while there are lines and the port takes them.
    fn send(&mut self, serial: &mut Serial, told: &mut FrameReader<'_, ROWS>) {
        loop {
            if self.line.is_empty() {
                // The end is read before the rows: when it is set, all rows are in the queue.
                let ended = ENDED.load(Ordering::Acquire);
                if let Some(frame) = told.take() {
                    self.row(&frame);
                } else if ended != 0 {
                    ENDED.store(0, Ordering::Relaxed);
                    self.end(ended);
                } else {
                    return;
                }
            }
            let sent = serial.write(self.line.as_bytes());
            let rest = self.line.as_str().get(sent..).unwrap_or_default();
            self.line = String::try_from(rest).unwrap_or_default();
            if !self.line.is_empty() {
                return;
            }
        }
    }

    fn row(&mut self, frame: &Frame) {
        let heading = if frame.tick == 0 { "time,torque,counts\n" } else { "" };
        let time = ShortF64(f64::from(frame.tick) * self.period);
        let torque = ShortF64(f64::from(frame.code.offset()) * self.step);
        self.count = frame.count;
        let _ = writeln!(self.line, "{heading}{time},{torque},{}", frame.count);
    }

    fn end(&mut self, ended: u32) {
        let end = SweepEnd::ALL.get(ended as usize - 1).map_or("", |end| end.as_str());
        let _ = writeln!(self.line, "end,{end},{}", self.count);
    }

    fn describe(&mut self, setup: &Setup, ticks: u64) {
        let (period, counts) = (ShortF64(self.period), ShortF64(setup.transducers.counts_per_turn));
        let (travel, speed) = (ShortF64(setup.limits.travel), ShortF64(setup.limits.speed));
        let _ = write!(
            self.line,
            "identify,{SWEEP_PROTOCOL},{period},{counts},{ticks},{travel},{speed}"
        );
        if let Some(source) = setup.output.torque_source() {
            let TorqueSource { gain, resistance, inductance, feedback, instant, .. } = source;
            let of_loop = [gain, resistance, inductance, feedback, instant];
            let of_torque = [source.loss, source.step, source.zero_crossing];
            for number in of_loop.into_iter().chain(of_torque) {
                let _ = write!(self.line, ",{}", ShortF64(number));
            }
        }
        let _ = self.line.push('\n');
    }
}

/// The program of a sweep on this board.
#[doc(hidden)]
#[macro_export]
macro_rules! board_sweep {
    ($sweep:ident, $transducers:ident, $limits:ident, $bridge:tt, $encoder:tt) => {
        $crate::board_chip!();
        $crate::sweep_output!($bridge);
        $crate::board_encoder!(
            $encoder,
            $bridge,
            $transducers,
            $crate::encoder_reading::EncoderReading::ideal(),
            $sweep.period(),
            false
        );

        static SETUP: $crate::board::stm32::Setup = $crate::board::stm32::Setup {
            transducers: $transducers,
            limits: $limits,
            guard: GUARD,
            encoder: ENCODER,
            output: OUTPUT,
        };

        static ISR_STATE: $crate::board::stm32::SweepCell<FROZEN> =
            $crate::board::isr_cell::IsrCell::empty();

        $crate::board_tick!();

        #[$crate::__private::cortex_m_rt::entry]
        fn main() -> ! {
            $crate::board::stm32::measure(&$sweep, &SETUP, &ISR_STATE)
        }
    };
}
