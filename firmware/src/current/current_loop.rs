//! The design of a current loop, at compile time: every coefficient that an instant needs, rounded once.

use super::encoder_index::EncoderIndex;
use super::error::DriveError;
use super::heating::{HeatLimit, Heating, TIME};
use super::motion::TorqueSource;
use super::motor::{Drive, Regeneration, Winding};
use super::offset_check::OffsetCheck;
use super::phase::Turn;
use super::plant::{Plant, lag_of};
use super::power_stage::PowerStage;
use super::regeneration::Bus;
use super::resolution::{CurrentResolution, Quanta};
use super::sample::Duties;
use super::thermistor::{Thermistor, ThermistorTable};
use super::timing::PwmTiming;
use super::trip_search::TripRange;
use crate::dac::DacCode;
use crate::encoder::CounterWidth;
use crate::passivity::interval::Interval;
use crate::transducers::Transducers;

/// Over-current, as a multiple of the current of full-scale torque: a step stays below it in a motor whose
/// resistance and inductance differ by a third.
pub const OVER_CURRENT: f64 = 1.25;

/// Ratio of the current at which a comparator trips to the current at which the current interrupt turns the gates
/// off: a sample in the middle of the low side's time has the mean of the ripple, and a comparator sees the peak.
const TRIP_ABOVE: f64 = 1.2;

/// A longer deviation from the model above this is a fault; relative to the current of full-scale torque.
const LARGEST_DEVIATION: f64 = 0.25;

/// Time constants of the feedback within which a deviation, or a lack of voltage, must end.
const SETTLING: f64 = 8.0;

/// Smallest number of encoder counts in an electrical turn: half a count of 64 is 0.05 rad, which reduces the
/// torque by 0.1 per cent.
const LEAST_ELECTRICAL_COUNTS: f64 = 64.0;

/// Largest number of counts per turn of a brushless motor's encoder, so that a turn fits 24 bits.
const LARGEST_COUNTS: f64 = (1 << 24) as f64;

/// Smallest number of instants in an electrical turn: the phase then moves by at most 0.3 rad from a sample
/// to the middle of its voltage, where two terms of its sine and cosine are enough.
const INSTANTS_PER_TURN: f64 = 32.0;

/// Largest relative increase of a vector's length by the errors of sine and cosine.
const SINE_ERROR: f64 = 2e-4;

const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// The time response of a current loop for the certificate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueResponse {
    /// Time in s from the code to the beginning of its torque: `Latency::output_delay`.
    pub delay: f64,
    /// Time constant in s of the lag behind it: `Latency::actuator_lag`.
    pub lag: f64,
    /// Updates in a period of the servo, at which the torque is that of the lag.
    pub updates: u16,
}

/// A current loop, designed for a drive on a power stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLoop {
    pub(super) winding: Winding,
    pub(super) timing: PwmTiming,
    pub(super) counter: CounterWidth,
    pub(super) law: Law,
    pub(super) output: Output,
    pub(super) limits: Limits,
    /// At the count 0; not used by a brushed motor.
    pub(super) turn: Turn,
    /// The index of the encoder, where the program states one.
    pub(super) index: Option<EncoderIndex>,
    /// `None` if the full-scale current may last for ever.
    pub(super) heat: Option<HeatLimit>,
    trip_range: TripRange,
    /// Codes between the trip of a comparator without a current and its threshold.
    trip_margin: u16,
    /// Instants in which the low sides charge the supplies of the high sides' gates.
    charging: u32,
    /// Period of the modulation in s.
    pub(super) instant: f64,
    amps_per_code: f64,
    torque_constant: f64,
    response: TorqueResponse,
    resolution: CurrentResolution,
    torque_source: TorqueSource,
    /// `None` for a supply that takes energy back.
    pub(super) bus: Option<Bus>,
    /// Not in the program of a board, which does not use it: each controller has a copy of this structure.
    #[cfg(not(target_os = "none"))]
    drive: Drive,
}

/// Coefficients of the model, of its feed-forward, and of the feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law {
    /// Current in A of a code.
    pub amps_per_code: f32,
    /// Current in A of a count, with its sign.
    pub amps_per_count: f32,
    /// `1 - p`.
    pub model_gain: f32,
    /// `a`.
    pub decay: f32,
    /// `1/b` in V/A.
    pub volts: f32,
    /// `K a/b` in V/A.
    pub proportional: f32,
    /// `K (1 - a)/b` in V/A.
    pub integral: f32,
    /// Electrical rad of a count; zero for a brushed motor.
    pub radians: f32,
}

/// From a voltage to compare values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Output {
    /// Compare value in counts per volt, for a supply that reads 1.
    pub counts_per_volt: f32,
    /// Largest difference of two compare values.
    pub span: u16,
    /// Largest amplitude of a phase in counts: the circle inside the hexagon of the available voltages, less
    /// the dead time.
    pub circle: f32,
    /// Loss by the dead time in counts: of the difference of a brushed motor's two compare values, or of each
    /// of a brushless motor's three.
    pub dead: f32,
}

impl Law {
    /// Current in A of a brushed motor, from the difference of the counts of U and V above their offsets:
    /// both shunts measure the current, with opposite signs; half the difference has half the step.
    #[inline(always)]
    pub(super) const fn between_two(&self, difference: f32) -> f32 {
        0.5 * self.amps_per_count * difference
    }
}

impl Output {
    /// The loss by the dead time in a brushed motor with this current, in counts of the difference, for its
    /// compensation (theory, section 15.9).
    #[inline(always)]
    pub(super) const fn dead_time(&self, current: f32) -> f32 {
        if current == 0.0 { 0.0 } else { self.dead.copysign(current) }
    }
}

/// Bounds in counts, and the factors that convert counts to physical units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub over_current: u16,
    pub bus: (u16, u16),
    pub temperature: u16,
    pub offsets: (u16, u16),
    /// Largest deviation in A that may persist.
    pub deviation: f32,
    /// Instants that a larger deviation, or a lack of voltage, may last.
    pub instants: u16,
    /// Largest sum over such instants of the deviations that no motion explains, in A.
    pub unexplained: f32,
    /// Sum over the instants in A of the deviation by a change of the speed by a count in an instant.
    pub amps_of_motion: f32,
    /// `1 - a`, the weight of an instant's speed.
    pub smoothing: f32,
    pub milliamps_per_count: f32,
    pub millivolts_per_count: f32,
    pub thermistor: ThermistorTable,
}

impl CurrentLoop {
    /// Designs the loop of a drive on a power stage, for a servo with these transducers and this period in s.
    ///
    /// # Errors
    /// If the drive cannot run there: the value and its bound.
    pub const fn design(
        drive: &Drive,
        stage: &PowerStage,
        transducers: &Transducers,
        period: f64,
    ) -> Result<Self, DriveError> {
        match Design::of(drive, stage, transducers, period) {
            Ok(design) => Ok(design.current_loop()),
            Err(error) => Err(error),
        }
    }

    /// For constants: a compile error if the drive cannot run.
    ///
    /// # Panics
    /// If the drive cannot run; in a constant this is a compile error.
    #[track_caller]
    pub const fn checked(
        drive: &Drive,
        stage: &PowerStage,
        transducers: &Transducers,
        period: f64,
    ) -> Self {
        match Self::design(drive, stage, transducers, period) {
            Ok(designed) => designed,
            Err(error) => error.refuse(),
        }
    }

    /// The motor and the supply, which a simulation needs.
    #[cfg(not(target_os = "none"))]
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The kind of the motor's winding.
    pub const fn winding(&self) -> Winding {
        self.winding
    }

    /// Reload value of the modulation's timer, which counts up and down.
    pub const fn timer_counts(&self) -> u16 {
        self.timing.counts
    }

    /// Instants in a period of the servo.
    pub const fn updates(&self) -> u16 {
        self.timing.updates
    }

    /// The time response for the certificate.
    pub const fn response(&self) -> TorqueResponse {
        self.response
    }

    /// The resolution of the torque.
    pub const fn resolution(&self) -> CurrentResolution {
        self.resolution
    }

    /// Damping in N m s/rad that motion takes from the device through this loop, rounded up: the device's
    /// passivity must be lower than its damping by this. Infinite if no bound is known, for a winding whose
    /// time constant is far below an instant.
    pub const fn motion_loss(&self) -> f64 {
        self.torque_source.loss
    }

    /// The effect of the loop on a measurement of the device.
    pub const fn torque_source(&self) -> &TorqueSource {
        &self.torque_source
    }

    /// Torque per current in N m/A.
    pub const fn torque_per_amp(&self) -> f64 {
        self.torque_constant
    }

    /// Current in A of full-scale torque.
    pub const fn full_scale_current(&self) -> f64 {
        self.amps_per_code * DacCode::CODES_TO_FULL_SCALE as f64
    }

    /// Counts above or below its offset at which a phase's current is a fault.
    pub const fn over_current_counts(&self) -> u16 {
        self.limits.over_current
    }

    /// The range in which a working comparator trips without a current.
    pub const fn trip_range(&self) -> &TripRange {
        &self.trip_range
    }

    /// The threshold of comparators that trip at these codes without a current: 6/5 of the over-current above
    /// the last of them to trip, and at least [`PowerStage::trip_margin`](super::PowerStage).
    pub const fn trip_threshold(&self, [a, b]: [u16; 2]) -> u16 {
        let trips = if a > b { a } else { b };
        let threshold = trips.saturating_add(self.trip_margin);
        if threshold < PowerStage::LARGEST_COUNT { threshold } else { PowerStage::LARGEST_COUNT }
    }

    /// Whether the full-scale current is more than the board bears for ever without a flow of air.
    pub const fn needs_air(&self) -> bool {
        self.heat.is_some()
    }

    /// The heat of a cold power stage under this loop.
    pub const fn heating(&self) -> Heating {
        Heating::new(self.heat)
    }

    /// Instants in which the low sides conduct before the first high side.
    pub const fn charging_instants(&self) -> u32 {
        self.charging
    }

    /// Periods of the servo from switching on until the current follows the code: the search for the
    /// comparators' thresholds, the charging, and the check of a stated offset of the index.
    pub const fn start_up_ticks(&self) -> u32 {
        // Two instants for the beginnings of both, and one tick until the request is seen.
        let checking = match self.index_offset() {
            Some(_) => OffsetCheck::instants(self.instant) + 2,
            None => 0,
        };
        let instants = self.trip_range.instants() + self.charging + checking + 2;
        instants.div_ceil(self.timing.updates as u32) + 1
    }

    /// Lowest and highest count of the supply.
    pub const fn bus_counts(&self) -> (u16, u16) {
        self.limits.bus
    }

    /// Compare values of zero voltage: all phases at half.
    pub const fn no_voltage(&self) -> Duties {
        self.timing.no_voltage()
    }

    /// Largest count of the temperature.
    pub const fn temperature_count(&self) -> u16 {
        self.limits.temperature
    }
}

/// The checked numbers, in SI units.
struct Design<'a> {
    drive: &'a Drive,
    stage: &'a PowerStage,
    transducers: &'a Transducers,
    timing: PwmTiming,
    /// Period of the modulation in s.
    instant: f64,
    lag: f64,
    /// Current in A of full-scale torque.
    current: f64,
    plant: Plant,
}

impl<'a> Design<'a> {
    const fn of(
        drive: &'a Drive,
        stage: &'a PowerStage,
        transducers: &'a Transducers,
        period: f64,
    ) -> Result<Self, DriveError> {
        if let Err(error) = check_positive(drive, transducers) {
            return Err(error);
        }
        let timing = match PwmTiming::of(period, stage.clock) {
            Ok(timing) => timing,
            Err(error) => return Err(error),
        };
        let (instant, lag) = (timing.instant(period), lag_of(drive.bandwidth));
        let current = transducers.full_scale_torque / drive.motor.torque_constant;
        let plant = Plant::of(&drive.motor, lag, instant);
        let design = Self { drive, stage, transducers, timing, instant, lag, current, plant };
        match design.check() {
            Ok(()) => Ok(design),
            Err(error) => Err(error),
        }
    }

    const fn check(&self) -> Result<(), DriveError> {
        if let Err(error) = self.check_winding() {
            return Err(error);
        }
        let largest = 1.0 / (2.0 * core::f64::consts::TAU * self.instant);
        if self.drive.bandwidth > largest {
            return Err(DriveError::Bandwidth { bandwidth: self.drive.bandwidth, largest });
        }
        if let Err(error) = self.check_current() {
            return Err(error);
        }
        if let Err(error) = self.check_supply() {
            return Err(error);
        }
        let highest = self.stage.largest_temperature.min(Thermistor::HIGHEST as f64);
        let lowest = Thermistor::LOWEST as f64;
        let temperature = self.drive.largest_temperature;
        // Written so that NaN is refused.
        if temperature >= lowest && temperature <= highest {
            Ok(())
        } else {
            Err(DriveError::Temperature { temperature, lowest, highest })
        }
    }

    /// Checks that the encoder is fine enough for the motor's phase, and the phase slow enough for the
    /// modulation.
    const fn check_winding(&self) -> Result<(), DriveError> {
        let Winding::Brushless { pole_pairs } = self.drive.motor.winding else {
            return Ok(());
        };
        let counts = self.transducers.counts_per_turn;
        if counts > LARGEST_COUNTS || (counts as u32) as f64 != counts {
            return Err(DriveError::Counts { counts, largest: LARGEST_COUNTS });
        }
        let largest = (counts / LEAST_ELECTRICAL_COUNTS).min(u16::MAX as f64) as u16;
        if pole_pairs == 0 || pole_pairs > largest {
            return Err(DriveError::PolePairs { pole_pairs, largest });
        }
        let turns = self.electrical_speed() / core::f64::consts::TAU;
        let largest = 1.0 / (INSTANTS_PER_TURN * self.instant);
        if turns > largest {
            return Err(DriveError::ElectricalSpeed { turns, largest });
        }
        Ok(())
    }

    /// Zero for a brushed motor.
    const fn pole_pairs(&self) -> u16 {
        match self.drive.motor.winding {
            Winding::Brushed => 0,
            Winding::Brushless { pole_pairs } => pole_pairs,
        }
    }

    /// Electrical rad/s at the largest speed; zero for a brushed motor.
    const fn electrical_speed(&self) -> f64 {
        self.pole_pairs() as f64 * self.transducers.largest_speed
    }

    /// Checks that the current can be measured, and that the board tolerates it.
    const fn check_current(&self) -> Result<(), DriveError> {
        let (lowest, highest) = self.stage.offset_counts;
        let above = PowerStage::LARGEST_COUNT.saturating_sub(highest);
        let room = if lowest < above { lowest } else { above };
        let (current, largest) =
            (self.stage.largest_current, room as f64 * self.stage.amps_per_count);
        if current > largest {
            return Err(DriveError::CurrentRange { current, largest });
        }
        let (current, largest) = (self.current * OVER_CURRENT, self.stage.largest_current);
        if current > largest {
            let torque = self.transducers.full_scale_torque;
            return Err(DriveError::Current { torque, current, largest });
        }
        Ok(())
    }

    /// Checks that the board tolerates the supply, and that its voltage is sufficient.
    const fn check_supply(&self) -> Result<(), DriveError> {
        let (supply, board) = (self.drive.supply, self.stage.supply);
        let is_ordered = supply.lowest <= supply.highest;
        if !is_ordered || supply.lowest < board.lowest || supply.highest > board.highest {
            return Err(DriveError::Supply { supply: supply.range(), board });
        }
        if let Regeneration::Stores { voltage, .. } = supply.regeneration
            && !(voltage >= supply.lowest && voltage <= supply.highest)
        {
            return Err(DriveError::OpenVoltage { voltage, supply: supply.range() });
        }
        let (needed, part) = (self.needed_voltage(), self.part_of_supply());
        let available = supply.lowest * part;
        if needed <= available {
            Ok(())
        } else {
            Err(DriveError::Voltage { needed, available, enough: needed / part })
        }
    }

    /// Largest voltage in V that the motor needs: the model's step over the whole range of torque, at the
    /// largest speed. Both need not occur together.
    const fn needed_voltage(&self) -> f64 {
        let motor = &self.drive.motor;
        let along = self.plant.largest_voltage(self.current)
            + motor.back_emf() * self.transducers.largest_speed;
        let across = self.electrical_speed() * motor.inductance * self.current;
        Interval::exact(along * along + across * across).sqrt().hi()
    }

    /// Largest voltage at the motor as a part of the supply.
    const fn part_of_supply(&self) -> f64 {
        let dead = 2.0 * self.stage.dead_time / self.instant;
        let part = (self.span() as f64 / self.timing.counts as f64 - dead).max(0.0);
        match self.drive.motor.winding {
            Winding::Brushed => part,
            Winding::Brushless { .. } => part / ROOT_3 * (1.0 - SINE_ERROR),
        }
    }

    /// Largest difference of two compare values that are symmetric about half: with more, one low side would
    /// not conduct for long enough.
    const fn span(&self) -> u16 {
        let low = (self.stage.shortest_low + self.stage.dead_time) * self.stage.clock / 2.0;
        let low = rounded_up(low.min(self.timing.counts as f64 / 2.0 - 1.0));
        self.timing.counts - 2 * low
    }

    const fn current_loop(&self) -> CurrentLoop {
        let Self { drive, stage, transducers, timing, .. } = *self;
        let resolution = Quanta {
            plant: self.plant,
            resistance: drive.motor.resistance,
            inductance: drive.motor.inductance,
            torque_constant: drive.motor.torque_constant,
            amps_per_count: stage.amps_per_count,
            supply: drive.supply.highest,
            counts: timing.counts,
            instant: self.instant,
            dead_time: stage.dead_time,
        }
        .resolution(drive.motor.winding);
        CurrentLoop {
            winding: drive.motor.winding,
            timing,
            counter: transducers.counter,
            law: self.law(),
            output: self.output(),
            limits: self.limits(),
            turn: self.turn(),
            index: None,
            heat: self.heat_limit(),
            trip_range: stage.trip_range,
            trip_margin: self.trip_margin(),
            charging: (stage.charging / self.instant) as u32 + 1,
            instant: self.instant,
            amps_per_code: self.amps_per_code(),
            torque_constant: drive.motor.torque_constant,
            response: TorqueResponse {
                delay: self.instant,
                lag: self.lag,
                updates: timing.updates,
            },
            resolution,
            torque_source: TorqueSource::of(&drive.motor, &self.plant, self.instant, &resolution),
            bus: self.bus(),
            #[cfg(not(target_os = "none"))]
            drive: *drive,
        }
    }

    /// The capacitance at the bridge, up to the lowest voltage that may be measured as too high.
    const fn bus(&self) -> Option<Bus> {
        let Regeneration::Stores { voltage, capacitance } = self.drive.supply.regeneration else {
            return None;
        };
        let counts = self.limits().bus.1 as f64;
        let measured = Interval::exact(counts).mul(Interval::decimal(self.stage.volts_per_count));
        let largest = Interval::ONE.add(Interval::decimal(self.stage.volts_tolerance));
        Some(Bus { voltage, capacitance, fault_level: measured.div(largest).lo() })
    }

    const fn heat_limit(&self) -> Option<HeatLimit> {
        let most = self.stage.continuous_current;
        if self.current <= most {
            return None;
        }
        Some(HeatLimit {
            square: (most * most) as f32,
            codes: (most / self.amps_per_code()) as f32,
            weight: (self.instant * self.timing.updates as f64 / TIME) as f32,
        })
    }

    const fn trip_margin(&self) -> u16 {
        let current = (self.current * OVER_CURRENT * TRIP_ABOVE).max(self.stage.trip_margin);
        rounded_up(current / self.stage.trip_range.amps_per_code)
    }

    const fn turn(&self) -> Turn {
        match self.pole_pairs() {
            0 => Turn::new(1, 0),
            pole_pairs => Turn::new(self.transducers.counts_per_turn as u32, pole_pairs),
        }
    }

    const fn amps_per_code(&self) -> f64 {
        self.current / DacCode::CODES_TO_FULL_SCALE as f64
    }

    const fn law(&self) -> Law {
        let Plant { decay, gain, model_gain, feedback } = self.plant;
        let amps = self.stage.amps_per_count;
        let radians_per_count = core::f64::consts::TAU / self.transducers.counts_per_turn;
        Law {
            amps_per_code: self.amps_per_code() as f32,
            amps_per_count: if self.stage.current_lowers_count { -amps } else { amps } as f32,
            model_gain: model_gain as f32,
            decay: decay as f32,
            volts: (1.0 / gain) as f32,
            proportional: (feedback * decay / gain) as f32,
            integral: (feedback * (1.0 - decay) / gain) as f32,
            radians: (self.pole_pairs() as f64 * radians_per_count) as f32,
        }
    }

    const fn output(&self) -> Output {
        let counts = self.timing.counts as f64 / self.stage.volts_per_count;
        let span = self.span();
        // The timer counts up and down, so a compare value moves both edges.
        let dead = self.stage.dead_time * self.stage.clock;
        let circle = (span as f64 - dead) / ROOT_3 * (1.0 - SINE_ERROR);
        let dead = match self.drive.motor.winding {
            Winding::Brushed => dead,
            Winding::Brushless { .. } => dead / 2.0,
        };
        Output {
            counts_per_volt: counts as f32,
            span,
            circle: circle.max(0.0) as f32,
            dead: dead as f32,
        }
    }

    /// Instants in which a deviation must end.
    const fn settling(&self) -> u16 {
        (SETTLING / self.plant.feedback).min(u16::MAX as f64) as u16
    }

    /// Sum over the instants in A of the deviation by a change of the speed by a count in an instant: `Ke/(K R)`
    /// of that speed (theory, section 15.10).
    const fn amps_of_motion(&self) -> f64 {
        let motor = &self.drive.motor;
        let speed = core::f64::consts::TAU / (self.transducers.counts_per_turn * self.instant);
        motor.back_emf() * speed / (self.plant.feedback * motor.resistance)
    }

    const fn limits(&self) -> Limits {
        let Self { drive, stage, .. } = *self;
        // All casts round positive numbers down; the count of the lowest supply is rounded up.
        let lowest = rounded_up(drive.supply.lowest / stage.volts_per_count);
        Limits {
            over_current: (self.current * OVER_CURRENT / stage.amps_per_count) as u16,
            // A supply that reads 0 is below every range, because there is a division by it.
            bus: (
                if lowest == 0 { 1 } else { lowest },
                (drive.supply.highest / stage.volts_per_count) as u16,
            ),
            temperature: stage.thermistor.count(drive.largest_temperature),
            offsets: stage.offset_counts,
            deviation: (self.current * LARGEST_DEVIATION) as f32,
            instants: self.settling(),
            unexplained: (self.settling() as f64 * self.current * LARGEST_DEVIATION) as f32,
            amps_of_motion: self.amps_of_motion() as f32,
            smoothing: (1.0 - self.plant.decay) as f32,
            milliamps_per_count: (stage.amps_per_count * 1e3) as f32,
            millivolts_per_count: (stage.volts_per_count * 1e3) as f32,
            thermistor: stage.thermistor.table(),
        }
    }
}

const fn check_positive(drive: &Drive, transducers: &Transducers) -> Result<(), DriveError> {
    let motor = &drive.motor;
    let numbers = [
        ("motor's resistance", motor.resistance),
        ("motor's inductance", motor.inductance),
        ("motor's torque constant", motor.torque_constant),
        ("drive's bandwidth", drive.bandwidth),
        ("drive's lowest supply", drive.supply.lowest),
        ("drive's highest supply", drive.supply.highest),
        ("full-scale torque", transducers.full_scale_torque),
        ("largest speed", transducers.largest_speed),
        ("number of counts per turn", transducers.counts_per_turn),
    ];
    let mut i = 0;
    while i < numbers.len() {
        if let Err(error) = DriveError::unless_positive(numbers[i].0, numbers[i].1) {
            return Err(error);
        }
        i += 1;
    }
    match drive.supply.regeneration {
        Regeneration::Stores { capacitance, .. } => {
            DriveError::unless_positive("supply's capacitance", capacitance)
        }
        Regeneration::Sinks => Ok(()),
    }
}

/// A positive number, rounded up to a whole number.
const fn rounded_up(number: f64) -> u16 {
    let below = number as u16;
    if (below as f64) < number { below.saturating_add(1) } else { below }
}
