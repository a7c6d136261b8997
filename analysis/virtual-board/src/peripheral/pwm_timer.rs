//! The advanced timer TIM1 as the power stage's pulse-width modulator (RM0440, 28.4): it counts up and down
//! at the core's clock, three channels compare, each drives the two switches of a leg with a dead time
//! between, and a break takes all six away within the period. The fourth channel has no output: at its match on the
//! way down it makes a request to the DMA.

use super::pins::Level;
use super::registers::{Registers, Table};
use super::{Access, Unmodelled, only};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const DIER: u32 = 0x0C;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCMR2: u32 = 0x1C;
const CCER: u32 = 0x20;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;
const RCR: u32 = 0x30;
const CCR1: u32 = 0x34;
const CCR2: u32 = 0x38;
const CCR3: u32 = 0x3C;
const CCR4: u32 = 0x40;
const BDTR: u32 = 0x44;
const AF1: u32 = 0x60;

/// CR1: counting, updates by an overflow only set the flag, the direction, and centre-aligned mode 1.
const ENABLE: u32 = 1;
const ONLY_OVERFLOW: u32 = 1 << 2;
const DOWN: u32 = 1 << 4;
const CENTRE_ALIGNED: u32 = 0b01 << 5;
/// CR2: the update is the trigger output.
const TRIGGER_UPDATE: u32 = 0b010 << 4;
/// DIER: the match of channel 4 makes a request to the DMA.
const REQUESTS: u32 = 1 << 12;
/// SR and EGR: the update.
const UPDATE: u32 = 1;
/// SR and EGR: a break by a comparator or by the program.
pub const BREAK: u32 = 1 << 7;
/// SR: a break by the clock security system, or by the core that is locked up.
pub const SYSTEM_BREAK: u32 = 1 << 13;
/// CCMR1 and CCMR2, of a channel: a compare value that waits for an update, and PWM mode 2, which is active from
/// that value on.
const CHANNEL: u32 = (1 << 3) | (0b111 << 4);
/// CCER: the two outputs of channel 1; four bits further for each channel.
const BOTH_OUTPUTS: u32 = 0b0101;
/// BDTR: the dead time, the states of outputs that are off, the break and its polarity, and the main output enable.
const DEAD_TIME: u32 = 0xFF;
const OFF_WHILE_IDLE: u32 = 1 << 10;
const OFF_WHILE_RUNNING: u32 = 1 << 11;
const OFF_MODES: u32 = OFF_WHILE_IDLE | OFF_WHILE_RUNNING;
const BREAK_ENABLE: u32 = 1 << 12;
const BREAK_HIGH: u32 = 1 << 13;
const BREAKS: u32 = BREAK_ENABLE | BREAK_HIGH;
/// BDTR: how long a break's input has to stay, of which only numbers of the core's clocks are modelled.
const FILTER: u32 = 0b11 << 16;
const MAIN_OUTPUT: u32 = 1 << 15;
/// AF1: the break's pin, to which nothing is wired, so that its level is low; and the comparators 1, 2 and 4.
const BREAK_PIN: u32 = 1;
const COMPARATORS: [(usize, u32); 3] = [(0, 1), (1, 2), (3, 4)];
const COMPARATOR_BITS: u32 = (1 << 1) | (1 << 2) | (1 << 4);

const REGISTERS: Table = &[
    (CR1, 0, ENABLE | ONLY_OVERFLOW | CENTRE_ALIGNED),
    (CR2, 0, TRIGGER_UPDATE),
    (DIER, 0, REQUESTS),
    (SR, 0, 0),
    (CCMR1, 0, CHANNEL | CHANNEL << 8),
    // Channel 3 alone.
    (CCMR2, 0, CHANNEL),
    (CCER, 0, BOTH_OUTPUTS | BOTH_OUTPUTS << 4 | BOTH_OUTPUTS << 8),
    // Not divided.
    (PSC, 0, 0),
    (ARR, 0xFFFF, 0xFFFF),
    (RCR, 0, 0xFFFF),
    (CCR1, 0, 0xFFFF),
    (CCR2, 0, 0xFFFF),
    (CCR3, 0, 0xFFFF),
    (CCR4, 0, 0xFFFF),
    (BDTR, 0, DEAD_TIME | OFF_MODES | BREAKS | FILTER | MAIN_OUTPUT),
    (AF1, BREAK_PIN, BREAK_PIN | COMPARATOR_BITS),
];
const COMPARE: [u32; 3] = [CCR1, CCR2, CCR3];

/// The two inputs of the gate driver of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// Of the switch to the supply: CHx.
    pub high: Level,
    /// Of the switch to ground: CHxN.
    pub low: Level,
}

/// What an instant brought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Instant {
    /// The counter is at zero: a period begins.
    pub valley: bool,
    /// The trigger output rises.
    pub trigger: bool,
    /// Channel 4 makes its request.
    pub request: bool,
}

/// The counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Count {
    /// It stands still at a value.
    Stopped(u32),
    /// It has been at zero at this time, and whether it has been at the top since.
    Running { valley: u64, was_at_top: bool },
}

/// A channel's reference, which is active or not, since a time.
#[derive(Clone, Copy, Debug, Default)]
struct Reference {
    active: bool,
    since: u64,
}

/// The timer.
#[derive(Clone, Debug)]
pub struct PwmTimer {
    registers: Registers,
    /// The reload value.
    top: u32,
    /// Turns of the counter that are still to come before an update.
    left: u32,
    /// The compare values that are compared.
    compared: [u32; 3],
    count: Count,
    references: [Reference; 3],
}

impl Default for PwmTimer {
    fn default() -> Self {
        Self {
            registers: Registers::new(REGISTERS),
            top: 0xFFFF,
            left: 0,
            compared: [0; 3],
            count: Count::Stopped(0),
            references: [Reference::default(); 3],
        }
    }
}

impl PwmTimer {
    /// When something happens next after a time.
    pub fn next(&self, now: u64) -> Option<u64> {
        let dead = self.dead_time();
        let dead_times = self.references.iter().map(|reference| reference.since + dead);
        let counted = match self.count {
            Count::Stopped(_) => [None; 9],
            Count::Running { valley, .. } => self.turns_and_matches(valley).map(Some),
        };
        dead_times.chain(counted.into_iter().flatten()).filter(|&at| at > now).min()
    }

    /// When the counter turns around in a period, and when the channels match.
    fn turns_and_matches(&self, valley: u64) -> [u64; 9] {
        let top = u64::from(self.top);
        let [u, v, w] = self.compared.map(|compared| u64::from(compared).min(top));
        let bottom = 2 * top;
        let fourth = bottom - u64::from(self.registers.get(CCR4)).min(top);
        [top, bottom, u, v, w, bottom - u, bottom - v, bottom - w, fourth]
            .map(|count| valley + count)
    }

    /// Does what happens at a time, which no earlier one may be skipped for.
    pub fn advance(&mut self, now: u64) -> Instant {
        let mut instant = Instant::default();
        if let Count::Running { valley, was_at_top } = self.count {
            let (top, bottom) = (valley + u64::from(self.top), valley + 2 * u64::from(self.top));
            if now >= top && !was_at_top {
                self.count = Count::Running { valley, was_at_top: true };
                instant.trigger |= self.turn_around();
            }
            // Centre-aligned mode 1: a match counts on the way down.
            let matches = now == bottom - u64::from(self.registers.get(CCR4)).min(bottom);
            instant.request = matches && now > top && self.registers.has(DIER, REQUESTS);
            if now >= bottom {
                self.count = Count::Running { valley: bottom, was_at_top: false };
                instant.valley = true;
                instant.trigger |= self.turn_around();
            }
        }
        self.compare_at(now);
        instant
    }

    /// Whether it counts.
    pub fn runs(&self) -> bool {
        matches!(self.count, Count::Running { .. })
    }

    /// When the present period has begun, while it counts.
    pub fn valley(&self) -> Option<u64> {
        match self.count {
            Count::Running { valley, .. } => Some(valley),
            Count::Stopped(_) => None,
        }
    }

    /// Whether the outputs are enabled as a whole.
    pub fn is_on(&self) -> bool {
        self.registers.has(BDTR, MAIN_OUTPUT)
    }

    /// Whether comparators' outputs of these levels are a break, once they have lasted for [`Self::filter`].
    pub fn is_broken_by(&self, levels: [bool; 4]) -> bool {
        let registers = &self.registers;
        let breaks =
            |(comparator, bit): (usize, u32)| registers.has(AF1, 1 << bit) && levels[comparator];
        // Active low, the open pin breaks.
        let is_asked = !registers.has(BDTR, BREAK_HIGH) || COMPARATORS.into_iter().any(breaks);
        registers.has(BDTR, BREAK_ENABLE) && is_asked
    }

    /// Core clocks for which a break's input has to stay.
    pub fn filter(&self) -> u64 {
        match (self.registers.get(BDTR) & FILTER) >> 16 {
            0 => 0,
            code => 1 << code,
        }
    }

    /// A break with this flag: the outputs are off from here on.
    pub fn break_off(&mut self, flag: u32) {
        if self.registers.has(BDTR, BREAK_ENABLE) {
            self.registers.change(BDTR, MAIN_OUTPUT, 0);
            self.registers.change(SR, 0, flag);
        }
    }

    /// What it drives the gates of a leg with.
    pub fn outputs(&self, leg: usize, now: u64) -> Outputs {
        let both = |level| Outputs { high: level, low: level };
        if self.registers.get(CCER) >> (4 * leg) & BOTH_OUTPUTS != BOTH_OUTPUTS {
            return both(Level::Floating);
        }
        if !self.is_on() {
            let is_driven = self.registers.has(BDTR, OFF_WHILE_IDLE);
            return both(if is_driven { Level::Low } else { Level::Floating });
        }
        let Reference { active, since } = self.references[leg];
        let is_over = now >= since + self.dead_time();
        let level = |is_on| if is_on && is_over { Level::High } else { Level::Low };
        Outputs { high: level(active), low: level(!active) }
    }

    /// Core clocks between one switch of a leg and the other.
    pub fn dead_time(&self) -> u64 {
        let code = u64::from(self.registers.get(BDTR) & DEAD_TIME);
        match code >> 5 {
            0..=3 => code,
            4 | 5 => (64 + (code & 0x3F)) * 2,
            6 => (32 + (code & 0x1F)) * 8,
            _ => (32 + (code & 0x1F)) * 16,
        }
    }

    /// Reads.
    pub fn read(&self, offset: u32, now: u64) -> Access<u32> {
        match offset {
            CR1 => Ok(self.registers.get(CR1) | self.direction(now)),
            CNT => Ok(self.value(now)),
            _ => self.registers.read(offset),
        }
    }

    /// Writes; whether the trigger output rises.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Access<bool> {
        let mut triggers = false;
        match offset {
            CR1 => self.set_control(value, now)?,
            // Bits are cleared by writing zero.
            SR => self.registers.change(SR, !value, 0),
            EGR => triggers = self.generate(value, now)?,
            ARR if self.runs() => return Err(Unmodelled::Register),
            ARR => {
                self.registers.write(ARR, value)?;
                self.top = value;
            }
            BDTR if value & MAIN_OUTPUT != 0 && !self.is_on() => {
                self.registers.write(BDTR, value)?;
                // A dead time comes before the first switch, too.
                self.references.iter_mut().for_each(|reference| reference.since = now);
            }
            CNT => match self.count {
                Count::Stopped(_) if value <= self.top => self.count = Count::Stopped(value),
                _ => return Err(Unmodelled::Register),
            },
            CCMR1 | CCMR2 => {
                check_modes(value)?;
                self.registers.write(offset, value)?;
            }
            _ => self.registers.write(offset, value)?,
        }
        self.compare_at(now);
        Ok(triggers)
    }

    fn set_control(&mut self, value: u32, now: u64) -> Access<()> {
        // The direction is the timer's own.
        let value = value & !DOWN;
        self.registers.check(CR1, value, 0)?;
        let is_on = value & ENABLE != 0;
        if is_on && value & CENTRE_ALIGNED == 0 {
            return Err(Unmodelled::Bits(ENABLE));
        }
        if is_on != self.runs() {
            self.count = match self.count {
                Count::Stopped(count) => {
                    let valley = now.checked_sub(count.into()).ok_or(Unmodelled::Bits(ENABLE))?;
                    Count::Running { valley, was_at_top: false }
                }
                Count::Running { .. } => Count::Stopped(self.value(now)),
            };
        }
        self.registers.set(CR1, value);
        Ok(())
    }

    /// EGR: an update or a break by the program.
    fn generate(&mut self, value: u32, now: u64) -> Access<bool> {
        only(value, UPDATE | BREAK)?;
        if value & BREAK != 0 {
            self.registers.change(BDTR, MAIN_OUTPUT, 0);
            self.registers.change(SR, 0, BREAK);
        }
        if value & UPDATE == 0 {
            return Ok(false);
        }
        self.count = match self.count {
            Count::Stopped(_) => Count::Stopped(0),
            Count::Running { .. } => Count::Running { valley: now, was_at_top: false },
        };
        let had_flag = self.registers.get(SR) & UPDATE;
        let triggers = self.update();
        if self.registers.has(CR1, ONLY_OVERFLOW) {
            self.registers.change(SR, UPDATE, had_flag);
        }
        Ok(triggers)
    }

    /// The counter is at the top or at zero: an update, unless further turns come first (RM0440, 28.3.3).
    /// Whether the trigger output rises.
    fn turn_around(&mut self) -> bool {
        if self.left > 0 {
            self.left -= 1;
            return false;
        }
        self.update()
    }

    fn update(&mut self) -> bool {
        self.left = self.registers.get(RCR);
        self.registers.change(SR, 0, UPDATE);
        self.compared = COMPARE.map(|register| self.registers.get(register));
        self.registers.get(CR2) == TRIGGER_UPDATE
    }

    fn mode(&self, channel: usize) -> u32 {
        self.registers.get([CCMR1, CCMR1, CCMR2][channel]) >> (8 * (channel % 2)) & CHANNEL
    }

    /// Takes the references' edges down.
    fn compare_at(&mut self, now: u64) {
        for channel in 0..3 {
            let active = self.mode(channel) == CHANNEL && self.is_from_on(channel, now);
            if active != self.references[channel].active {
                self.references[channel] = Reference { active, since: now };
            }
        }
    }

    /// Whether the counter is at the compare value or above; on the way down, above.
    fn is_from_on(&self, channel: usize, now: u64) -> bool {
        let compared = u64::from(self.compared[channel]);
        if compared == 0 {
            return true;
        }
        match self.count {
            Count::Stopped(count) => u64::from(count) >= compared,
            Count::Running { valley, .. } => {
                let passed = now - valley;
                passed >= compared && passed < (2 * u64::from(self.top)).saturating_sub(compared)
            }
        }
    }

    fn value(&self, now: u64) -> u32 {
        match self.count {
            Count::Stopped(count) => count,
            Count::Running { valley, .. } => {
                let (passed, top) = ((now - valley) as u32, self.top);
                if passed <= top { passed } else { (2 * top).saturating_sub(passed) }
            }
        }
    }

    fn direction(&self, now: u64) -> u32 {
        match self.count {
            Count::Running { valley, .. } if now - valley >= u64::from(self.top) => DOWN,
            _ => 0,
        }
    }
}

/// CCMR1 and CCMR2: each channel in PWM mode 2, or not used.
fn check_modes(value: u32) -> Access<()> {
    let is_modelled = |mode: u32| mode == 0 || mode == CHANNEL;
    if is_modelled(value & 0xFF) && is_modelled(value >> 8) {
        Ok(())
    } else {
        Err(Unmodelled::Bits(value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOP: u32 = 2125;
    const DEAD: u32 = 100;
    const ON: u32 =
        DEAD | OFF_WHILE_IDLE | OFF_WHILE_RUNNING | BREAK_ENABLE | BREAK_HIGH | MAIN_OUTPUT;
    const START: u64 = 10_000;

    fn write(timer: &mut PwmTimer, now: u64, writes: &[(u32, u32)]) {
        for &(register, value) in writes {
            timer.write(register, value, now).unwrap();
        }
    }

    /// Set up, with the compare values 500, 1000 and one above the top, and started at 10,000.
    fn started() -> PwmTimer {
        let mut timer = PwmTimer::default();
        write(
            &mut timer,
            0,
            &[
                (CR1, CENTRE_ALIGNED | ONLY_OVERFLOW),
                (ARR, TOP),
                (RCR, 1),
                (CCMR1, CHANNEL | CHANNEL << 8),
                (CCMR2, CHANNEL),
                (CCR1, 500),
                (CCR2, 1000),
                (CCR3, TOP + 1),
                (CCER, 0x555),
                (EGR, UPDATE),
                (CR2, TRIGGER_UPDATE),
                (AF1, COMPARATOR_BITS),
                (BDTR, ON),
            ],
        );
        write(&mut timer, START, &[(CR1, CENTRE_ALIGNED | ONLY_OVERFLOW | ENABLE)]);
        timer
    }

    /// Advances to a time, from event to event; gives when the trigger output rose.
    fn run(timer: &mut PwmTimer, from: u64, to: u64) -> Vec<u64> {
        let (mut now, mut triggers) = (from, Vec::new());
        while let Some(next) = timer.next(now).filter(|&next| next <= to) {
            now = next;
            if timer.advance(now).trigger {
                triggers.push(now);
            }
        }
        triggers
    }

    fn levels(timer: &PwmTimer, leg: usize, now: u64) -> (bool, bool) {
        let Outputs { high, low } = timer.outputs(leg, now);
        (high == Level::High, low == Level::High)
    }

    /// Channel 4 asks for a transfer a stated number of counts before each valley.
    #[test]
    fn a_request_comes_before_each_valley() {
        let mut timer = started();
        write(&mut timer, START, &[(CCR4, 939), (DIER, REQUESTS)]);
        let (mut now, mut requests) = (START, Vec::new());
        let period = 2 * u64::from(TOP);
        while let Some(next) = timer.next(now).filter(|&next| next <= START + 2 * period) {
            now = next;
            if timer.advance(now).request {
                requests.push(now);
            }
        }
        assert_eq!(requests, [1, 2].map(|periods| START + periods * period - 939));
    }

    #[test]
    fn an_update_comes_once_a_period_at_the_valley() {
        let mut timer = started();
        let period = 2 * u64::from(TOP);
        let triggers = run(&mut timer, START, START + 3 * period + 5);
        assert_eq!(triggers, [1, 2, 3].map(|periods| START + periods * period));
    }

    /// The high side conducts around the peak, the low side around the valley, and between them neither,
    /// for the dead time.
    #[test]
    fn a_leg_switches_at_its_compare_value_with_a_dead_time() {
        let mut timer = started();
        let (compare, top, dead) = (500, u64::from(TOP), u64::from(DEAD));
        let mut now = START;
        for (passed, expected) in [
            (0, (false, true)),
            (compare - 1, (false, true)),
            (compare, (false, false)),
            (compare + dead - 1, (false, false)),
            (compare + dead, (true, false)),
            (2 * top - compare - 1, (true, false)),
            (2 * top - compare, (false, false)),
            (2 * top - compare + dead, (false, true)),
            (2 * top + compare - 1, (false, true)),
        ] {
            run(&mut timer, now, START + passed);
            now = START + passed;
            assert_eq!(levels(&timer, 0, now), expected, "at {passed}");
        }
        // A compare value above the top is never reached.
        assert_eq!(levels(&timer, 2, START + top), (false, true));
    }

    #[test]
    fn a_break_takes_all_outputs_away_at_once_and_for_good() {
        let mut timer = started();
        let now = START + 700;
        run(&mut timer, START, now);
        assert_eq!(levels(&timer, 0, now), (true, false));
        assert!(!timer.is_broken_by([false, false, true, false]), "no input");
        assert!(timer.is_broken_by([false, false, false, true]));
        timer.break_off(BREAK);
        for leg in 0..3 {
            let low = Outputs { high: Level::Low, low: Level::Low };
            assert_eq!(timer.outputs(leg, now), low);
        }
        assert_eq!(timer.read(SR, now).unwrap() & BREAK, BREAK);
        run(&mut timer, now, now + 10_000);
        assert!(!timer.is_on());
    }

    #[test]
    fn dead_times_are_the_manual_s() {
        for (code, clocks) in [(0x7F, 127), (0x80, 128), (0xBF, 254), (0xC0, 256), (0xFF, 1008)] {
            let mut timer = PwmTimer::default();
            write(&mut timer, 0, &[(BDTR, code)]);
            assert_eq!(timer.dead_time(), clocks);
        }
    }

    #[test]
    fn what_is_not_modelled_is_refused() {
        let mut timer = started();
        for (register, value) in [
            (CR1, ENABLE),
            (CR1, 0b10 << 5),
            (CR2, 1 << 8),
            (CCMR1, 0b110 << 4),
            (CCER, 1 << 12),
            (ARR, TOP - 1),
            (BDTR, 1 << 14),
            (AF1, 1 << 3),
            (BDTR, 1 << 18),
            (0x28, 1),
            (DIER, 1 << 8),
            (0x48, 1),
        ] {
            assert!(timer.write(register, value, START).is_err(), "{register:#x}: {value:#x}");
        }
    }
}
