//! Checksums of frames, and tables of them: remainders by a polynomial whose coefficients are bits.

/// A checksum over so many bits, with as many zeros behind them as it has itself.
#[derive(Clone, Copy, Debug)]
pub struct Checksum {
    /// The coefficients, the highest first; at most 9 of them.
    pub polynomial: u32,
    /// Bits that it checks; with its own, at most 32.
    pub bits: u32,
}

impl Checksum {
    /// The checksum of these bits.
    pub const fn of(&self, content: u32) -> u8 {
        let Self { polynomial, bits } = *self;
        let own = polynomial.ilog2();
        let mut rest = content << own;
        each!(bit in 0..bits => {
            let place = bits - 1 - bit;
            if rest & 1 << (own + place) != 0 {
                rest ^= polynomial << place;
            }
        });
        rest as u8
    }

    /// The remainder of these bits with their checksum behind them: zero if it is theirs.
    pub const fn remainder(&self, bits: u32) -> u32 {
        let own = self.polynomial.ilog2();
        self.of(bits >> own) as u32 ^ bits & ((1 << own) - 1)
    }

    /// The checksum of each number below `N` that has so many zeros behind it. That of a sum is the sum of theirs.
    pub const fn table<const N: usize>(&self, zeros: u32) -> [u8; N] {
        let mut table = [0; N];
        each!(number in 1..N => {
            let lowest = 1 << number.trailing_zeros();
            table[number] = table[number ^ lowest] ^ self.of((lowest as u32) << zeros);
        });
        table
    }
}
