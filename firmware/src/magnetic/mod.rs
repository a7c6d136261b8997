//! Drivers of magnetic absolute encoders: from the words of a transfer to an angle, or the reason why there is none.
//!
//! A [`Chip`] is data and one pure function. It knows nothing of a board, which makes a transfer of
//! [`Interface::words`] words in each period, and gives the received words to [`Chip::decode`]. [`Readings`] then
//! holds the last angle over as many failed transfers as the scene states.
//!
//! The driver crates that exist for them (`mt6701` 0.2.5, `as5048a` 0.2.1) begin each transfer in the program, by
//! `embedded-hal`, and check neither checksum nor parity of what they receive. So they do not fit a transfer that a
//! timer begins, nor a certificate that counts failed readings.
//!
//! A statement that is marked "not confirmed" was not read in a data sheet: read it there before a certificate
//! rests on it.

mod as5047p;
mod as5048a;
mod as504x;
mod checksum;
mod magalpha;
mod mt6701;
mod mt6835;
mod readings;
mod transfers;

pub use as5047p::AS5047P;
pub use as5048a::AS5048A;
pub use checksum::Checksum;
pub use magalpha::{MA600, MA702, MA732};
pub use mt6701::MT6701;
pub use mt6835::MT6835;
pub use readings::{Readings, Receiver, Rests, Unread};
pub use transfers::{AT_COUNT_CLOCK, RISE, TRANSFER_WITHIN, Transfers};

use crate::encoder::CounterWidth;
use crate::latency::Latency;
use crate::text::{Text, sentences, words};
use crate::time_range::TimeRange;

/// The most words in a transfer.
pub const LONGEST: usize = 3;

/// The words of a transfer in their order, each in the low bits; those beyond its length are 0.
pub type Frame = [u16; LONGEST];

words! {
    /// The reason why a transfer has no angle.
    ReadingError {
    /// The checksum is not that of the angle.
    Checksum "its checksum is wrong",
    /// The parity is not that of the word.
    Parity "its parity is wrong",
    /// All bits are 0: a wire at ground, or the angle zero.
    Zeros "all bits are 0",
    /// All bits are 1: no chip drives the line.
    Ones "all bits are 1",
    /// The chip reports an error.
    Flag "the chip reports an error",
    /// The magnetic field is too weak or too strong.
    Field "the magnet is too weak, too strong or lost",
    /// A chip whose readings are never at rest reads the same for long.
    Frozen "it does not change, not even by its noise",
    /// No transfer has ended in the period.
    Missing "its transfer has not ended",
    }
}

/// Clock and format of a transfer.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// Words of a transfer.
    pub words: usize,
    /// Bits of a word, 9 to 16.
    pub word_bits: u8,
    /// Whether the clock is high at rest.
    pub idle_high: bool,
    /// The highest clock in Hz.
    pub highest_clock: f64,
}

impl Interface {
    /// The smallest divider of an SPI's clock in Hz, a power of two, for at most its own clock: the power, from 1
    /// to 8.
    pub const fn divider(&self, clock: f64) -> u32 {
        let mut power = 1;
        while power < 8 && clock / (1_u32 << power) as f64 > self.highest_clock {
            power += 1;
        }
        power
    }

    /// Clocks of an SPI with this clock in Hz for the bits of a transfer.
    pub const fn clocks(&self, clock: f64) -> u32 {
        (self.words as u32 * self.word_bits as u32) << self.divider(clock)
    }
}

/// The remainder of a transfer's bits by a checksum: [`Checksum::remainder`], or a unit of the board.
pub type Remainder = fn(&Checksum, u32) -> u32;

/// A question to a chip, and the check of its answer.
pub type Diagnosis = (Frame, fn(&Frame) -> Result<(), ReadingError>);

/// A magnetic absolute encoder. A bit is taken over at the second edge of its clock, in all of them.
#[derive(Debug)]
pub struct Chip {
    /// Its name in scene files.
    pub name: &'static str,
    /// Bits of an angle.
    pub width: CounterWidth,
    /// Its transfers.
    pub interface: Interface,
    /// The words to send for an angle.
    pub command: Frame,
    /// Transfers that set it up, after power-on.
    pub set_up: &'static [Frame],
    /// The command whose answer has the state of its magnet, where no angle has it, and the reason why that answer is no
    /// good; asked after the set-up.
    pub diagnosis: Option<Diagnosis>,
    /// Time in s from power-on to its first angle.
    pub start_up: f64,
    /// Age in s of an angle when the chip samples it for a transfer.
    pub age: TimeRange,
    /// Whether a transfer has the angle that was sampled at the end of the transfer before.
    pub is_period_late: bool,
    /// Time constant in s of its filter; zero where it is not known.
    pub lag: TimeRange,
    /// Ticks in a row without a step that its noise rules out; `None` if it may be as quiet as that at rest: then
    /// nothing in its transfers tells a chip that has stopped from a handle that stands still.
    pub frozen_after: Option<u32>,
    /// Whether all bits 1 are the last angle of a turn, and not only a line that nothing drives.
    pub ones_are_angle: bool,
    /// The checksum whose remainder [`Self::decode`] asks for.
    pub checksum: Option<Checksum>,
    /// The angle of a transfer in counts, with a function for the remainder of its bits.
    pub decode: fn(&Frame, Remainder) -> Result<u32, ReadingError>,
}

impl Chip {
    /// All chips.
    pub const ALL: [&'static Self; 7] =
        [&MT6701, &MA600, &MA702, &MA732, &MT6835, &AS5048A, &AS5047P];

    /// The names of all chips.
    pub const NAMES: [&'static str; Self::ALL.len()] = {
        let mut names = [""; Self::ALL.len()];
        each!(chip in 0..Self::ALL.len() => {
            names[chip] = Self::ALL[chip].name;
        });
        names
    };

    /// Bytes of the longest name, and one.
    pub const LONGEST_NAME: usize = 8;

    /// The name, with zeros up to the length of the longest.
    pub const fn padded_name(&self) -> [u8; Self::LONGEST_NAME] {
        let (name, mut padded) = (self.name.as_bytes(), [0; Self::LONGEST_NAME]);
        each!(at in 0..name.len() => {
            padded[at] = name[at];
        });
        padded
    }

    /// The chip of this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        Self::ALL.into_iter().find(|chip| chip.name == name)
    }

    /// The same, and 0 for a chip that may be at rest.
    pub const fn frozen(&self) -> u32 {
        match self.frozen_after {
            Some(ticks) => ticks,
            None => 0,
        }
    }

    /// The angle of a transfer in counts.
    ///
    /// # Errors
    /// If it has none.
    pub fn angle(&self, frame: &Frame) -> Result<u32, ReadingError> {
        (self.decode)(frame, Checksum::remainder)
    }

    /// Counts in a turn.
    pub const fn counts_per_turn(&self) -> f64 {
        self.width.counts()
    }

    /// The age of a reading at the instant of its count, by the board's transfers.
    pub const fn age_in(&self, transfers: &Transfers) -> TimeRange {
        let TimeRange { least, most } = self.age;
        let Transfers { interval, begins, ends, .. } = *transfers;
        if self.is_period_late {
            return TimeRange::between(least + interval + ends.least, most + interval + ends.most);
        }
        TimeRange::between(least + begins.least, most + begins.most)
    }

    /// Checks that a scene's certificate covers its readings by these transfers, with `counts` in a turn.
    ///
    /// # Errors
    /// The number of the scene that is not the chip's.
    pub const fn check(
        &self,
        latency: &Latency,
        transfers: &Transfers,
        counts: f64,
    ) -> Result<(), ChipError> {
        let (chip, wanted) = (self.name, self.counts_per_turn());
        if counts != wanted {
            return Err(ChipError::Counts { chip, counts, wanted });
        }
        let (stated, age) = (latency.encoder.age, self.age_in(transfers));
        if !covers(stated, age) {
            let TimeRange { least, most } = age;
            return Err(ChipError::Age { chip, least, most, from: stated.least, to: stated.most });
        }
        let (stated, lag) = (latency.sensor_lag, self.lag);
        // Of a filter without a known shape no lag is required.
        if !lag.is_zero() && !covers(stated, lag) {
            let TimeRange { least, most } = lag;
            return Err(ChipError::Lag { chip, least, most, from: stated.least, to: stated.most });
        }
        let (phase, shortest) = (latency.stated_delay(), transfers.shortest_phase());
        if transfers.waits > 0.0 && phase > 0.0 && phase < shortest - ROUNDED {
            return Err(ChipError::Phase { chip, phase, shortest });
        }
        Ok(())
    }

    /// For constants: the same chip, or a compile error.
    #[track_caller]
    pub const fn checked(
        &'static self,
        latency: &Latency,
        transfers: &Transfers,
        counts: f64,
    ) -> &'static Self {
        crate::text::or_refuse!(self.check(latency, transfers, counts));
        self
    }
}

/// Chips are the same if their names are.
impl PartialEq for Chip {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// The rounding of times in decimal digits, in s.
const ROUNDED: f64 = 1e-9;

/// Whether a stated range has the whole of another.
const fn covers(stated: TimeRange, actual: TimeRange) -> bool {
    stated.least <= actual.least + ROUNDED && stated.most >= actual.most - ROUNDED
}

sentences! {
    /// The reason why a scene's certificate does not cover the readings of its chip.
    ChipError: Text<300> {
    Counts { chip: &'static str, counts: f64, wanted: f64 } => (
        "the encoder has " {counts} " counts in a turn, and " {chip} " has " {wanted}),
    Age { chip: &'static str, least: f64, most: f64, from: f64, to: f64 } => (
        "the readings of " {chip} " have an age anywhere between " {least} " and " {most} " s at the instant of \
         their count, and the scene states an age between " {from} " and " {to} " s: state an age that covers it"),
    Lag { chip: &'static str, least: f64, most: f64, from: f64, to: f64 } => (
        "the filter of " {chip} " has a time constant between " {least} " and " {most} " s, and the scene states a \
         lag between " {from} " and " {to} " s: state a lag that covers it"),
    Phase { chip: &'static str, phase: f64, shortest: f64 } => (
        "the scene puts a torque out " {phase} " s after its count, and a board that waits for the transfer of " {chip}
         " needs " {shortest} " s: state an output delay of at least that, or none"),
    }
}

#[cfg(test)]
mod tests;
