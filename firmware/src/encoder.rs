//! Extends a wrapping counter to a position that does not wrap.

use core::hint::cold_path;

/// A counter of the steps of a quadrature encoder.
pub trait Encoder {
    /// Reads the counter.
    fn read(&mut self) -> RawCount;
}

/// Number of bits after which the counter wraps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum CounterWidth {
    /// A 32-bit timer.
    Bits32 = 0,
    /// A 16-bit timer, or an angle of as many bits.
    Bits16 = 16,
    /// An angle of 14 bits.
    Bits14 = 18,
    /// An angle of 21 bits.
    Bits21 = 11,
}

impl CounterWidth {
    /// Its bits.
    pub const fn mask(self) -> u32 {
        u32::MAX >> self as u32
    }

    /// Counts after which the counter wraps.
    pub const fn counts(self) -> f64 {
        self.mask() as f64 + 1.0
    }
}

/// A counter's content, in its low bits; bits above the counter's width are ignored.
///
/// ```
/// use haptic_servo::encoder::RawCount;
/// assert_eq!(RawCount::from(-1_i16), RawCount::from(0xffff_u16));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawCount(u32);

impl RawCount {
    /// The content, with bits above the counter's width.
    #[inline(always)]
    pub const fn bits(self) -> u32 {
        self.0
    }
}

macro_rules! counts {
    ($($integer:ty: |$count:ident| $bits:expr;)*) => {$(
        impl From<$integer> for RawCount {
            #[inline(always)]
            fn from($count: $integer) -> Self {
                Self($bits)
            }
        }
    )*};
}

counts! {
    u16: |count| count.into();
    i16: |count| count.cast_unsigned().into();
    u32: |count| count;
    i32: |count| count.cast_unsigned();
}

/// Extends a wrapping counter without loss, as long as it moves by less than half its range from
/// one reading to the next.
///
/// The position starts at zero with the counter at zero; a counter that is not zero at the first reading
/// gives the position nearest to zero.
///
/// ```
/// use haptic_servo::encoder::{CounterWidth, Position, RawCount};
/// let mut position = Position::new(CounterWidth::Bits16);
/// for raw in [0x7000_u16, 0xc000, 0x1000] {
///     position.update(RawCount::from(raw));
/// }
/// assert_eq!(position.count(), 0x1_1000);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Position {
    /// The position less `laps` times 2^32; its low bits are the last reading.
    count: i32,
    /// Separate, so that a tick only tests it for zero: 64-bit arithmetic would cost two instructions more.
    laps: i32,
    width: CounterWidth,
}

/// A position in the range in which the servo computes angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// The nearest position in counts within 32 bits: the position itself, except after tens of thousands of
    /// turns in one direction.
    pub count: i32,
    /// Whether `count` differs from the position.
    pub saturated: bool,
}

impl Position {
    /// A position of zero for a counter of this width.
    pub const fn new(width: CounterWidth) -> Self {
        Self { count: 0, laps: 0, width }
    }

    /// Takes a reading of the counter.
    #[inline(always)]
    pub const fn update(&mut self, raw: RawCount) -> Reading {
        self.follow(raw);
        self.reading()
    }

    /// The same without a result.
    #[inline(always)]
    pub(crate) const fn follow(&mut self, raw: RawCount) {
        // The signed step is the difference to the last reading at the counter's width.
        let shift = self.width as u32;
        let step = (raw.0.wrapping_sub(self.count.cast_unsigned()) << shift).cast_signed() >> shift;
        let (count, wrapped) = self.count.overflowing_add(step);
        self.count = count;
        if wrapped {
            cold_path();
            self.laps = self.laps.wrapping_add(if step < 0 { -1 } else { 1 });
        }
    }

    #[inline(always)]
    pub(crate) const fn reading(&self) -> Reading {
        if self.laps == 0 {
            return Reading { count: self.count, saturated: false };
        }
        Reading { count: beyond(self.laps), saturated: true }
    }

    /// The low 32 bits of the position.
    #[inline(always)]
    pub(crate) const fn low(&self) -> i32 {
        self.count
    }

    /// The position in counts.
    pub const fn count(&self) -> i64 {
        ((self.laps as i64) << 32) + self.count as i64
    }
}

/// The nearest 32-bit count to a position beyond 32 bits. Not inlined: a conditional selection in place of a
/// branch would cost every tick five instructions.
#[cold]
#[inline(never)]
const fn beyond(laps: i32) -> i32 {
    if laps < 0 { i32::MIN } else { i32::MAX }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn after(position: &mut Position, raw: RawCount) -> i64 {
        position.update(raw);
        position.count()
    }

    #[test]
    fn wraps_both_ways_at_both_widths() {
        let mut narrow = Position::new(CounterWidth::Bits16);
        assert_eq!(after(&mut narrow, RawCount::from(0xffff_u16)), -1);
        assert_eq!(after(&mut narrow, RawCount::from(2_u16)), 2);
        assert_eq!(after(&mut narrow, RawCount::from(0x7fff_u16)), 0x7fff);
        assert_eq!(after(&mut narrow, RawCount::from(0x8001_u16)), 0x8001);
        assert_eq!(after(&mut narrow, RawCount::from(0x7fff_u16)), 0x7fff);
        let mut wide = Position::new(CounterWidth::Bits32);
        assert_eq!(after(&mut wide, RawCount::from(i32::MAX)), i64::from(i32::MAX));
        assert_eq!(after(&mut wide, RawCount::from(i32::MIN)), 1 << 31);
        assert_eq!(after(&mut wide, RawCount::from(i32::MIN + 7)), (1 << 31) + 7);
        assert_eq!(after(&mut wide, RawCount::from(i32::MAX)), i64::from(i32::MAX));
    }

    #[test]
    fn ignores_what_is_above_the_width() {
        let mut narrow = Position::new(CounterWidth::Bits16);
        assert_eq!(after(&mut narrow, RawCount::from(0xabcd_0005_u32)), 5);
        assert_eq!(after(&mut narrow, RawCount::from(0x1234_0007_u32)), 7);
    }

    proptest! {
        #[test]
        fn follows_any_path_whose_steps_are_below_half_the_range(
            steps in proptest::collection::vec(-0x7fff_i64..=0x7fff, 1..200),
            scale in prop_oneof![Just(1_i64), Just(0x1_0000)],
        ) {
            let width = if scale == 1 { CounterWidth::Bits16 } else { CounterWidth::Bits32 };
            let mut position = Position::new(width);
            let mut truth = 0_i64;
            for step in steps {
                truth += step * scale;
                let reading = position.update(RawCount::from(truth as u32));
                prop_assert_eq!(position.count(), truth);
                let nearest = truth.clamp(i32::MIN.into(), i32::MAX.into());
                prop_assert_eq!(i64::from(reading.count), nearest);
                prop_assert_eq!(reading.saturated, nearest != truth);
            }
        }
    }
}
