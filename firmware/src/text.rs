//! Text built without allocation, also at compile time, so that the compiler prints the same text as the
//! board.

use core::fmt;

/// A string of at most `N` bytes; longer text is cut off.
#[derive(Clone, Copy)]
pub struct Text<const N: usize> {
    bytes: [u8; N],
    len: usize,
}

/// A sentence about a scene.
pub type Sentence = Text<816>;

/// Appends pieces to a [`Text`]: literals, and strings and numbers in braces.
macro_rules! push {
    (@ $text:expr, { $piece:expr }) => {
        $crate::text::Piece($piece).push_to(&mut $text)
    };
    (@ $text:expr, $piece:literal) => {
        $text.push($piece)
    };
    ($text:expr, $($piece:tt)+) => {{
        $($crate::text::push!(@ $text, $piece);)+
    }};
}
pub(crate) use push;

/// `Display` and `Error` of an error that has a `sentence`, and its refusal at compile time.
macro_rules! error_with_sentence {
    ($error:ty) => {
        impl $error {
            /// Panics with the sentence; in a constant this is a compile error.
            #[track_caller]
            pub(crate) const fn refuse(&self) -> ! {
                self.sentence().refuse()
            }
        }

        impl core::fmt::Display for $error {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(self.sentence().as_str())
            }
        }

        impl core::error::Error for $error {}
    };
}
pub(crate) use error_with_sentence;

/// An error as a table: a row for each variant, with its numbers and its sentence in the pieces of [`push`]. A row has
/// a description where its sentence leaves a unit or a meaning open.
macro_rules! sentences {
    ($(#[$about:meta])* $error:ident: $text:ty {
        $($(#[$doc:meta])* $variant:ident $({ $($field:ident: $type:ty),+ })? => ($($piece:tt)+),)+
    }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[allow(missing_docs, reason = "each row's sentence describes it")]
        pub enum $error {
            $($(#[$doc])* $variant $({ $($field: $type),+ })?,)+
        }

        impl $error {
            /// The error as a sentence, the same at compile time, on the host and on the board.
            pub const fn sentence(&self) -> $text {
                let mut t = <$text>::new();
                match *self {
                    $(Self::$variant $({ $($field),+ })? => $crate::text::push!(t, $($piece)+),)+
                }
                t
            }
        }

        $crate::text::error_with_sentence!($error);
    };
}
pub(crate) use sentences;

/// The value of a result, or the refusal of its error with the sentence.
macro_rules! or_refuse {
    ($result:expr) => {
        match $result {
            Ok(value) => value,
            Err(error) => error.refuse(),
        }
    };
}
pub(crate) use or_refuse;

/// An enumeration as a table: a row for each value, with its text.
#[macro_export]
macro_rules! words {
    ($(#[$about:meta])* $name:ident {
        $($(#[$doc:meta])* $value:ident $(= $number:literal)? $word:literal,)+
    }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $($(#[$doc])* $value $(= $number)?,)+
        }

        impl $name {
            /// All values, in their order.
            pub const ALL: [Self; [$($word),+].len()] = [$(Self::$value),+];

            /// The value as text, for tables and sentences.
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$value => $word,)+
                }
            }
        }
    };
}
pub(crate) use words;

/// A piece of a text. Not by a trait, whose methods are not `const`.
pub(crate) struct Piece<T>(pub T);

impl Piece<&str> {
    pub(crate) const fn push_to<const N: usize>(self, text: &mut Text<N>) {
        text.push(self.0);
    }
}

macro_rules! number_pieces {
    ($($number:ty)+) => {$(
        impl Piece<$number> {
            pub(crate) const fn push_to<const N: usize>(self, text: &mut Text<N>) {
                text.push_number(self.0 as f64);
            }
        }
    )+};
}
number_pieces!(f64 u16 u32 usize);

impl<const N: usize> Text<N> {
    /// Capacity in bytes.
    pub const CAPACITY: usize = N;

    /// The empty text.
    pub const fn new() -> Self {
        Self { bytes: [0; N], len: 0 }
    }

    /// The text.
    pub const fn as_str(&self) -> &str {
        match core::str::from_utf8(self.bytes.split_at(self.len).0) {
            Ok(text) => text,
            // Only whole ASCII pieces are ever pushed.
            Err(_) => "",
        }
    }

    /// Panics with the text; in a constant this is a compile error.
    #[track_caller]
    pub(crate) const fn refuse(&self) -> ! {
        panic!("{}", self.as_str())
    }

    const fn byte(&mut self, byte: u8) {
        if self.len < N {
            self.bytes[self.len] = byte;
            self.len += 1;
        }
    }

    /// Appends ASCII text; bytes beyond ASCII become `?`.
    // Not inlined: messages are made of dozens of these calls, which would take most of a board's flash.
    #[inline(never)]
    pub const fn push(&mut self, text: &str) {
        let bytes = text.as_bytes();
        each!(i in 0..bytes.len() => {
            self.byte(if bytes[i].is_ascii() { bytes[i] } else { b'?' });
        });
    }

    /// Appends the unit of a number; a pure number has none.
    pub(crate) const fn push_unit(&mut self, unit: &str) {
        if !unit.is_empty() {
            self.push(" ");
            self.push(unit);
        }
    }

    /// Appends a number with ten significant digits, trailing zeros left out; exponents outside
    /// 1e-5 to 1e9 are written as `1.5e-7`. The digits are for reading: they are rounded, and may
    /// be off in the tenth place.
    pub const fn push_number(&mut self, value: f64) {
        let mut number = Number::new();
        number.number(value);
        self.push(number.as_str());
    }
}

/// The largest number of bytes of a number: `-1.234567891e-308` is one of the longest.
type Number = Text<24>;

/// Numbers are written into a text of one fixed length, so that there is one copy of this code.
impl Number {
    const fn number(&mut self, value: f64) {
        if value.is_nan() {
            return self.push("NaN");
        }
        if value < 0.0 {
            self.byte(b'-');
        }
        if value.is_infinite() {
            return self.push("inf");
        }
        if value == 0.0 {
            return self.byte(b'0');
        }
        let (digits, exponent) = decimal(value.abs());
        if -5 <= exponent && exponent < 9 {
            self.push_digits(&digits, exponent);
        } else {
            self.push_digits(&digits, 0);
            self.byte(b'e');
            self.push_integer(exponent);
        }
    }

    /// Digits with the point after the one of weight `10^exponent`... `10^0`.
    const fn push_digits(&mut self, digits: &[u8; DIGITS], exponent: i32) {
        let mut last = DIGITS - 1;
        while last > 0 && digits[last] == 0 {
            last -= 1;
        }
        if exponent < 0 {
            self.push("0.");
            let mut zeros = -1;
            while zeros > exponent {
                self.byte(b'0');
                zeros -= 1;
            }
        }
        let mut i = 0;
        while i <= last || i as i32 <= exponent {
            if i as i32 == exponent + 1 && i > 0 && exponent >= 0 {
                self.byte(b'.');
            }
            self.byte(b'0' + digits[i]);
            i += 1;
        }
    }

    const fn push_integer(&mut self, value: i32) {
        if value < 0 {
            self.byte(b'-');
        }
        let mut rest = value.unsigned_abs();
        let mut digits = [0u8; 10];
        let mut n = 0;
        loop {
            digits[n] = (rest % 10) as u8;
            rest /= 10;
            n += 1;
            if rest == 0 {
                break;
            }
        }
        while n > 0 {
            n -= 1;
            self.byte(b'0' + digits[n]);
        }
    }
}

/// A number formatted as by [`Text`]. On a board it replaces the formatting of `core`, which is exact to the
/// last digit and takes 13 kB.
#[derive(Clone, Copy, Debug)]
pub struct ShortF64(pub f64);

impl fmt::Display for ShortF64 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut number = Number::new();
        number.number(self.0);
        f.write_str(number.as_str())
    }
}

/// A number for messages, rounded up to three digits, to a part in 10^12.
#[derive(Clone, Copy, Debug)]
pub struct RoundUp3(pub f64);

impl fmt::Display for RoundUp3 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut unit, value) = (1.0, self.0);
        if !value.is_finite() || value <= 0.0 {
            return ShortF64(value).fmt(f);
        }
        while value / unit >= 1000.0 {
            unit *= 10.0;
        }
        while value / unit < 100.0 && unit > 1e-300 {
            unit /= 10.0;
        }
        let whole = value / unit * (1.0 - 1e-12);
        let steps = whole as u64 + u64::from(whole > (whole as u64) as f64);
        ShortF64(steps as f64 * unit).fmt(f)
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Writes formatted values; longer text is cut off without an error.
impl<const N: usize> core::fmt::Write for Text<N> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        self.push(text);
        Ok(())
    }
}

const DIGITS: usize = 10;

/// Ten decimal digits and the exponent of the first one; `value` positive and finite.
const fn decimal(value: f64) -> ([u8; DIGITS], i32) {
    let (mut scaled, mut exponent) = (value, 0);
    while scaled >= 1e16 {
        scaled /= 1e16;
        exponent += 16;
    }
    while scaled < 1e-15 {
        scaled *= 1e16;
        exponent -= 16;
    }
    while scaled >= 10.0 {
        scaled /= 10.0;
        exponent += 1;
    }
    while scaled < 1.0 {
        scaled *= 10.0;
        exponent -= 1;
    }
    let mut whole = (scaled * 1e9 + 0.5) as u64;
    if whole >= 10_000_000_000 {
        whole /= 10;
        exponent += 1;
    }
    let mut digits = [0; DIGITS];
    let mut i = DIGITS;
    while i > 0 {
        i -= 1;
        digits[i] = (whole % 10) as u8;
        whole /= 10;
    }
    (digits, exponent)
}

#[cfg(test)]
mod tests {
    use super::{RoundUp3, Text};

    #[test]
    fn figures_are_rounded_up() {
        for (value, wanted) in [
            (0.0467, "0.0467"),
            (0.04670001, "0.0468"),
            (999.1, "1000"),
            (12345.0, "12400"),
            (0.0, "0"),
        ] {
            assert_eq!(RoundUp3(value).to_string(), wanted);
        }
        // A number without digits is an answer as well.
        for value in [f64::MAX, f64::INFINITY, f64::NAN, f64::MIN_POSITIVE, 5e-324, -1.0] {
            assert!(!RoundUp3(value).to_string().is_empty());
        }
    }

    #[test]
    fn numbers_read_as_people_write_them() {
        for (value, wanted) in [
            (0.022, "0.022"),
            (21.0, "21"),
            (-0.5, "-0.5"),
            (123456.789, "123456.789"),
            (0.1 + 0.2, "0.3"),
            (999999999.0, "999999999"),
            (1e9, "1e9"),
            (2.5e-7, "2.5e-7"),
            (9.99999999999, "10"),
            (0.00001234, "0.00001234"),
            (f64::INFINITY, "inf"),
            (f64::MAX, "1.797693135e308"),
            (100.0, "100"),
            (120.5, "120.5"),
        ] {
            let mut text = Text::<40>::new();
            text.push_number(value);
            assert_eq!(text.as_str(), wanted);
        }
    }

    #[test]
    fn what_does_not_fit_is_cut_off() {
        let mut text = Text::<4>::new();
        text.push("passive");
        assert_eq!(text.as_str(), "pass");
    }
}
