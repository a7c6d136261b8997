//! Magnetic absolute encoders at the wires of an SPI, bit by bit and by their data sheets: what a chip shifts out, when
//! it samples its angle, how old that is, its noise, and its failures.

/// A chip by the form of its transfers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// 24 bits: 14 of angle, 4 of status, and a checksum by x^6 + x + 1. Samples where it is selected.
    Mt6701,
    /// 16 bits of angle. Samples where it is selected.
    MagAlpha,
    /// A command of 16 bits, 21 bits of angle, 3 of status, and a checksum by x^8 + x^2 + x + 1.
    Mt6835,
    /// Words of 16 bits with an even parity, answered in the next transfer. Samples where it is released.
    As5048a,
    /// The same, with the angle at 0x3FFE, and at 0x3FFF a prediction that bit 4 of register 0x18 switches off.
    As5047p,
}

/// Core clocks in which the pull-up of 40 kΩ has the line of a released chip high, with 40 pF at it.
const RISE: u64 = 330;

/// A failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// This bit of each transfer is wrong, counted from the last one.
    Bit(u32),
    /// The line is low.
    Zeros,
    /// The line is high.
    Ones,
    /// It reports an error.
    Flag,
    /// It reports a weak field.
    WeakField,
    /// It gives the angle of the first transfer that failed, again and again.
    Frozen,
}

/// The chip on its axis.
#[derive(Clone, Debug)]
pub struct MagneticEncoder {
    model: Model,
    /// Core clocks by which an angle is old where it is sampled.
    pub delay: u64,
    /// Peak of its noise in counts.
    pub noise: i64,
    /// Whether an AS504x answers with the angle of this transfer, in a world whose positions have its age already.
    pub is_prompt: bool,
    /// Whether its data line is cut, and at ground.
    pub is_cut: bool,
    /// Its failure.
    pub failure: Option<Failure>,
    /// The last two positions in counts, each with its time.
    positions: [(u64, i64); 2],
    random: u64,
    selected: bool,
    /// The level that it gives its line, or has given it, and when it was selected or released.
    level: bool,
    changed: u64,
    /// When the line has fallen last.
    pub fell: Option<u64>,
    /// The bits to come, from the highest on, and how many of them.
    out: (u64, u32),
    /// Bits received in this transfer.
    input: (u64, u32),
    /// The next transfer of a chip that answers late.
    answer: u64,
    writes: Option<u64>,
    /// Whether that has an angle.
    has_angle: bool,
    predicts: bool,
    flagged: bool,
    frozen: Option<i64>,
    /// The angle of the last sample in counts.
    pub sampled: i64,
    /// That of the last transfer, of a chip that answers in the next one.
    pub answered: i64,
}

impl MagneticEncoder {
    /// The model of a chip's name, at a position in counts.
    pub fn find(name: &str, position: i64) -> Option<Self> {
        let model = match name {
            "mt6701" => Model::Mt6701,
            "ma600" | "ma702" | "ma732" => Model::MagAlpha,
            "mt6835" => Model::Mt6835,
            "as5048a" => Model::As5048a,
            "as5047p" => Model::As5047p,
            _ => return None,
        };
        Some(Self {
            model,
            delay: 0,
            noise: 0,
            is_prompt: false,
            is_cut: false,
            failure: None,
            positions: [(0, position); 2],
            random: 1,
            selected: false,
            level: true,
            changed: 0,
            fell: None,
            out: (0, 0),
            input: (0, 0),
            answer: 0,
            writes: None,
            has_angle: false,
            predicts: model == Model::As5047p,
            flagged: false,
            frozen: None,
            sampled: 0,
            answered: 0,
        })
    }

    /// Bits of its angle.
    pub fn bits(&self) -> u32 {
        match self.model {
            Model::Mt6701 | Model::As5048a | Model::As5047p => 14,
            Model::MagAlpha => 16,
            Model::Mt6835 => 21,
        }
    }

    /// Turns by some counts up to this time.
    pub fn turn(&mut self, counts: i32, now: u64) {
        let [_, (at, position)] = self.positions;
        self.positions = [(at, position), (now, position + i64::from(counts))];
    }

    /// CPOL and CPHA of its mode, as the SPI's lowest bits have them.
    fn has_mode(&self, mode: u32) -> bool {
        match self.model {
            Model::Mt6701 | Model::As5048a | Model::As5047p => mode == 0b01,
            Model::MagAlpha => mode == 0b00 || mode == 0b11,
            Model::Mt6835 => mode == 0b11,
        }
    }

    /// Its position so long before, on a straight line between those that are known, with its noise.
    fn sample(&mut self, now: u64) -> i64 {
        let [(from, was), (to, is)] = self.positions;
        let (then, length) = (now.saturating_sub(self.delay).clamp(from, to), (to - from).max(1));
        let passed = (is - was) as i128 * i128::from(then - from) / i128::from(length);
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let noise = (self.random >> 33) as i64 % (2 * self.noise + 1) - self.noise;
        let mut angle = (was + passed as i64 + noise).rem_euclid(1 << self.bits());
        if self.failure == Some(Failure::Frozen) {
            angle = *self.frozen.get_or_insert(angle);
        }
        self.sampled = angle;
        angle
    }

    /// It is selected, by a master with this mode.
    pub fn select(&mut self, now: u64, mode: u32) {
        (self.level, self.changed) = (self.line(now), now);
        (self.selected, self.input) = (self.has_mode(mode), (0, 0));
        let fails = |failure| self.failure == Some(failure);
        let (weak, flag) = (fails(Failure::WeakField), fails(Failure::Flag));
        let (mut bits, length) = match self.model {
            Model::Mt6701 => {
                // Status: 2 is a weak field, 8 a lost track.
                let status = (u64::from(weak) * 2) | (u64::from(flag) * 8);
                let content = (self.sample(now) as u64) << 4 | status;
                (content << 6 | remainder(content, 18, 0b100_0011, 6), 24)
            }
            Model::MagAlpha => (self.sample(now) as u64, 16),
            Model::Mt6835 => {
                // Status: 1 is too fast, 2 a weak field, 4 a low supply.
                let status = (u64::from(weak) * 2) | (u64::from(flag) * 4);
                let content = (self.sample(now) as u64) << 3 | status;
                (0xFFFF << 32 | content << 8 | remainder(content, 24, 0x107, 8), 48)
            }
            Model::As5048a | Model::As5047p => {
                self.answered = self.sampled;
                if self.is_prompt && self.has_angle {
                    let angle = self.sample(now);
                    self.answer = self.checked(angle as u64);
                }
                (self.answer, 16)
            }
        };
        if let Some(Failure::Bit(bit)) = self.failure {
            bits ^= 1 << bit;
        }
        self.out = (bits, length);
    }

    /// A clock: takes a bit, and gives one.
    pub fn clock(&mut self, input: bool) -> bool {
        let (word, count) = self.input;
        self.input = (word << 1 | u64::from(input), count + 1);
        let (was, level) = (self.has_line(self.level), self.next_bit(count));
        self.level = level;
        let is = self.has_line(level);
        // When in the transfer does not matter.
        if was && !is {
            self.fell = Some(self.changed);
        }
        is
    }

    /// The level of a line that it would give this.
    fn has_line(&self, level: bool) -> bool {
        match self.failure {
            _ if self.is_cut => false,
            Some(Failure::Zeros) => false,
            Some(Failure::Ones) => true,
            _ => level,
        }
    }

    /// The bit of the next clock, after so many.
    fn next_bit(&mut self, count: u32) -> bool {
        let (bits, left) = &mut self.out;
        // A line that nothing drives is pulled up.
        if !self.selected || *left == 0 {
            return true;
        }
        *left -= 1;
        let is_unknown =
            self.model == Model::Mt6835 && count >= 16 && self.input.0 >> (count - 15) != 0xA003;
        is_unknown || *bits >> *left & 1 != 0
    }

    /// The level of its line.
    pub fn line(&self, now: u64) -> bool {
        let is_pulled_up = !self.selected && now >= self.changed + RISE;
        self.has_line(self.level || is_pulled_up)
    }

    /// It is released: an AS504x executes the command.
    pub fn release(&mut self, now: u64) {
        (self.selected, self.changed) = (false, now);
        let (word, 16) = self.input else { return };
        if !matches!(self.model, Model::As5048a | Model::As5047p) {
            return;
        }
        self.flagged |= word.count_ones() % 2 != 0 || self.failure == Some(Failure::Flag);
        self.has_angle = false;
        let content = match self.writes.take() {
            Some(0x18) => {
                self.predicts &= word & 1 << 4 == 0;
                0
            }
            Some(_) => 0,
            None if word & 1 << 14 == 0 => {
                self.writes = Some(word & 0x3FFF);
                0
            }
            None => self.register(word & 0x3FFF, now),
        };
        self.answer = self.checked(content);
    }

    /// An answer with its error flag and its parity.
    fn checked(&self, content: u64) -> u64 {
        let answer = content | u64::from(self.flagged) << 14;
        answer | u64::from(answer.count_ones() % 2) << 15
    }

    fn register(&mut self, address: u64, now: u64) -> u64 {
        let angle = if self.model == Model::As5048a { 0x3FFF } else { 0x3FFE };
        self.has_angle = address == angle;
        match address {
            0x0001 => {
                self.flagged = false;
                0
            }
            0x3FFF if self.predicts => {
                let [(_, was), (_, is)] = self.positions;
                ((self.sample(now) + is - was) as u64) & 0x3FFF
            }
            0x3FFF => self.sample(now) as u64,
            _ if address == angle => self.sample(now) as u64,
            // Diagnostics: a magnet that is too weak, or the compensation of the offsets has ended; and the gain.
            _ if address == angle - 2 => {
                let weak = self.failure == Some(Failure::WeakField);
                (u64::from(weak) << 11) | (1 << 8) | if weak { 0xFF } else { 0x80 }
            }
            _ => 0,
        }
    }
}

/// The remainder of some bits, with as many zeros behind them as it has, by a polynomial of that degree.
fn remainder(bits: u64, count: u32, polynomial: u64, degree: u32) -> u64 {
    let divided = |rest: u64, bit| {
        if rest >> (bit + degree) & 1 != 0 { rest ^ polynomial << bit } else { rest }
    };
    (0..count).rev().fold(bits << degree, divided)
}
