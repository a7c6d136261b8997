//! Faults as a table: the code, the word and the sentence of each.

/// A number of a fault in the 32 bits of its code.
pub trait Bits {
    /// As bits.
    fn into_bits(self) -> u32;
    /// From bits.
    fn from_bits(bits: u32) -> Self;
}

macro_rules! bits {
    ($($number:ty: $into:expr, $from:expr;)+) => {$(
        impl Bits for $number {
            fn into_bits(self) -> u32 {
                ($into)(self)
            }

            fn from_bits(bits: u32) -> Self {
                ($from)(bits)
            }
        }
    )+};
}
bits! {
    u32: u32::from, u32::from;
    i32: i32::cast_unsigned, u32::cast_signed;
    bool: u32::from, |bits| bits != 0;
}

/// An enumeration of faults, from a row for each: its description, its code, its word, the variant with at most two
/// numbers, and its sentence. The last row, of another enumeration's faults, has no code and no word.
macro_rules! fault_table {
    ($(#[$about:meta])* $fault:ident {
        $($(#[$doc:meta])* $code:literal $word:literal $variant:ident $({ $($number:ident: $type:ty),+ })?
            => ($sentence:literal $(, $argument:expr)?),)+
        $(others: $(#[$others:meta])* $other:ident($inner:ident: $kind:ident) => ($prefix:literal),)?
    }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(missing_docs, reason = "a row's description and sentence name its numbers")]
        pub enum $fault {
            $($(#[$doc])* $variant $({ $($number: $type),+ })?,)+
            $($(#[$others])* $other($kind),)?
        }

        impl $fault {
            /// The fault in one word, for tables.
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $word,)+
                    $(Self::$other($inner) => $inner.as_str(),)?
                }
            }

            /// The fault as a code, never zero, and two numbers. Codes never change, so that hosts and boards of
            /// different versions understand each other.
            pub fn encode(self) -> (u32, [u32; 2]) {
                match self {
                    $(Self::$variant $({ $($number),+ })? => {
                        let [a, b, ..] = [$($($crate::fault::codes::Bits::into_bits($number),)+)? 0, 0];
                        ($code, [a, b])
                    })+
                    $(Self::$other($inner) => $inner.encode(),)?
                }
            }

            /// The fault of a code and its numbers; `None` if there is no such fault.
            pub fn decode(code: u32, numbers: [u32; 2]) -> Option<Self> {
                match code {
                    $($code => {
                        let [$($($number,)+)? ..] = numbers;
                        Some(Self::$variant $({
                            $($number: $crate::fault::codes::Bits::from_bits($number)),+
                        })?)
                    })+
                    _ => None::<Self>$(.or_else(|| $kind::decode(code, numbers).map(Self::$other)))?,
                }
            }
        }

        /// The event, the value, the bound, and the remedy.
        impl core::fmt::Display for $fault {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match *self {
                    $(Self::$variant $({ $($number),+ })? => write!(f, $sentence $(, $argument)?),)+
                    $(Self::$other($inner) => write!(f, concat!($prefix, "{}"), $inner),)?
                }
            }
        }

        impl core::error::Error for $fault {}
    };
}
pub(crate) use fault_table;
