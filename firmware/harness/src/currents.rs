//! Current loops whose instants are measured.

use haptic_servo::current::{
    CurrentController, CurrentLoop, Drive, Motor, PhaseAlignment, PowerStage, Sample, Supply,
    SupplyRange, Thermistor, TripRange, Winding,
};
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::servo::Transducers;

/// A motor with a current loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum CurrentBench {
    /// A brushed one.
    Brushed,
    /// One with seven pole pairs.
    Brushless,
}

const STAGE: PowerStage = PowerStage {
    clock: 170e6,
    amps_per_count: 0.03,
    current_lowers_count: true,
    volts_per_count: 0.0084,
    volts_tolerance: 0.02,
    largest_current: 40.0,
    offset_counts: (2390, 2716),
    continuous_current: 40.0,
    largest_temperature: 120.0,
    trip_range: TripRange { lowest: 140, highest: 180, amps_per_code: 0.5 },
    trip_margin: 8.0,
    charging: 10e-3,
    supply: SupplyRange { lowest: 10.0, highest: 34.0 },
    dead_time: 0.2e-6,
    shortest_low: 1.5e-6,
    thermistor: Thermistor { resistance: 10e3, beta: 3380.0, to_ground: 4.7e3 },
};

const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 0.2,
    largest_speed: 100.0,
};

const fn design(winding: Winding) -> CurrentLoop {
    let motor = Motor { winding, resistance: 0.3, inductance: 0.15e-3, torque_constant: 0.05 };
    let supply = Supply::sinking(22.0, 26.0);
    let drive = Drive { motor, supply, bandwidth: 1000.0, largest_temperature: 90.0 };
    CurrentLoop::checked(&drive, &STAGE, &TRANSDUCERS, 1e-3)
}

static BRUSHED: CurrentLoop = design(Winding::Brushed);
static BRUSHLESS: CurrentLoop = design(Winding::Brushless { pole_pairs: 7 });

/// Counts without a current.
pub const OFFSET: u16 = 2553;
/// Counts that the handle turns in an instant.
const SPEED: u32 = 3;
/// Codes of a step of an input.
const CODES: i16 = 14;

impl CurrentBench {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Brushed, Self::Brushless];

    /// Its loop.
    pub fn design(self) -> &'static CurrentLoop {
        match self {
            Self::Brushed => &BRUSHED,
            Self::Brushless => &BRUSHLESS,
        }
    }

    /// A controller whose gates have just been switched on.
    pub fn started(self) -> CurrentController {
        let mut controller = CurrentController::new(self.design());
        let rest = Input::new(OFFSET, OFFSET, 0).at(0).0;
        for _ in 0..256 {
            controller.measure_offset(&rest);
        }
        controller.set_phase(PhaseAlignment { offset: 1 << 28, is_reversed: true });
        // All of these numbers are in range.
        let _ = controller.start();
        controller
    }
}

/// Two currents and a code in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input(pub u32);

impl Input {
    /// Counts of 12 bits, and a code in steps of 14.
    pub fn new(u: u16, v: u16, code: i16) -> Self {
        let code = (code / CODES) as i8;
        let counts = u32::from(u & 0xfff) | u32::from(v & 0xfff) << 12;
        Self(counts | u32::from(code.cast_unsigned()) << 24)
    }

    /// Steps of the code, with currents of the phases U and V that first follow the code and then do not, so
    /// that voltage and circle are at their limits.
    pub fn of_steps(instant: u32) -> Self {
        let code = if (instant / 100).is_multiple_of(2) { 1700 } else { -1700 };
        let noise = (instant.wrapping_mul(2_654_435_761) >> 27) as u16;
        let amps = if instant % 100 < 12 { 120 } else { 0 };
        let (u, v) = (OFFSET - 16 + noise + amps, OFFSET + 16 - noise - amps);
        Self::new(u, v, code * i16::from(instant % 100 < 40))
    }

    /// The sample of an instant, and its code.
    #[inline(always)]
    pub fn at(self, instant: u32) -> (Sample, i16) {
        let sample = Sample {
            currents: [(self.0 & 0xfff) as u16, (self.0 >> 12 & 0xfff) as u16],
            bus: 2857,
            temperature: 1300,
            position: RawCount::from(instant.wrapping_mul(SPEED)),
        };
        (sample, i16::from((self.0 >> 24) as u8 as i8) * CODES)
    }
}
