//! A simulated board: encoder, DAC, amplifier and timer of the servo's interrupt.

use haptic_servo::boot::Startup;
use haptic_servo::current::{
    B_G431B_ESC1, CurrentLoop, Drive, HeatStep, Heating, Motor, PowerStage, Supply, Winding,
};
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::fault::FaultRecord;
use haptic_servo::reset::ResetCause;
use haptic_servo::servo::Transducers;
use haptic_servo::servo_loop::{BEGAN_LATE, Frame, FrameSink, Hardware, OutputEvent, State};

/// Timer counts in a period.
pub const PERIOD: u32 = 1000;

/// A current loop whose power stage bears a fifth of the full-scale current. For a servo as slow as this a power
/// stage heats and cools within some tens of ticks.
static CURRENT_LOOP: CurrentLoop = {
    let motor = Motor {
        winding: Winding::Brushed,
        resistance: 0.1,
        inductance: 0.05e-3,
        torque_constant: 0.05,
    };
    let supply = Supply::sinking(20.0, 24.0);
    let drive = Drive { motor, supply, bandwidth: 1000.0, largest_temperature: 90.0 };
    let transducers = Transducers {
        counts_per_turn: 61_440.0,
        counter: CounterWidth::Bits16,
        full_scale_torque: 1.0,
        largest_speed: 10.0,
    };
    let stage = PowerStage { continuous_current: 4.0, ..B_G431B_ESC1 };
    CurrentLoop::checked(&drive, &stage, &transducers, 0.1)
};

/// The board. What the run sets before a tick, and what the tick did.
#[derive(Clone, Copy, Debug)]
pub struct Board {
    /// Angle of the device in rad.
    pub angle: f64,
    /// Whole periods since the last tick.
    pub passed: u32,
    /// Whether the tick ends after its period.
    pub late: bool,
    /// Timer counts after the beginning of its period with which the tick begins, where that is not
    /// in time.
    pub delay: u32,
    /// Codes above mid-scale that were written last.
    pub offset: i16,
    /// Whether the amplifier is on.
    pub amplifier: bool,
    /// The heat of the board's current, where it has one.
    pub heating: Option<Heating>,
    /// What that does to the torque's limit.
    pub heat_step: Option<HeatStep>,
    /// Whether the last reset was the watchdog's.
    pub by_watchdog: bool,
    counts_per_radian: f64,
    /// Angle in rad at which the encoder's counter is zero.
    zero: f64,
}

impl Board {
    /// The same with a current that heats it.
    pub const fn heating(self) -> Self {
        Self { heating: Some(CURRENT_LOOP.heating()), ..self }
    }

    /// The heat of the current after a tick; whether the torque's limit begins to rise.
    pub fn heat(&mut self) -> bool {
        let Some(heating) = &mut self.heating else { return false };
        let full = f32::from(DacCode::CODES_TO_FULL_SCALE);
        let amps = CURRENT_LOOP.full_scale_current() as f32 * f32::from(self.offset) / full;
        let was = self.heat_step;
        self.heat_step = heating.observe(amps, self.offset);
        self.heat_step == Some(HeatStep::Raise) && was != self.heat_step
    }

    /// A board with the device at zero.
    pub const fn new(counts_per_radian: f64, by_watchdog: bool) -> Self {
        Self {
            angle: 0.0,
            passed: 1,
            late: false,
            delay: 0,
            offset: 0,
            amplifier: false,
            heating: None,
            heat_step: None,
            by_watchdog,
            counts_per_radian,
            zero: 0.0,
        }
    }
}

impl Hardware for Board {
    #[inline]
    fn count(&mut self) -> RawCount {
        // The counter wraps; 64 bits hold any angle that a run reaches.
        let counts = (self.angle - self.zero) * self.counts_per_radian;
        RawCount::from((counts + 0.5).floor() as i64 as u32)
    }

    #[inline]
    fn write(&mut self, code: DacCode) {
        self.offset = code.offset();
    }

    fn amplifier(&mut self, on: bool) {
        self.amplifier = on;
    }

    fn output_event(&mut self) -> Option<OutputEvent> {
        self.heat_step.map(OutputEvent::Heat)
    }

    #[inline]
    fn periods_since_last(&mut self) -> u32 {
        if self.delay > 0 && self.passed == 1 { BEGAN_LATE } else { self.passed }
    }

    #[inline]
    fn time_in_period(&mut self) -> u32 {
        if self.late { PERIOD } else { self.delay }
    }

    #[inline]
    fn feed_watchdog(&mut self) {}
}

impl Startup for Board {
    fn zero_encoder(&mut self) {
        self.zero = self.angle;
    }

    fn start_watchdog(&mut self) {}

    fn stored_fault(&mut self) -> [u32; FaultRecord::WORDS] {
        FaultRecord::NOTHING
    }

    fn reset_cause(&mut self) -> ResetCause {
        if self.by_watchdog { ResetCause::IndependentWatchdog } else { ResetCause::PowerOn }
    }

    fn period(&self) -> u32 {
        PERIOD
    }
}

/// Keeps the state of the last tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Last {
    /// The state at the end of it.
    pub state: State,
}

impl FrameSink for Last {
    #[inline]
    fn push(&mut self, frame: Frame) {
        self.state = frame.state;
    }

    fn dropped(&self) -> u32 {
        0
    }
}
