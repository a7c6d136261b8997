//! The filter of an encoder's inputs: the longest that the encoder's fastest edges allow.

use core::f64::consts::TAU;

use crate::servo::Transducers;
use crate::text::{Text, error_with_sentence, or_refuse, push};

/// A filter of an STM32 timer's input: a level counts after this many equal samples in a row, so shorter
/// pulses are removed.
///
/// ```
/// use haptic_servo::board::input_filter::InputFilter;
/// use haptic_servo::encoder::CounterWidth;
/// use haptic_servo::servo::Transducers;
///
/// const ENCODER: Transducers = Transducers {
///     counts_per_turn: 61_440.0,
///     counter: CounterWidth::Bits16,
///     full_scale_torque: 2.0,
///     largest_speed: 100.0,
/// };
/// // A million counts a second: a pulse shorter than 0.19 us is a spike.
/// const FILTER: InputFilter = InputFilter::of_encoder(&ENCODER, 170e6);
/// assert_eq!((FILTER.bits(), FILTER.clocks()), (7, 32));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputFilter(u8);

/// Timer clocks that a level must last, by the setting ICxF (RM0440, 31.5.8; RM0090, 18.4.7), with the
/// undivided timer clock for sampling.
const CLOCKS: [u16; 16] = [0, 2, 4, 8, 12, 16, 24, 32, 48, 64, 80, 96, 128, 160, 192, 256];

/// The part of a count's time that a filter may take: the edges of good encoders are off by up to half a
/// count, and a filter takes half of the remaining time.
const PART: f64 = 0.25;

impl InputFilter {
    /// The longest filter that passes every edge of an encoder, in a timer whose clock is in Hz.
    ///
    /// # Errors
    /// If edges can be too fast for the shortest filter.
    pub const fn new(transducers: &Transducers, clock: f64) -> Result<Self, TooFast> {
        let rate = transducers.counts_per_turn / TAU * transducers.largest_speed;
        let most = PART * clock / rate;
        let mut bits = CLOCKS.len() - 1;
        while bits > 0 {
            // Written so that NaN satisfies no condition.
            if CLOCKS[bits] as f64 <= most {
                return Ok(Self(bits as u8));
            }
            bits -= 1;
        }
        Err(TooFast { rate, largest: PART * clock / CLOCKS[1] as f64 })
    }

    /// The same for a constant: an encoder that is too fast is a compile error.
    #[track_caller]
    pub const fn of_encoder(transducers: &Transducers, clock: f64) -> Self {
        or_refuse!(Self::new(transducers, clock))
    }

    /// The setting ICxF.
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Timer clocks that a level must last.
    pub const fn clocks(self) -> u16 {
        CLOCKS[self.0 as usize]
    }
}

/// An encoder with edges too fast for every filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooFast {
    /// Counts per second at the largest speed.
    pub rate: f64,
    /// The largest rate that the shortest filter passes, in counts per second.
    pub largest: f64,
}

impl TooFast {
    /// The error as a sentence.
    pub const fn sentence(&self) -> Text<200> {
        let mut t = Text::new();
        push!(t,
            "counts_per_turn and largest_speed allow " {self.rate} " counts a second; the shortest filter of this \
             board's encoder inputs passes " {self.largest} ": state the speed that the device can reach, or use \
             fewer counts");
        t
    }
}

error_with_sentence!(TooFast);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoder::CounterWidth;

    fn encoder(counts_per_turn: f64, largest_speed: f64) -> Transducers {
        let (counter, full_scale_torque) = (CounterWidth::Bits32, 1.0);
        Transducers { counts_per_turn, counter, full_scale_torque, largest_speed }
    }

    #[test]
    fn is_the_longest_that_leaves_three_quarters_of_the_shortest_count() {
        for clock in [84e6, 170e6] {
            for rate in [1e3, 5e4, 2e5, 9.8e5, 2e6, 1e7] {
                let filter = InputFilter::new(&encoder(TAU * 10.0, rate / 10.0), clock).unwrap();
                let taken = |clocks: u16| f64::from(clocks) / clock * rate;
                assert!(taken(filter.clocks()) <= PART + 1e-12, "{clock}, {rate}: {filter:?}");
                let longer = CLOCKS.get(usize::from(filter.bits()) + 1);
                assert!(longer.is_none_or(|&longer| taken(longer) > PART), "{clock}, {rate}");
            }
        }
        assert!(CLOCKS.is_sorted());
    }

    #[test]
    fn an_encoder_that_is_too_fast_is_refused_with_its_numbers() {
        let error = InputFilter::new(&encoder(4e5, 200.0), 84e6).unwrap_err();
        assert_eq!(error.largest, 10.5e6);
        assert!(
            error.sentence().as_str().starts_with(
                "counts_per_turn and largest_speed allow 12732395.45 counts a second; the shortest \
             filter of this board's encoder inputs passes 10500000"
            ),
            "{}",
            error.sentence().as_str()
        );
        for wrong in [f64::NAN, f64::INFINITY] {
            assert!(InputFilter::new(&encoder(4e5, wrong), 84e6).is_err());
        }
    }
}
