//! The parts around the chip of a B-G431B-ESC1, with their tolerances and sources.
//!
//! No number here comes from the firmware, so that a belief of the firmware about a part is tested against the
//! part. Sources: S: the schematic of MB1419 as a reader of it states it
//! (community.simplefoc.com/t/b-g431b-esc1-current-control/521); M: from memory, not read in the data sheet;
//! A: an assumption.

/// A value that differs from board to board, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The smallest.
    pub least: f64,
    /// The nominal value.
    pub nominal: f64,
    /// The largest.
    pub most: f64,
}

impl Part {
    const fn percent(nominal: f64, percent: f64) -> Self {
        let off = nominal * percent / 100.0;
        Self { least: nominal - off, nominal, most: nominal + off }
    }
}

/// A shunt between a low side and ground, Ω: 3 mΩ (S), 1 % (M).
pub const SHUNT: Part = Part::percent(0.003, 1.0);
/// From a shunt to the amplifier's non-inverting input, Ω (S), 1 % (A).
pub const SERIES: Part = Part::percent(1.5e3, 1.0);
/// From that input to ground, Ω (S), 1 % (A).
pub const TO_GROUND: Part = Part::percent(2.2e3, 1.0);
/// From that input to 3.3 V, Ω (S), 1 % (A).
pub const TO_SUPPLY: Part = Part::percent(22e3, 1.0);
/// Gain of an amplifier: 16 with its resistors' foot at ground (RM0440); 2 % (M) (DS12589).
pub const GAIN: Part = Part::percent(16.0, 2.0);
/// Offset of an amplifier's input, V: 3 mV over the temperature (M) (DS12589).
pub const AMPLIFIER_OFFSET: Part = Part { least: -3e-3, nominal: 0.0, most: 3e-3 };
/// Offset of a comparator, V: by so much the pin is above the reference when it trips; -9 to +3 mV (DS12589).
pub const COMPARATOR_OFFSET: Part = Part { least: -9e-3, nominal: 0.0, most: 3e-3 };
/// From the supply to the converter's pin, Ω (M), 1 % (A).
pub const DIVIDER_UPPER: Part = Part::percent(169e3, 1.0);
/// From that pin to ground, Ω (M), 1 % (A).
pub const DIVIDER_LOWER: Part = Part::percent(18e3, 1.0);
/// The thermistor at 25 °C, Ω (M), 1 % (A).
pub const THERMISTOR: Part = Part::percent(10e3, 1.0);
/// The thermistor's constant B in K (M), 1 % (A).
pub const BETA: Part = Part::percent(3455.0, 1.0);
/// From the thermistor to ground, Ω (M), 1 % (A).
pub const THERMISTOR_TO_GROUND: Part = Part::percent(4.7e3, 1.0);

/// Time constant in s with which a low side that conducts charges the supply of its high side's gate: the driver's
/// internal diode with 125 Ω (M) (L6387E) and the capacitor, 1 µF (A).
pub const BOOTSTRAP: Part = Part { least: 5e-5, nominal: 1.25e-4, most: 1e-3 };
/// Time constant in s with which it discharges (A).
pub const BOOTSTRAP_LOSS: f64 = 0.1;
/// The part of its voltage from which on the high side conducts (A).
pub const BOOTSTRAP_ENOUGH: f64 = 0.9;

/// The parts of the current sense of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sense {
    /// [`SHUNT`].
    pub shunt: f64,
    /// [`SERIES`].
    pub series: f64,
    /// [`TO_GROUND`].
    pub to_ground: f64,
    /// [`TO_SUPPLY`].
    pub to_supply: f64,
    /// [`GAIN`].
    pub gain: f64,
    /// [`AMPLIFIER_OFFSET`].
    pub amplifier_offset: f64,
    /// [`COMPARATOR_OFFSET`].
    pub comparator_offset: f64,
}

impl Sense {
    const NOMINAL: Self = Self {
        shunt: SHUNT.nominal,
        series: SERIES.nominal,
        to_ground: TO_GROUND.nominal,
        to_supply: TO_SUPPLY.nominal,
        gain: GAIN.nominal,
        amplifier_offset: AMPLIFIER_OFFSET.nominal,
        comparator_offset: COMPARATOR_OFFSET.nominal,
    };

    /// The lowest voltage behind the amplifier without a current.
    const LOWEST: Self = Self {
        series: SERIES.least,
        to_ground: TO_GROUND.least,
        to_supply: TO_SUPPLY.most,
        gain: GAIN.least,
        amplifier_offset: AMPLIFIER_OFFSET.least,
        ..Self::NOMINAL
    };

    /// The highest.
    const HIGHEST: Self = Self {
        series: SERIES.most,
        to_ground: TO_GROUND.most,
        to_supply: TO_SUPPLY.least,
        gain: GAIN.most,
        amplifier_offset: AMPLIFIER_OFFSET.most,
        ..Self::NOMINAL
    };

    const fn comparing_at(self, comparator_offset: f64) -> Self {
        Self { comparator_offset, ..self }
    }

    /// Voltage at the pin, by Kirchhoff's law at that node, for a current in A from ground to the motor
    /// through the shunt and this voltage of the chip's supply.
    pub(super) fn pin(&self, current: f64, supply: f64) -> f64 {
        let [series, to_ground, to_supply] =
            [self.series, self.to_ground, self.to_supply].map(f64::recip);
        let below_ground = self.shunt * current;
        (to_supply * supply - series * below_ground) / (series + to_ground + to_supply)
    }

    /// Change of that voltage per A, without its sign, in Ω.
    pub(super) fn pin_per_amp(&self) -> f64 {
        self.pin(0.0, 0.0) - self.pin(1.0, 0.0)
    }

    /// Voltage behind the amplifier for a voltage at the pin, without the ends of its range.
    pub(super) fn amplified(&self, pin: f64) -> f64 {
        self.gain * (pin + self.amplifier_offset)
    }
}

/// The parts of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// The current senses of the phases U, V and W.
    pub senses: [Sense; 3],
    /// [`DIVIDER_UPPER`] and [`DIVIDER_LOWER`].
    pub divider: [f64; 2],
    /// [`THERMISTOR`], [`BETA`] and [`THERMISTOR_TO_GROUND`].
    pub thermistor: [f64; 3],
    /// [`BOOTSTRAP`].
    pub bootstrap: f64,
}

impl Parts {
    /// A board with nominal parts.
    pub const NOMINAL: Self = Self {
        senses: [Sense::NOMINAL; 3],
        divider: [DIVIDER_UPPER.nominal, DIVIDER_LOWER.nominal],
        thermistor: [THERMISTOR.nominal, BETA.nominal, THERMISTOR_TO_GROUND.nominal],
        bootstrap: BOOTSTRAP.nominal,
    };

    const fn sensing(senses: [Sense; 3]) -> Self {
        Self { senses, bootstrap: BOOTSTRAP.most, ..Self::NOMINAL }
    }

    /// Boards with parts at the ends of their tolerances: the lowest and the highest counts without a current,
    /// the comparators that trip earliest and latest, alone and against each other; all with slow bootstraps.
    pub const CORNERS: [(&str, Self); 4] = {
        const EARLY: f64 = COMPARATOR_OFFSET.least;
        const LATE: f64 = COMPARATOR_OFFSET.most;
        let lowest_early = Sense::LOWEST.comparing_at(EARLY);
        let highest_late = Sense::HIGHEST.comparing_at(LATE);
        [
            ("lowest counts, comparators early", Self::sensing([lowest_early; 3])),
            ("highest counts, comparators late", Self::sensing([highest_late; 3])),
            (
                "a phase against the others",
                Self::sensing([lowest_early, highest_late, lowest_early]),
            ),
            (
                "large shunts and a small gain",
                Self::sensing([Sense { shunt: SHUNT.most, gain: GAIN.least, ..Sense::NOMINAL }; 3]),
            ),
        ]
    };
}
