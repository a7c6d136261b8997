//! The board's own bridge: a current loop in an interrupt of its own, above the servo's.
//!
//! ```text
//! TIM1 update   |           |           |           |           |     each PWM period h, n in a servo period
//!  (pwm)        v           v           v           v           v
//! currents      i(0)        i(1)        i(2)                    i(n)  sampled in the middle of the low sides
//!  (sense)
//! interrupt     [I][servo ] [I]         [I]                     [I][servo]
//!  (interrupt)   |   count read at 0, code for the next period   |
//!  (encoder)     the code of the period before is the reference from here on ...
//! voltage                   v(0)        v(1)                          duties act one update after they
//!                                                                     were computed
//! current                               moves                         and so the torque after one h
//! ```
//!
//! The gates are off from reset until the servo arms. Each fault turns them off by one write, and an
//! over-current by [hardware](over_current) alone.

pub mod encoder;
mod interrupt;
mod latest;
#[cfg(feature = "on-target")]
pub mod load;
mod over_current;
mod pwm;
mod sense;

use core::num::NonZeroU32;
use core::sync::atomic::{AtomicU8, AtomicU16, AtomicU32, Ordering};

use embassy_stm32::interrupt as interrupts;
use embassy_stm32::interrupt::{InterruptExt, Priority};

pub use interrupt::CurrentIsr;
pub use latest::power_reading;

use crate::board::isr_cell::IsrCell;
use crate::board::stm32::output::pace::Pace;
use crate::board::stm32::wiring::{GATES, TIMER_CLOCK};
use crate::build_error::BuildError;
use crate::current::{AlignmentError, CurrentLoop, HeatStep, PowerFault, TorqueSource};
use crate::dac::DacCode;
use crate::fault::Fault;
use crate::output_timing::OutputTiming;
use crate::servo_loop::OutputEvent;

/// The state of the current interrupt.
pub type CurrentCell<const BRUSHLESS: bool> = IsrCell<CurrentIsr<BRUSHLESS>>;

/// The data of a program that this output needs.
#[derive(Clone, Copy)]
pub struct Setup {
    /// The current loop of the program's motor.
    pub current_loop: &'static CurrentLoop,
    /// Fills the cell of the current interrupt, whose type gives the kind of motor. That interrupt must not
    /// be enabled yet.
    pub fill: fn(OutputTiming),
}

impl Setup {
    /// The data of the current loop for a measurement.
    pub const fn torque_source(&self) -> Option<TorqueSource> {
        Some(*self.current_loop.torque_source())
    }
}

/// The servo's last code.
static WAITING: AtomicU16 = AtomicU16::new(DacCode::MID_SCALE.get());

/// Whether the gates are driven: see [`State`].
static STATE: AtomicU8 = AtomicU8::new(State::Off as u8);

/// Steps of the torque limit, in the place of a fault's code.
const LOWER: u32 = u32::MAX;
const RAISE: u32 = u32::MAX - 1;

/// The code and the numbers of a fault that the servo has not read yet; a code of 0: no fault.
static FAULT: AtomicU32 = AtomicU32::new(0);
static FAULT_NUMBERS: [AtomicU32; 2] = [AtomicU32::new(0), AtomicU32::new(0)];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum State {
    /// All gates are low.
    Off,
    /// The current interrupt shall drive them: it finds the comparators' thresholds, and the low sides charge
    /// the supplies of the high sides' gates.
    Starting,
    /// The servo drives them.
    On,
    /// The current interrupt shall begin an alignment.
    StartingAlignment,
    /// An alignment drives them.
    Aligning,
}

/// The bridge, for the servo's interrupt.
#[derive(Debug)]
pub struct Output {
    is_brushless: bool,
    /// Periods of the servo from switching on until the current follows the code.
    start_up: u32,
}

impl Output {
    /// The bridge with its gates low, and the pace of the servo; nothing runs yet.
    ///
    /// # Errors
    /// None: the period was checked with the current loop at compile time.
    pub fn new(setup: Setup, _: f64, timing: OutputTiming) -> Result<(Self, Pace), BuildError> {
        let current_loop = setup.current_loop;
        pwm::prepare(current_loop);
        GATES.connect(current_loop.phases());
        over_current::prepare();
        sense::prepare();
        latest::of(current_loop);
        if current_loop.needs_air() {
            defmt::warn!(
                "full-scale torque takes more current than the board bears for long without a flow of air: the \
                 torque is limited after some seconds"
            );
        }
        #[cfg(not(feature = "magnetic"))]
        if current_loop.has_index() {
            encoder::quadrature::capture_index();
        }
        (setup.fill)(timing);
        let counts = NonZeroU32::new(current_loop.clock_counts()).unwrap_or(NonZeroU32::MIN);
        let output = Self {
            is_brushless: current_loop.is_brushless(),
            start_up: current_loop.start_up_ticks(),
        };
        #[cfg(not(feature = "magnetic"))]
        encoder::quadrature::capture_counts();
        let seconds = f64::from(counts.get()) / TIMER_CLOCK;
        // After a PWM period the next capture overwrites the count.
        let in_time = 2 * u32::from(current_loop.timer_counts());
        Ok((output, Pace::new(counts, seconds, in_time)))
    }

    /// Starts the current interrupt, with the gates low.
    pub fn start(&mut self, pace: &mut Pace, _: OutputTiming) {
        #[cfg(not(feature = "magnetic"))]
        encoder::quadrature::forget_index();
        interrupts::ADC1_2.set_priority(Priority::P0);
        // SAFETY: its handler finds its cell filled.
        unsafe { interrupts::ADC1_2.enable() };
        pace.start(pwm::start);
    }

    /// Sets the code of the next torque, which the current loop takes over when it is due.
    #[inline(always)]
    pub fn set(&mut self, code: DacCode) {
        WAITING.store(code.get(), Ordering::Relaxed);
    }

    /// Off at once; on after [`start_up_ticks`](Self::start_up_ticks), if the power stage finds no
    /// fault. The current interrupt has a higher priority than this one, and turns the gates on only after a
    /// request.
    #[inline(always)]
    pub fn switch(&mut self, on: bool) {
        if !on {
            return off();
        }
        if STATE.load(Ordering::Relaxed) == State::Off as u8 {
            STATE.store(State::Starting as u8, Ordering::Relaxed);
        }
    }

    /// Periods after switching on for which the code must be that of zero torque.
    pub fn start_up_ticks(&self) -> u32 {
        self.start_up
    }

    /// Begins to align a brushless motor whose gates are off.
    ///
    /// # Errors
    /// If the motor is brushed.
    pub fn align(&mut self) -> Result<(), Fault> {
        if !self.is_brushless {
            return Err(Fault::Power(PowerFault::Alignment(AlignmentError::NotNeeded)));
        }
        if STATE.load(Ordering::Relaxed) == State::Off as u8 {
            STATE.store(State::StartingAlignment as u8, Ordering::Relaxed);
        }
        Ok(())
    }

    /// Whether an alignment runs.
    pub fn is_aligning(&self) -> bool {
        let state = STATE.load(Ordering::Relaxed);
        state == State::StartingAlignment as u8 || state == State::Aligning as u8
    }

    /// An event since the last call.
    #[inline(always)]
    pub fn event(&mut self) -> Option<OutputEvent> {
        if FAULT.load(Ordering::Acquire) == 0 { None } else { take_event() }
    }
}

#[cold]
#[inline(never)]
fn take_event() -> Option<OutputEvent> {
    match FAULT.swap(0, Ordering::Acquire) {
        LOWER => Some(OutputEvent::Heat(HeatStep::Lower)),
        RAISE => Some(OutputEvent::Heat(HeatStep::Raise)),
        code => decoded(code).map(OutputEvent::Fault),
    }
}

/// A fault of this code. Its numbers are read after the code: a fault that replaces a step of the limit brings its own.
fn decoded(code: u32) -> Option<Fault> {
    Fault::decode(code, [0, 1].map(|i| FAULT_NUMBERS[i].load(Ordering::Relaxed)))
}

/// The fault of the encoder's readings that waits, if one does: a tick may be late because of its handling.
#[cfg(feature = "magnetic")]
#[cold]
#[inline(never)]
pub fn reading_fault() -> Option<Fault> {
    let waiting = decoded(FAULT.load(Ordering::Acquire));
    waiting.filter(|fault| matches!(fault, Fault::EncoderReading { .. }))
}

/// Passes a step of the torque limit to the servo, which takes it in the tick that follows; a fault goes first.
#[cold]
#[inline(never)]
fn tell_heat(step: HeatStep) {
    let code = match step {
        HeatStep::Lower => LOWER,
        HeatStep::Raise => RAISE,
    };
    if FAULT.load(Ordering::Relaxed) == 0 {
        FAULT.store(code, Ordering::Release);
    }
}

/// Reports a fault to the servo, unless it has not taken the one before yet, of which this may come. The gates are off.
#[cold]
#[inline(never)]
fn tell(fault: Fault) {
    if ![0, LOWER, RAISE].contains(&FAULT.load(Ordering::Relaxed)) {
        return;
    }
    let (code, numbers) = fault.encode();
    for (place, number) in FAULT_NUMBERS.iter().zip(numbers) {
        place.store(number, Ordering::Relaxed);
    }
    FAULT.store(code, Ordering::Release);
}

/// Sets all gates low, in any state of the program. The state is written first, so that the current interrupt
/// does not turn the gates on again.
#[inline(always)]
pub fn off() {
    STATE.store(State::Off as u8, Ordering::Relaxed);
    pwm::off();
}

/// Ends the torque.
pub fn stop() {
    WAITING.store(DacCode::MID_SCALE.get(), Ordering::Relaxed);
}

/// The bridge of a program's motor, and the handler of its current interrupt.
#[doc(hidden)]
#[macro_export]
macro_rules! board_output {
    ([]) => {
        compile_error!(
            "the bridge drives a motor that this program does not state: write `bridge: CURRENT_LOOP` in \
             scene_program! or sweep_program!, or build it with --output dac"
        );
    };
    ([$current_loop:ident]) => {
        static CURRENT: $crate::board::stm32::output::bridge::CurrentCell<
            { $current_loop.is_brushless() },
        > = $crate::board::isr_cell::IsrCell::empty();

        fn fill_current(timing: $crate::output_timing::OutputTiming) {
            let state =
                $crate::board::stm32::output::bridge::CurrentIsr::new(&$current_loop, timing, ENCODER);
            // SAFETY: called before the interrupt that uses the cell is enabled.
            unsafe { CURRENT.init(state) };
        }

        /// What the bridge has to know of this program.
        const OUTPUT: $crate::board::stm32::output::Setup = $crate::board::stm32::output::Setup {
            current_loop: &$current_loop,
            fill: fill_current,
        };

        $crate::in_fast_memory! {
            /// An instant of the current loop.
            #[unsafe(no_mangle)]
            unsafe extern "C" fn ADC1_2() {
                // SAFETY: this is the handler of the interrupt that is enabled after the cell is filled, and
                // no interrupt interrupts itself.
                unsafe { CURRENT.borrow_mut() }.run(ENCODER);
            }
        }
    };
}

/// A sweep uses the same bridge.
#[doc(hidden)]
#[macro_export]
macro_rules! sweep_output {
    ($bridge:tt) => {
        $crate::board_output!($bridge);
    };
}
