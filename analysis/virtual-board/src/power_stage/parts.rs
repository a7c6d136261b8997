//! The parts around the chip of a B-G431B-ESC1, with their tolerances and sources, in SI units.
//!
//! No number here comes from the firmware, so that a belief of the firmware about a part is tested against the
//! part. Sources: S: the schematic of MB1419 as a reader of it states it
//! (community.simplefoc.com/t/b-g431b-esc1-current-control/521); M: from memory, not read in the data sheet;
//! A: an assumption.

/// Time constant with which a low side that conducts charges the supply of its high side's gate: the driver's
/// internal diode with 125 Ω (M) (L6387E) and the capacitor, 1 µF (A); and the longest.
const BOOTSTRAP: f64 = 1.25e-4;
const LONGEST_BOOTSTRAP: f64 = 1e-3;
/// Time constant with which it discharges (A).
pub const BOOTSTRAP_LOSS: f64 = 0.1;
/// The part of its voltage from which on the high side conducts (A).
pub const BOOTSTRAP_ENOUGH: f64 = 0.9;

/// The parts of the current sense of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sense {
    /// A shunt between a low side and ground: 3 mΩ (S), 1 % (M).
    pub shunt: f64,
    /// From a shunt to the amplifier's non-inverting input (S), 1 % (A).
    pub series: f64,
    /// From that input to ground (S), 1 % (A).
    pub to_ground: f64,
    /// From that input to 3.3 V (S), 1 % (A).
    pub to_supply: f64,
    /// Gain of the amplifier: 16 with its resistors' foot at ground (RM0440); 2 % (M) (DS12589).
    pub gain: f64,
    /// Offset of the amplifier's input: 3 mV over the temperature (M) (DS12589).
    pub amplifier_offset: f64,
    /// Offset of the comparator: by so much the pin is above the reference when it trips; -9 to +3 mV (DS12589).
    pub comparator_offset: f64,
}

impl Sense {
    const NOMINAL: Self = Self::lifted(0.0);

    /// Parts that are off by so many times their tolerances, each in the direction that lifts the voltage behind
    /// the amplifier without a current.
    const fn lifted(times: f64) -> Self {
        Self {
            shunt: 0.003,
            series: 1.5e3 * (1.0 + 0.01 * times),
            to_ground: 2.2e3 * (1.0 + 0.01 * times),
            to_supply: 22e3 * (1.0 - 0.01 * times),
            gain: 16.0 * (1.0 + 0.02 * times),
            amplifier_offset: 3e-3 * times,
            comparator_offset: 0.0,
        }
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
    /// From the supply to the converter's pin, and from there to ground (M).
    pub divider: [f64; 2],
    /// The thermistor at 25 °C, its constant B in K, and from it to ground (M).
    pub thermistor: [f64; 3],
    /// Time constant of the supplies of the high sides' gates.
    pub bootstrap: f64,
}

impl Parts {
    /// A board with nominal parts.
    pub const NOMINAL: Self = Self {
        senses: [Sense::NOMINAL; 3],
        divider: [169e3, 18e3],
        thermistor: [10e3, 3455.0, 4.7e3],
        bootstrap: BOOTSTRAP,
    };

    const fn sensing(senses: [Sense; 3]) -> Self {
        Self { senses, bootstrap: LONGEST_BOOTSTRAP, ..Self::NOMINAL }
    }

    /// Boards with parts at the ends of their tolerances: the lowest and the highest counts without a current,
    /// the comparators that trip earliest and latest, alone and against each other; all with slow bootstraps.
    pub const CORNERS: [(&str, Self); 4] = {
        let lowest_early = Sense { comparator_offset: -9e-3, ..Sense::lifted(-1.0) };
        let highest_late = Sense { comparator_offset: 3e-3, ..Sense::lifted(1.0) };
        let (shunt, gain) = (0.003 * 1.01, 16.0 * 0.98);
        [
            ("lowest counts, comparators early", Self::sensing([lowest_early; 3])),
            ("highest counts, comparators late", Self::sensing([highest_late; 3])),
            (
                "a phase against the others",
                Self::sensing([lowest_early, highest_late, lowest_early]),
            ),
            (
                "large shunts and a small gain",
                Self::sensing([Sense { shunt, gain, ..Sense::NOMINAL }; 3]),
            ),
        ]
    };
}
