//! A motor, its supply, and the bandwidth of its current loop, as a program states them; and the reasons why it
//! cannot run on a power stage.

use super::power_stage::SupplyRange;
use crate::text::{Piece, Text, push, sentences};

/// The kind of a motor's winding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winding {
    /// One winding and a commutator, between the phases U and V.
    Brushed,
    /// Three windings in a star, and magnets.
    Brushless {
        /// Electrical turns in a turn of the handle: the pole pairs of the motor, times its gearing.
        pole_pairs: u16,
    },
}

impl Winding {
    /// Whether the motor has three phases and magnets.
    pub const fn is_brushless(self) -> bool {
        matches!(self, Self::Brushless { .. })
    }

    /// Electrical turns in a turn of the handle; zero for a brushed motor.
    pub const fn pole_pairs(self) -> u16 {
        match self {
            Self::Brushed => 0,
            Self::Brushless { pole_pairs } => pole_pairs,
        }
    }
}

/// The data of a motor for its current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// The kind of its winding.
    pub winding: Winding,
    /// Resistance in ohm: between the terminals of a brushed motor, of one phase of a brushless motor, which
    /// is half of the resistance between two of its terminals.
    pub resistance: f64,
    /// Inductance in H, of the same.
    pub inductance: f64,
    /// Torque at the handle in N m/A: of a brushless motor per ampere of a phase current's amplitude.
    pub torque_constant: f64,
}

impl Motor {
    /// Induced voltage in V s/rad of the handle's speed: between the terminals of a brushed motor; for a
    /// brushless motor the amplitude in a phase, where each phase has 2/3 of a direct current's power.
    pub const fn back_emf(&self) -> f64 {
        match self.winding {
            Winding::Brushed => self.torque_constant,
            Winding::Brushless { .. } => self.torque_constant * 2.0 / 3.0,
        }
    }
}

/// A supply: the range of its voltage in V, and what becomes of the energy that the motor returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// The lowest voltage, under load.
    pub lowest: f64,
    /// The highest voltage, when the motor feeds it: above this, over-voltage is a fault.
    pub highest: f64,
    /// What becomes of the energy that the motor returns.
    pub regeneration: Regeneration,
}

/// What becomes of the energy that a motor returns to its supply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Regeneration {
    /// The supply takes it and keeps its voltage: a battery, or a brake resistor with its own switch.
    Sinks,
    /// The supply takes nothing: the energy stays in the capacitance at the bridge, and its voltage rises.
    Stores {
        /// The highest voltage in V that the supply itself delivers, with its tolerance.
        voltage: f64,
        /// The least capacitance in F, with its tolerance and at the end of its life.
        capacitance: f64,
    },
}

impl Supply {
    /// A supply that takes energy back, with this lowest and highest voltage in V.
    pub const fn sinking(lowest: f64, highest: f64) -> Self {
        Self { lowest, highest, regeneration: Regeneration::Sinks }
    }

    /// The range of its voltage.
    pub const fn range(&self) -> SupplyRange {
        SupplyRange { lowest: self.lowest, highest: self.highest }
    }

    /// Voltage in V while the motor returns nothing: the supply's own, or the middle of its range.
    pub const fn open_voltage(&self) -> f64 {
        match self.regeneration {
            Regeneration::Sinks => 0.5 * (self.lowest + self.highest),
            Regeneration::Stores { voltage, .. } => voltage,
        }
    }
}

/// The motor at a power stage, and the required speed of the current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// The motor.
    pub motor: Motor,
    /// Its supply.
    pub supply: Supply,
    /// Bandwidth in Hz of the reference model that the current follows.
    pub bandwidth: f64,
    /// Temperature in degrees Celsius at the power stage's sensor above which it is switched off.
    pub largest_temperature: f64,
}

/// The bounds of a drive's numbers, everything else as stated, in three digits on the side that passes; `None`
/// where no value passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// Largest bandwidth in Hz.
    pub bandwidth: Option<f64>,
    /// Largest full-scale torque in N m.
    pub torque: Option<f64>,
    /// Largest speed in rad/s.
    pub speed: Option<f64>,
    /// Least voltage in V of the lowest supply.
    pub supply: Option<f64>,
    /// Bandwidth, torque and speed, all lower or higher than stated by the same factor.
    pub together: Option<[f64; 3]>,
}

/// Longest sentence of an error.
const SENTENCE: usize = 640;

sentences! {
    /// The reason why there is no current loop, with the value and its bound.
    DriveError: Text<SENTENCE> {
    NotPositive { name: &'static str, value: f64 } => (
        "the " {name} " must be positive and finite, and is " {value}),
    PolePairs { pole_pairs: u16, largest: u16 } => (
        "the motor's " {pole_pairs} " pole pairs must be at least 1, and at most as many as leave an \
         electrical turn 64 encoder counts, so that no torque is lost between two of them: " {largest}),
    Counts { counts: f64, largest: f64 } => (
        "a turn has " {counts} " encoder counts, and the phase of a brushless motor needs a whole number of \
         them, up to " {largest} ": count at the shaft that the motor is on"),
    IndexNotNeeded => (
        "a brushed motor needs no index of its encoder: state none, or the winding of a brushless one"),
    IndexCounts { counts: f64, least: f64 } => (
        "an electrical turn has " {counts} " encoder counts, and a phase that comes from the index needs at \
         least " {least} ", since its pulse is some counts wide: take a finer encoder, or state no offset"),
    IndexOffset { offset: u32, counts: f64 } => (
        "the index offset of " {offset} " counts is not below the counts of an electrical turn, " {counts}
        ": align the motor, and state the offset that the board tells"),
    ElectricalSpeed { turns: f64, largest: f64, limits: DriveLimits } => (
        "at the largest speed the motor makes " {turns} " electrical turns a second, and a 32nd of the \
         modulation's frequency is " {largest} {limits}),
    Bandwidth { bandwidth: f64, largest: f64, limits: DriveLimits } => (
        "the bandwidth of " {bandwidth} " Hz is above " {largest} " Hz, where the time constant of the \
         current is two periods of the modulation, and a faster one leaves the feedback no time" {limits}),
    Period { period: f64, lowest: f64, highest: f64, nearest: f64 } => (
        "the period of " {period} " s is not filled by whole periods of a modulation between " {lowest}
        " and " {highest} " Hz in whole counts of its timer: " {nearest} " s is"),
    Current { torque: f64, current: f64, largest: f64, limits: DriveLimits } => (
        "full-scale torque of " {torque} " N m, and the quarter more at which over-current trips, take "
        {current} " A, and the power stage measures and bears " {largest} " A" {limits}),
    Supply { supply: SupplyRange, board: SupplyRange } => (
        "a supply from " {supply.lowest} " to " {supply.highest} " V is not in the board's range from "
        {board.lowest} " to " {board.highest} " V"),
    OpenVoltage { voltage: f64, supply: SupplyRange } => (
        "the supply itself delivers up to " {voltage} " V, which must be between its lowest and its highest \
         voltage, " {supply.lowest} " and " {supply.highest} " V"),
    Voltage { needed: f64, available: f64, enough: f64, limits: DriveLimits } => (
        "the step from full-scale torque to its opposite at the largest speed needs " {needed} " V at \
         the motor, which takes a supply of " {enough} " V, and the lowest supply gives " {available} " V" {limits}),
    Temperature { temperature: f64, lowest: f64, highest: f64 } => (
        "the largest temperature of " {temperature} " degrees Celsius is not between " {lowest} " and " {highest}),
    /// The age includes that of readings that may be dropped.
    Age { age: f64, turned: f64, most: f64, largest: f64 } => (
        "the readings of the encoder are up to " {age} " s old, in which the phase of the motor makes " {turned}
        " turns at the largest speed, and with more than " {most} " too much torque is lost: an age of " {largest}
        " s, dropped readings included, would pass, or a lower largest speed"),
    /// The range ends at the worst offset.
    CurrentRange { current: f64, largest: f64 } => (
        "the board's largest current of " {current} " A is above the " {largest} " A that its converter can measure"),
    }
}

impl DriveLimits {
    /// No bounds.
    pub const NONE: Self =
        Self { bandwidth: None, torque: None, speed: None, supply: None, together: None };
}

/// The bounds in words, after a sentence that refuses the drive.
impl Piece<DriveLimits> {
    const fn push_to(self, text: &mut Text<SENTENCE>) {
        let DriveLimits { bandwidth, torque, speed, supply, together } = self.0;
        let each = [
            ("a bandwidth of at most ", bandwidth, " Hz"),
            ("a full-scale torque of at most ", torque, " N m"),
            ("a largest speed of at most ", speed, " rad/s"),
            ("a lowest supply of at least ", supply, " V"),
        ];
        let mut before = ": it would pass with ";
        each!(i in 0..each.len() => {
            let (name, bound, unit) = each[i];
            if let Some(bound) = bound {
                push!(*text, {before} {name} {bound} {unit});
                before = ", or ";
            }
        });
        let alone = bandwidth.is_some() as u8 + torque.is_some() as u8 + speed.is_some() as u8;
        // Where one number alone is too large, the others need not be lower.
        if let Some([bandwidth, torque, speed]) = together
            && alone != 1
        {
            push!(*text, {before} {bandwidth} " Hz, " {torque} " N m and " {speed} " rad/s together");
        }
    }
}

impl DriveError {
    /// The same error with the bounds of the drive's numbers.
    #[must_use]
    pub const fn with_limits(mut self, found: DriveLimits) -> Self {
        match &mut self {
            Self::ElectricalSpeed { limits, .. }
            | Self::Bandwidth { limits, .. }
            | Self::Current { limits, .. }
            | Self::Voltage { limits, .. } => *limits = found,
            _ => {}
        }
        self
    }

    /// Rejects the first of these numbers that is not positive and finite.
    pub(super) const fn unless_positive(numbers: &[(&'static str, f64)]) -> Result<(), Self> {
        let mut i = 0;
        while i < numbers.len() {
            let (name, value) = numbers[i];
            if !(value > 0.0 && value.is_finite()) {
                return Err(Self::NotPositive { name, value });
            }
            i += 1;
        }
        Ok(())
    }
}
