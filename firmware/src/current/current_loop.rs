//! A current loop: every coefficient that an instant needs, and its numbers for a program.

#[cfg(not(target_os = "none"))]
use super::drive::Drive;
use super::drive::Winding;
use super::modulation::{Duties, PwmTiming};
use super::phase::{EncoderIndex, IndexOffset, OffsetCheck, Turn};
use super::power_stage::{PowerStage, ThermistorTable, TripRange};
use super::regeneration::Bus;
use super::response::{CurrentResolution, TorqueResponse, TorqueSource};
use crate::dac::DacCode;
use crate::encoder::CounterWidth;
use crate::power_reading::PowerReading;

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
    pub(super) trip_range: TripRange,
    /// Codes between the trip of a comparator without a current and its threshold.
    pub(super) trip_margin: u16,
    /// Instants in which the low sides charge the supplies of the high sides' gates.
    pub(super) charging: u32,
    /// Time constant in s of the model.
    pub(super) lag: f64,
    pub(super) amps_per_code: f64,
    pub(super) torque_constant: f64,
    pub(super) resolution: CurrentResolution,
    pub(super) torque_source: TorqueSource,
    /// `None` for a supply that takes energy back.
    pub(super) bus: Option<Bus>,
    /// Not in the program of a board, which does not use it: each controller has a copy of this structure.
    #[cfg(not(target_os = "none"))]
    pub(super) drive: Drive,
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
    /// Current in A of full-scale torque.
    #[inline(always)]
    pub(super) const fn full_scale(&self) -> f32 {
        self.amps_per_code * DacCode::CODES_TO_FULL_SCALE as f32
    }

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

/// The limit of a current loop whose full-scale current is above the continuous current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeatLimit {
    /// Square of the continuous current in A^2.
    pub square: f32,
    /// The continuous current in codes.
    pub codes: f32,
    /// Weight of a period of the servo in the mean.
    pub weight: f32,
}

impl CurrentLoop {
    /// The motor and the supply, which a simulation needs.
    #[cfg(not(target_os = "none"))]
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// The kind of the motor's winding.
    pub const fn winding(&self) -> Winding {
        self.winding
    }

    /// Whether the motor has three phases and magnets.
    pub const fn is_brushless(&self) -> bool {
        self.winding.is_brushless()
    }

    /// Phases that the motor is wired to.
    pub const fn phases(&self) -> usize {
        if self.is_brushless() { 3 } else { 2 }
    }

    /// Reload value of the modulation's timer, which counts up and down.
    pub const fn timer_counts(&self) -> u16 {
        self.timing.counts
    }

    /// Instants in a period of the servo.
    pub const fn updates(&self) -> u16 {
        self.timing.updates
    }

    /// Clock counts in a period of the servo: the timer counts up and down in each instant.
    pub const fn clock_counts(&self) -> u32 {
        2 * self.timer_counts() as u32 * self.updates() as u32
    }

    /// Period of the modulation in s.
    pub(super) const fn instant(&self) -> f64 {
        self.torque_source.instant
    }

    /// The time response for the certificate.
    pub const fn response(&self) -> TorqueResponse {
        TorqueResponse { delay: self.instant(), lag: self.lag, updates: self.updates() }
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

    /// Instants in which the low sides conduct before the first high side.
    pub const fn charging_instants(&self) -> u32 {
        self.charging
    }

    /// Periods of the servo from switching on until the current follows the code: the search for the
    /// comparators' thresholds, the charging, and the check of a stated offset of the index.
    pub const fn start_up_ticks(&self) -> u32 {
        // Two instants for the beginnings of both, and one tick until the request is seen.
        let checking = match self.index_offset() {
            Some(_) => OffsetCheck::instants(self.instant()) + 2,
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

    /// Compare values of a duty, which is the part of the supply from U to V, from -1 to 1: the nearest
    /// values that leave the low sides their time.
    pub const fn duties_at(&self, duty: f64) -> Duties {
        let span = self.output.span as f32;
        let difference = duty as f32 * self.timing.counts as f32;
        self.timing.between_two(difference.clamp(-span, span))
    }

    /// Current in A between U and V, from the difference of the two phases' counts above those without a
    /// current.
    pub const fn current_between_two(&self, difference: f32) -> f32 {
        self.law.between_two(difference)
    }

    /// Whether the program states an index.
    pub const fn has_index(&self) -> bool {
        self.index.is_some()
    }

    /// The phase of the motor at the index, if the program states it.
    pub const fn index_offset(&self) -> Option<IndexOffset> {
        match self.index {
            Some(index) => index.offset,
            None => None,
        }
    }

    /// The reading, without an index, from a current in A, the servo's last code by
    /// [`DacCode::offset`](crate::dac::DacCode::offset), and the counts of supply and temperature. For the
    /// host; the current interrupt does not use it.
    pub fn power_reading(
        &self,
        current: f32,
        code_offset: i16,
        (bus, temperature): (u16, u16),
    ) -> PowerReading {
        let reference = self.law.amps_per_code * f32::from(code_offset);
        PowerReading {
            current: nearest_milliamps(current),
            reference: nearest_milliamps(reference),
            // The cast rounds a positive number down.
            voltage: (f32::from(bus) * self.limits.millivolts_per_count + 0.5) as u32,
            temperature: self.limits.thermistor.tenths(temperature),
            index: None,
        }
    }
}

/// The nearest whole number of mA; casts round towards zero.
fn nearest_milliamps(amps: f32) -> i32 {
    let milliamps = amps * 1e3;
    (milliamps + 0.5_f32.copysign(milliamps)) as i32
}
