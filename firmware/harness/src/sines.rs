//! Other means of computing the sweep's sine, for the table of what each costs.

use core::f32::consts::TAU;

use firmware::excitation::sine::{QUINTIC, sine};

/// Entries for a turn.
const ENTRIES: usize = 256;

/// Sines of 15 bits, and the first one again behind the last.
static TABLE: [i16; ENTRIES + 1] = {
    let (mut table, mut i) = ([0; _], 0);
    while i <= ENTRIES {
        let scaled = 32767.0 * sine(i as f32 / ENTRIES as f32, &NONIC);
        // The cast rounds to zero.
        table[i] = (scaled + if scaled < 0.0 { -0.5 } else { 0.5 }) as i16;
        i += 1;
    }
    table
};

/// A means of computing the sine of a part of a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sine {
    /// The crate `micromath`, in `f32`.
    Micromath,
    /// The crate `libm`, for `f32`; inside it computes in `f64`.
    Libm,
    /// The same crate, for `f64`.
    LibmDouble,
    /// A polynomial of the third degree.
    Cubic,
    /// A polynomial of the fifth degree: what a sweep is played with.
    Quintic,
    /// A polynomial of the seventh degree.
    Septic,
    /// A polynomial of the ninth degree.
    Nonic,
    /// Straight lines between the entries of a table of 256 for a turn, in whole numbers.
    Table,
}

/// Coefficients as those of [`QUINTIC`], with the least largest error of their degree.
const CUBIC: [f32; 2] = [6.192_264_7, -35.363_71];
const SEPTIC: [f32; 4] = [6.283_164, -41.337_143, 81.340_77, -70.993_43];
#[expect(clippy::approx_constant, reason = "the least error is beside it, not at it")]
const NONIC: [f32; 5] = [6.283_185, -41.341_656, 81.601_006, -76.549_78, 39.536_705];

impl Sine {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Micromath,
        Self::Libm,
        Self::LibmDouble,
        Self::Cubic,
        Self::Quintic,
        Self::Septic,
        Self::Nonic,
        Self::Table,
    ];

    /// Its name, for tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Micromath => "micromath",
            Self::Libm => "libm sinf",
            Self::LibmDouble => "libm sin",
            Self::Cubic => "degree 3",
            Self::Quintic => "degree 5",
            Self::Septic => "degree 7",
            Self::Nonic => "degree 9",
            Self::Table => "table of 256",
        }
    }

    /// The sine of `turn` turns, from 0 to 1.
    #[inline(always)]
    pub fn of_turn(self, turn: f32) -> f32 {
        match self {
            // By name, since `f32` has a sine of its own where there is an operating system.
            Self::Micromath => micromath::F32Ext::sin(TAU * turn),
            Self::Libm => libm::sinf(TAU * turn),
            Self::LibmDouble => libm::sin(core::f64::consts::TAU * f64::from(turn)) as f32,
            Self::Cubic => sine(turn, &CUBIC),
            Self::Quintic => sine(turn, &QUINTIC),
            Self::Septic => sine(turn, &SEPTIC),
            Self::Nonic => sine(turn, &NONIC),
            Self::Table => by_table(turn),
        }
    }
}

/// The sine of a part of a turn from 0 to 1, by the table.
#[inline(always)]
fn by_table(turn: f32) -> f32 {
    const TURN: f32 = (1 << 24) as f32;
    let angle = (turn * TURN) as u32;
    let (entry, part) = ((angle >> 16) as usize % ENTRIES, (angle & 0xffff).cast_signed());
    let (low, high) = (i32::from(TABLE[entry]), i32::from(TABLE[entry + 1]));
    ((low << 16) + (high - low) * part) as f32 * (1.0 / (32767.0 * 65536.0))
}
