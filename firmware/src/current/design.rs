//! The design of a current loop, at compile time: every coefficient, rounded once.

use core::f64::consts::TAU;

use super::current_loop::{CurrentLoop, HeatLimit, Law, Limits, Output};
use super::drive::{Drive, DriveError, DriveLimits, Regeneration, Winding};
use super::modulation::PwmTiming;
use super::phase::{EncoderIndex, IndexOffset, Turn};
use super::power_stage::{PowerStage, Thermistor};
use super::regeneration::Bus;
use super::response::{CurrentResolution, Plant, TorqueSource};
use super::supervision::HEAT_TIME;
use crate::dac::DacCode;
use crate::passivity::interval::Interval;
use crate::text::or_refuse;
use crate::transducers::Transducers;

/// Over-current, as a multiple of the current of full-scale torque: a step stays below it in a motor whose
/// resistance and inductance differ by a third.
pub(super) const OVER_CURRENT: f64 = 1.25;

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

/// The same with the phase from the index: its pulse is up to [`WIDTH`](super::phase::WIDTH) counts wide and
/// comes from either side, and the offset is rounded by up to half a count. With 256 counts the error is 0.11 rad,
/// which reduces the torque by 0.6 per cent.
const LEAST_COUNTS_WITH_INDEX: f64 = 256.0;

/// Largest number of counts per turn of a brushless motor's encoder, so that a turn fits 24 bits.
const LARGEST_COUNTS: f64 = (1 << 24) as f64;

/// Smallest number of instants in an electrical turn: the phase then moves by at most 0.3 rad from a sample
/// to the middle of its voltage, where two terms of its sine and cosine are enough.
const INSTANTS_PER_TURN: f64 = 32.0;

/// Largest relative increase of a vector's length by the errors of sine and cosine.
const SINE_ERROR: f64 = 2e-4;

const ROOT_3: f64 = 1.732_050_807_568_877_2;

impl CurrentLoop {
    /// The same loop with an index at the motor's encoder.
    ///
    /// # Errors
    /// If the motor is brushed, or the offset is not within a turn of its encoder.
    pub const fn indexed(mut self, index: EncoderIndex) -> Result<Self, DriveError> {
        if !self.is_brushless() {
            return Err(DriveError::IndexNotNeeded);
        }
        if let Some(offset) = index.offset {
            ok!(self.winding.check_offset(offset, self.turn.counts as f64));
        }
        self.index = Some(index);
        Ok(self)
    }

    /// For constants: a compile error if the index does not fit this motor's encoder.
    #[must_use]
    #[track_caller]
    pub const fn with_index(self, index: EncoderIndex) -> Self {
        or_refuse!(self.indexed(index))
    }
}

impl Winding {
    /// Checks that an encoder with this many counts in a turn is fine enough for the motor's phase.
    ///
    /// # Errors
    /// If a brushless motor has no pole pairs, or too many.
    pub const fn check_pole_pairs(self, counts_per_turn: f64) -> Result<(), DriveError> {
        let Self::Brushless { pole_pairs } = self else { return Ok(()) };
        let largest = (counts_per_turn / LEAST_ELECTRICAL_COUNTS).min(u16::MAX as f64) as u16;
        if pole_pairs == 0 || pole_pairs > largest {
            return Err(DriveError::PolePairs { pole_pairs, largest });
        }
        Ok(())
    }

    /// Checks the offset of a brushless motor's index, at an encoder with this many counts in a turn.
    ///
    /// # Errors
    /// If it is not within an electrical turn, or the encoder is too coarse for it.
    pub const fn check_offset(
        self,
        offset: IndexOffset,
        counts_per_turn: f64,
    ) -> Result<(), DriveError> {
        let counts = counts_per_turn / self.pole_pairs() as f64;
        let (least, offset) = (LEAST_COUNTS_WITH_INDEX, offset.counts);
        if counts < least {
            return Err(DriveError::IndexCounts { counts, least });
        }
        if offset as f64 >= counts {
            return Err(DriveError::IndexOffset { offset, counts });
        }
        Ok(())
    }
}

/// The checked numbers, in SI units.
pub(super) struct Design<'a> {
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
    pub(super) const fn of(
        drive: &'a Drive,
        stage: &'a PowerStage,
        transducers: &'a Transducers,
        period: f64,
    ) -> Result<Self, DriveError> {
        ok!(check_positive(drive, transducers));
        let timing = ok!(PwmTiming::of(period, stage.clock));
        let (instant, lag) = (timing.instant(period), 1.0 / (TAU * drive.bandwidth));
        let current = transducers.full_scale_torque / drive.motor.torque_constant;
        let plant = Plant::of(&drive.motor, lag, instant);
        Ok(Self { drive, stage, transducers, timing, instant, lag, current, plant })
    }

    pub(super) const fn check(&self) -> Result<(), DriveError> {
        ok!(self.check_winding());
        let (bandwidth, largest) = (self.drive.bandwidth, 1.0 / (2.0 * TAU * self.instant));
        if bandwidth > largest {
            return Err(DriveError::Bandwidth { bandwidth, largest, limits: DriveLimits::NONE });
        }
        ok!(self.check_current());
        ok!(self.check_supply());
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
        let (winding, counts) = (self.drive.motor.winding, self.transducers.counts_per_turn);
        if !winding.is_brushless() {
            return Ok(());
        }
        if counts > LARGEST_COUNTS || (counts as u32) as f64 != counts {
            return Err(DriveError::Counts { counts, largest: LARGEST_COUNTS });
        }
        ok!(winding.check_pole_pairs(counts));
        let turns = self.electrical_speed() / TAU;
        let largest = 1.0 / (INSTANTS_PER_TURN * self.instant);
        if turns > largest {
            return Err(DriveError::ElectricalSpeed { turns, largest, limits: DriveLimits::NONE });
        }
        Ok(())
    }

    /// Electrical rad/s at the largest speed; zero for a brushed motor.
    const fn electrical_speed(&self) -> f64 {
        self.drive.motor.winding.pole_pairs() as f64 * self.transducers.largest_speed
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
            return Err(DriveError::Current {
                torque,
                current,
                largest,
                limits: DriveLimits::NONE,
            });
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
        let needed = self.needed_voltage();
        let available = supply.lowest * self.part_of_supply();
        if needed <= available {
            Ok(())
        } else {
            let (enough, limits) = (self.enough_voltage(), DriveLimits::NONE);
            Err(DriveError::Voltage { needed, available, enough, limits })
        }
    }

    /// The lowest supply in V with the largest voltage that the motor needs.
    pub(super) const fn enough_voltage(&self) -> f64 {
        self.needed_voltage() / self.part_of_supply()
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

    pub(super) const fn current_loop(&self) -> CurrentLoop {
        let Self { drive, stage, transducers, timing, .. } = *self;
        let resolution =
            CurrentResolution::of(drive, stage, &self.plant, timing.counts, self.instant);
        let torque_source = TorqueSource::of(&drive.motor, &self.plant, self.instant, &resolution);
        CurrentLoop {
            winding: drive.motor.winding,
            timing,
            counter: transducers.counter,
            law: self.law(),
            output: self.output(),
            limits: self.limits(&torque_source),
            turn: self.turn(),
            index: None,
            heat: self.heat_limit(),
            trip_range: stage.trip_range,
            trip_margin: self.trip_margin(),
            charging: (stage.charging / self.instant) as u32 + 1,
            lag: self.lag,
            amps_per_code: self.amps_per_code(),
            torque_constant: drive.motor.torque_constant,
            resolution,
            torque_source,
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
        let counts = self.bus_counts().1 as f64;
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
            weight: (self.instant * self.timing.updates as f64 / HEAT_TIME) as f32,
        })
    }

    const fn trip_margin(&self) -> u16 {
        let current = (self.current * OVER_CURRENT * TRIP_ABOVE).max(self.stage.trip_margin);
        rounded_up(current / self.stage.trip_range.amps_per_code)
    }

    const fn turn(&self) -> Turn {
        match self.drive.motor.winding.pole_pairs() {
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
        let radians_per_count = TAU / self.transducers.counts_per_turn;
        Law {
            amps_per_code: self.amps_per_code() as f32,
            amps_per_count: if self.stage.current_lowers_count { -amps } else { amps } as f32,
            model_gain: model_gain as f32,
            decay: decay as f32,
            volts: (1.0 / gain) as f32,
            proportional: (feedback * decay / gain) as f32,
            integral: (feedback * (1.0 - decay) / gain) as f32,
            radians: (self.drive.motor.winding.pole_pairs() as f64 * radians_per_count) as f32,
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

    /// Lowest and highest count of the supply: rounded up, and down by its cast.
    const fn bus_counts(&self) -> (u16, u16) {
        let (supply, volts) = (&self.drive.supply, self.stage.volts_per_count);
        let lowest = rounded_up(supply.lowest / volts);
        // A supply that reads 0 is below every range, because there is a division by it.
        (if lowest == 0 { 1 } else { lowest }, (supply.highest / volts) as u16)
    }

    const fn limits(&self, torque_source: &TorqueSource) -> Limits {
        let Self { drive, stage, transducers, .. } = *self;
        let speed_of_a_count = TAU / (transducers.counts_per_turn * self.instant);
        // All casts round positive numbers down.
        Limits {
            over_current: (self.current * OVER_CURRENT / stage.amps_per_count) as u16,
            bus: self.bus_counts(),
            temperature: stage.thermistor.count(drive.largest_temperature),
            offsets: stage.offset_counts,
            deviation: (self.current * LARGEST_DEVIATION) as f32,
            instants: self.settling(),
            unexplained: (self.settling() as f64 * self.current * LARGEST_DEVIATION) as f32,
            amps_of_motion: torque_source
                .deviation_by(drive.motor.torque_constant, speed_of_a_count)
                as f32,
            smoothing: (1.0 - self.plant.decay) as f32,
            milliamps_per_count: (stage.amps_per_count * 1e3) as f32,
            millivolts_per_count: (stage.volts_per_count * 1e3) as f32,
            thermistor: stage.thermistor.table(),
        }
    }
}

const fn check_positive(drive: &Drive, transducers: &Transducers) -> Result<(), DriveError> {
    let motor = &drive.motor;
    ok!(DriveError::unless_positive(&[
        ("motor's resistance", motor.resistance),
        ("motor's inductance", motor.inductance),
        ("motor's torque constant", motor.torque_constant),
        ("drive's bandwidth", drive.bandwidth),
        ("drive's lowest supply", drive.supply.lowest),
        ("drive's highest supply", drive.supply.highest),
        ("full-scale torque", transducers.full_scale_torque),
        ("largest speed", transducers.largest_speed),
        ("number of counts per turn", transducers.counts_per_turn),
    ]));
    match drive.supply.regeneration {
        Regeneration::Stores { capacitance, .. } => {
            DriveError::unless_positive(&[("supply's capacitance", capacitance)])
        }
        Regeneration::Sinks => Ok(()),
    }
}

/// A positive number, rounded up to a whole number.
const fn rounded_up(number: f64) -> u16 {
    let below = number as u16;
    if (below as f64) < number { below.saturating_add(1) } else { below }
}
