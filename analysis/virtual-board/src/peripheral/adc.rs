//! An analogue-to-digital converter (ADC, RM0440, 21.4): one injected channel, started by the power stage's
//! timer, and one regular channel, started by the program. Times are in core clocks.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled, only};

const ISR: u32 = 0x00;
const IER: u32 = 0x04;
const CR: u32 = 0x08;
const CFGR: u32 = 0x0C;
const CFGR2: u32 = 0x10;
const SMPR1: u32 = 0x14;
const SMPR2: u32 = 0x18;
const SQR1: u32 = 0x30;
const DR: u32 = 0x40;
const JSQR: u32 = 0x4C;
const JDR1: u32 = 0x80;
const DIFSEL: u32 = 0xB0;
const CALFACT: u32 = 0xB4;

/// ISR and IER.
const READY: u32 = 1;
const REGULAR_CONVERTED: u32 = 1 << 2;
const REGULAR_ENDED: u32 = 1 << 3;
const OVERRUN: u32 = 1 << 4;
const INJECTED_CONVERTED: u32 = 1 << 5;
const INJECTED_ENDED: u32 = 1 << 6;
const FLAGS: u32 =
    READY | REGULAR_CONVERTED | REGULAR_ENDED | OVERRUN | INJECTED_CONVERTED | INJECTED_ENDED;
/// Flags that a program clears at its start and that are never set here: the end of sampling, the analogue
/// watchdogs, and the queue's overflow.
const NEVER: u32 = (1 << 1) | (0b111 << 7) | (1 << 10);
/// CR.
const ENABLE: u32 = 1;
const DISABLE: u32 = 1 << 1;
const START_REGULAR: u32 = 1 << 2;
const START_INJECTED: u32 = 1 << 3;
const STOP_REGULAR: u32 = 1 << 4;
const STOP_INJECTED: u32 = 1 << 5;
const REGULATOR: u32 = 1 << 28;
const DEEP_POWER_DOWN: u32 = 1 << 29;
const CALIBRATE: u32 = 1 << 31;
/// CFGR: a result that is overwritten, and a context that does not queue.
const OVERWRITES: u32 = 1 << 12;
const NO_QUEUE: u32 = 1 << 31;
/// CFGR2: oversampling of both groups, the ratio and the shift.
const OVERSAMPLES_REGULAR: u32 = 1;
const OVERSAMPLES_INJECTED: u32 = 1 << 1;
const OVERSAMPLING: u32 = 0xFF << 1 | 1;
/// JSQR: TIM1's trigger output at its rising edge, and the one channel.
const RISING: u32 = 0b01 << 7;
const EDGES: u32 = 0b11 << 7;
const CHANNEL: u32 = 0x1F;

/// The regulator's start, in millionths of a second.
const REGULATOR_START: u64 = 20;
/// Clocks of the converter for a calibration, and from being switched on to being ready.
const CALIBRATION: u64 = 116;
const START: u64 = 4;
/// Twice the converter's clocks of each sampling time, and of the conversion after it.
const SAMPLING: [u64; 8] = [5, 13, 25, 49, 95, 185, 495, 1281];
const CONVERSION: u64 = 25;
/// The factor that a calibration finds.
const FACTOR: u32 = 0x40;

const REGISTERS: Table = &[
    (IER, 0, FLAGS),
    (CFGR, NO_QUEUE, OVERWRITES | NO_QUEUE),
    (CFGR2, 0, OVERSAMPLING),
    (SMPR1, 0, 0x3FFF_FFFF),
    (SMPR2, 0, 0x3FFF_FFFF),
    // One channel.
    (SQR1, 0, CHANNEL << 6),
    // One channel, and TIM1's trigger output.
    (JSQR, 0, RISING | CHANNEL << 9),
    // No channel is differential.
    (DIFSEL, 0, 0),
];

/// The starts of conversions during which a register must not be changed.
fn held_by(register: u32) -> u32 {
    match register {
        CFGR | CFGR2 | SMPR1 | SMPR2 => START_REGULAR | START_INJECTED,
        SQR1 => START_REGULAR,
        JSQR => START_INJECTED,
        _ => 0,
    }
}

/// The clock of a converter.
#[derive(Clone, Copy, Debug)]
pub struct AdcClock {
    /// The core's clock in Hz.
    pub core: u64,
    /// Core clocks per clock of the converter; `None` if it is not selected.
    pub divider: Option<u64>,
}

/// The group of a conversion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    Regular,
    Injected,
}

/// A conversion under way.
#[derive(Clone, Copy, Debug)]
struct Conversion {
    group: Group,
    /// The end of the sampling; `None` after it.
    samples: Option<u64>,
    ends: u64,
    /// Remaining conversions of an oversampled one.
    left: u32,
    sum: u32,
}

/// A converter.
#[derive(Clone, Debug)]
pub struct Adc {
    registers: Registers,
    flags: u32,
    control: u32,
    data: u32,
    injected_data: u32,
    is_calibrated: bool,
    /// The time at which the regulator has started.
    regulated: Option<u64>,
    /// The end of a calibration.
    calibrated: Option<u64>,
    /// The time at which it is ready.
    ready: Option<u64>,
    conversion: Option<Conversion>,
    /// A regular conversion waits for the end of the injected one.
    waits: bool,
}

impl Default for Adc {
    fn default() -> Self {
        Self {
            registers: Registers::new(REGISTERS),
            flags: 0,
            control: DEEP_POWER_DOWN,
            data: 0,
            injected_data: 0,
            is_calibrated: false,
            regulated: None,
            calibrated: None,
            ready: None,
            conversion: None,
            waits: false,
        }
    }
}

impl Adc {
    /// The time of the next event.
    pub fn due(&self) -> Option<u64> {
        let conversion = self.conversion.map(|now| now.samples.unwrap_or(now.ends));
        [self.calibrated, self.ready, conversion].into_iter().flatten().min()
    }

    /// The channel whose sampling ends at a time, if one does.
    pub fn samples(&self, now: u64) -> Option<u32> {
        let conversion = self.conversion.as_ref()?;
        conversion.samples.filter(|&at| at <= now)?;
        Some(self.channel(conversion.group))
    }

    /// The value in codes at the end of the sampling.
    pub fn sample(&mut self, code: u16) {
        if let Some(conversion) = &mut self.conversion {
            conversion.samples = None;
            conversion.sum += u32::from(code);
        }
    }

    /// Runs the events due at a time, except the end of a sampling.
    pub fn advance(&mut self, now: u64, clock: AdcClock) {
        if self.calibrated.is_some_and(|at| at <= now) {
            self.calibrated = None;
            self.is_calibrated = true;
            self.control &= !CALIBRATE;
        }
        if self.ready.is_some_and(|at| at <= now) {
            self.ready = None;
            self.flags |= READY;
        }
        let Some(conversion) = self.conversion else { return };
        if conversion.samples.is_none() && conversion.ends <= now {
            self.conversion = None;
            self.converted(conversion, clock);
        }
    }

    /// The trigger output of TIM1 rises.
    pub fn trigger(&mut self, now: u64, clock: AdcClock) {
        if self.control & START_INJECTED == 0 || !self.is_triggered() {
            return;
        }
        match self.conversion {
            // A trigger during an injected conversion is ignored.
            Some(Conversion { group: Group::Injected, .. }) => return,
            // The regular conversion is repeated after it.
            Some(_) => self.waits = true,
            None => {}
        }
        self.begin(Group::Injected, now, clock);
    }

    fn is_triggered(&self) -> bool {
        self.registers.get(JSQR) & EDGES == RISING
    }

    /// The level of its interrupt line.
    pub fn line(&self) -> bool {
        self.registers.has(IER, self.flags)
    }

    /// Its flags.
    pub fn flags(&self) -> u32 {
        self.flags
    }

    /// The injected channel's last result.
    pub fn injected_data(&self) -> u16 {
        self.injected_data as u16
    }

    /// Reads.
    pub fn read(&mut self, offset: u32) -> Access<u32> {
        match offset {
            ISR => Ok(self.flags),
            CR => Ok(self.control),
            DR => {
                self.flags &= !REGULAR_CONVERTED;
                Ok(self.data)
            }
            JDR1 => Ok(self.injected_data),
            CALFACT if self.is_calibrated => Ok(FACTOR),
            _ => self.registers.read(offset),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, clock: AdcClock) -> Access<()> {
        match offset {
            // Bits are cleared by writing one.
            ISR => {
                only(value, FLAGS | NEVER)?;
                self.flags &= !value;
                Ok(())
            }
            CR => self.set_control(value, now, clock),
            _ => {
                self.registers.check(offset, value, 0)?;
                if self.control & held_by(offset) != 0 {
                    return Err(Unmodelled::Bits(value));
                }
                self.registers.set(offset, value);
                Ok(())
            }
        }
    }

    /// CR: bits are set by the program, and most of them cleared by the converter.
    fn set_control(&mut self, value: u32, now: u64, clock: AdcClock) -> Access<()> {
        let starts = START_REGULAR | START_INJECTED;
        let stops = STOP_REGULAR | STOP_INJECTED;
        let power = REGULATOR | DEEP_POWER_DOWN;
        only(value, ENABLE | DISABLE | starts | stops | power | CALIBRATE)?;
        let new = value & !self.control;
        self.set_power(value & power, now, clock);
        if new & CALIBRATE != 0 {
            self.calibrate(now, clock)?;
        }
        if new & ENABLE != 0 {
            self.enable(now, clock)?;
        }
        if value & DISABLE != 0 && self.control & ENABLE != 0 {
            if self.control & starts != 0 {
                return Err(Unmodelled::Bits(DISABLE));
            }
            self.control &= !ENABLE;
            (self.ready, self.flags) = (None, self.flags & !READY);
        }
        self.set_starts(value, now, clock)
    }

    fn set_starts(&mut self, value: u32, now: u64, clock: AdcClock) -> Access<()> {
        let new = value & !self.control & (START_REGULAR | START_INJECTED);
        if new != 0 && (self.flags & READY == 0 || self.control & ENABLE == 0) {
            return Err(Unmodelled::Bits(new));
        }
        if new & START_INJECTED != 0 {
            // Only contexts that do not queue, and that a trigger starts.
            if !self.registers.has(CFGR, NO_QUEUE) || !self.is_triggered() {
                return Err(Unmodelled::Bits(START_INJECTED));
            }
            self.control |= START_INJECTED;
        }
        if new & START_REGULAR != 0 {
            self.control |= START_REGULAR;
            if self.conversion.is_some() {
                self.waits = true;
            } else {
                self.begin(Group::Regular, now, clock);
            }
        }
        if value & STOP_REGULAR != 0 {
            self.stop(Group::Regular, START_REGULAR);
            self.waits = false;
        }
        if value & STOP_INJECTED != 0 {
            self.stop(Group::Injected, START_INJECTED);
            if std::mem::take(&mut self.waits) {
                self.begin(Group::Regular, now, clock);
            }
        }
        Ok(())
    }

    fn stop(&mut self, group: Group, start: u32) {
        self.control &= !start;
        self.conversion.take_if(|conversion| conversion.group == group);
    }

    fn set_power(&mut self, power: u32, now: u64, clock: AdcClock) {
        let is_regulated = power == REGULATOR;
        if is_regulated != (self.control & (REGULATOR | DEEP_POWER_DOWN) == REGULATOR) {
            self.regulated = is_regulated.then(|| now + REGULATOR_START * clock.core / 1_000_000);
            if !is_regulated {
                self.is_calibrated = false;
            }
        }
        self.control = self.control & !(REGULATOR | DEEP_POWER_DOWN) | power;
    }

    /// Only once the regulator has started.
    fn calibrate(&mut self, now: u64, clock: AdcClock) -> Access<()> {
        let is_regulated = self.regulated.is_some_and(|at| at <= now);
        match clock.divider {
            Some(divider) if is_regulated && self.control & ENABLE == 0 => {
                self.control |= CALIBRATE;
                self.calibrated = Some(now + CALIBRATION * divider);
                Ok(())
            }
            _ => Err(Unmodelled::Bits(CALIBRATE)),
        }
    }

    /// Only once it is calibrated.
    fn enable(&mut self, now: u64, clock: AdcClock) -> Access<()> {
        match clock.divider {
            Some(divider) if self.is_calibrated && self.regulated.is_some_and(|at| at <= now) => {
                self.control |= ENABLE;
                self.ready = Some(now + START * divider);
                Ok(())
            }
            _ => Err(Unmodelled::Bits(ENABLE)),
        }
    }

    fn channel(&self, group: Group) -> u32 {
        match group {
            Group::Regular => self.registers.get(SQR1) >> 6 & CHANNEL,
            Group::Injected => self.registers.get(JSQR) >> 9 & CHANNEL,
        }
    }

    fn oversamples(&self, group: Group) -> bool {
        let bit = match group {
            Group::Regular => OVERSAMPLES_REGULAR,
            Group::Injected => OVERSAMPLES_INJECTED,
        };
        self.registers.has(CFGR2, bit)
    }

    fn begin(&mut self, group: Group, now: u64, clock: AdcClock) {
        let ratio =
            if self.oversamples(group) { 2 << (self.registers.get(CFGR2) >> 2 & 0b111) } else { 1 };
        self.begin_next(group, ratio, 0, now, clock);
    }

    fn begin_next(&mut self, group: Group, left: u32, sum: u32, now: u64, clock: AdcClock) {
        let channel = self.channel(group);
        let times = self.registers.get(if channel < 10 { SMPR1 } else { SMPR2 });
        let code = times >> (3 * (channel % 10)) & 0b111;
        let (sampling, divider) = (SAMPLING[code as usize], clock.divider.unwrap_or(1));
        let samples = now + (sampling * divider).div_ceil(2);
        let ends = now + ((sampling + CONVERSION) * divider).div_ceil(2);
        let left = left - 1;
        self.conversion = Some(Conversion { group, samples: Some(samples), ends, left, sum });
    }

    /// Ends a conversion: begins the next one of an oversampled result, or stores the result.
    fn converted(&mut self, conversion: Conversion, clock: AdcClock) {
        let Conversion { group, ends, left, sum, .. } = conversion;
        if left > 0 {
            self.begin_next(group, left, sum, ends, clock);
            return;
        }
        let shift = if self.oversamples(group) { self.registers.get(CFGR2) >> 5 & 0xF } else { 0 };
        let result = sum >> shift & 0xFFFF;
        match group {
            Group::Injected => {
                self.injected_data = result;
                self.flags |= INJECTED_CONVERTED | INJECTED_ENDED;
            }
            Group::Regular => self.regular_result(result),
        }
        if std::mem::take(&mut self.waits) {
            self.begin(Group::Regular, ends, clock);
        }
    }

    fn regular_result(&mut self, result: u32) {
        let is_unread = self.flags & REGULAR_CONVERTED != 0;
        if is_unread {
            self.flags |= OVERRUN;
        }
        if !is_unread || self.registers.has(CFGR, OVERWRITES) {
            self.data = result;
        }
        self.flags |= REGULAR_CONVERTED | REGULAR_ENDED;
        self.control &= !START_REGULAR;
    }
}

/// The clock, which both converters share.
#[derive(Clone, Debug, Default)]
pub struct AdcCommon {
    control: u32,
}

impl AdcCommon {
    /// Core clocks per clock of the converters; `None` if the clock is not the bus's.
    pub fn divider(&self) -> Option<u64> {
        match self.control >> 16 & 0b11 {
            0 => None,
            mode => Some(1 << (mode - 1)),
        }
    }

    /// Reads; with the converters' flags.
    pub fn read(&self, offset: u32, flags: [u32; 2]) -> Access<u32> {
        match offset {
            0x00 => Ok(flags[0] | flags[1] << 16),
            0x08 => Ok(self.control),
            _ => Err(Unmodelled::Register),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x08 => {
                only(value, 0b11 << 16)?;
                self.control = value;
                Ok(())
            }
            _ => Err(Unmodelled::Register),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOCK: AdcClock = AdcClock { core: 170_000_000, divider: Some(4) };
    /// The time at which it is ready.
    const BEGIN: u64 = 10_000;

    fn write(adc: &mut Adc, now: u64, writes: &[(u32, u32)]) {
        for &(register, value) in writes {
            adc.write(register, value, now, CLOCK).unwrap();
        }
    }

    /// Ready, with channel 3 injected and 5 regular: 2.5 and 47.5 clocks of sampling.
    fn ready() -> Adc {
        let mut adc = Adc::default();
        write(&mut adc, 0, &[(CR, 0), (CR, REGULATOR)]);
        write(&mut adc, 3400, &[(CR, REGULATOR | CALIBRATE)]);
        assert_eq!(adc.due(), Some(3400 + 116 * 4));
        adc.advance(4000, CLOCK);
        write(&mut adc, 4100, &[(CR, REGULATOR | ENABLE)]);
        adc.advance(5000, CLOCK);
        assert_eq!(adc.read(ISR).unwrap() & READY, READY);
        write(&mut adc, 5000, &[(SMPR1, 4 << 15), (JSQR, RISING | 3 << 9), (SQR1, 5 << 6)]);
        write(&mut adc, 5000, &[(CR, REGULATOR | ENABLE | START_INJECTED), (IER, INJECTED_ENDED)]);
        adc
    }

    /// Goes through all that is due up to a time; a sample's code is its time behind `BEGIN`.
    fn run(adc: &mut Adc, to: u64) {
        while let Some(due) = adc.due().filter(|&due| due <= to) {
            if adc.samples(due).is_some() {
                adc.sample((due - BEGIN) as u16);
            }
            adc.advance(due, CLOCK);
        }
    }

    #[test]
    fn an_injected_conversion_samples_and_ends_when_the_manual_says() {
        let mut adc = ready();
        adc.trigger(BEGIN, CLOCK);
        assert_eq!(adc.due(), Some(BEGIN + 10));
        assert_eq!(adc.samples(BEGIN + 10), Some(3));
        run(&mut adc, BEGIN + 59);
        assert!(!adc.line());
        run(&mut adc, BEGIN + 60);
        assert!(adc.line());
        assert_eq!(adc.read(JDR1), Ok(10));
        write(&mut adc, BEGIN + 70, &[(ISR, INJECTED_ENDED | INJECTED_CONVERTED)]);
        assert!(!adc.line());
        // The next trigger converts again, without being asked.
        adc.trigger(BEGIN + 100, CLOCK);
        run(&mut adc, BEGIN + 200);
        assert_eq!(adc.read(JDR1), Ok(110));
    }

    #[test]
    fn a_regular_conversion_is_done_again_behind_an_injected_one() {
        let mut adc = ready();
        let on = REGULATOR | ENABLE | START_INJECTED;
        write(&mut adc, BEGIN, &[(CR, on | START_REGULAR)]);
        adc.trigger(BEGIN + 100, CLOCK);
        run(&mut adc, BEGIN + 1000);
        assert_eq!(adc.read(JDR1), Ok(110));
        // Behind the end at 160.
        assert_eq!(adc.read(ISR).unwrap() & REGULAR_ENDED, REGULAR_ENDED);
        assert_eq!(adc.read(DR), Ok(160 + 190));
        assert_eq!(adc.read(ISR).unwrap() & REGULAR_CONVERTED, 0);
        assert_eq!(adc.read(CR), Ok(on), "a start is cleared by its end");
    }

    #[test]
    fn a_result_that_is_not_read_stays_and_says_so() {
        let mut adc = ready();
        let on = REGULATOR | ENABLE | START_INJECTED | START_REGULAR;
        for begin in [BEGIN, BEGIN + 1000] {
            write(&mut adc, begin, &[(CR, on)]);
            run(&mut adc, begin + 999);
        }
        assert_eq!(adc.read(ISR).unwrap() & OVERRUN, OVERRUN);
        assert_eq!(adc.read(DR), Ok(190));
    }

    #[test]
    fn oversampling_sums_and_shifts() {
        let mut adc = ready();
        write(&mut adc, BEGIN, &[(CR, REGULATOR | ENABLE | STOP_INJECTED)]);
        // Four conversions, divided by two.
        write(&mut adc, BEGIN, &[(CFGR2, OVERSAMPLES_INJECTED | 1 << 2 | 1 << 5)]);
        write(&mut adc, BEGIN, &[(CR, REGULATOR | ENABLE | START_INJECTED)]);
        adc.trigger(BEGIN, CLOCK);
        run(&mut adc, BEGIN + 239);
        assert!(!adc.line());
        run(&mut adc, BEGIN + 240);
        assert!(adc.line());
        assert_eq!(adc.read(JDR1), Ok((10 + 70 + 130 + 190) / 2));
    }

    #[test]
    fn a_start_that_the_chip_would_not_survive_is_refused() {
        let mut adc = Adc::default();
        write(&mut adc, 0, &[(CR, 0), (CR, REGULATOR)]);
        assert!(adc.write(CR, REGULATOR | CALIBRATE, 3399, CLOCK).is_err(), "not regulated");
        assert!(adc.write(CR, REGULATOR | ENABLE, 3400, CLOCK).is_err(), "not calibrated");
        let unclocked = AdcClock { divider: None, ..CLOCK };
        assert!(adc.write(CR, REGULATOR | CALIBRATE, 3400, unclocked).is_err(), "not clocked");
        assert!(adc.read(0xB4).is_err(), "no factor yet");
        let mut adc = ready();
        for (register, value) in [
            (JSQR, RISING | 4 << 9),
            (SMPR1, 0),
            (SQR1, 1),
            (0x20, 0),
            (0x84, 0),
            (CR, REGULATOR | ENABLE | START_INJECTED | DISABLE),
            (CR, REGULATOR | ENABLE | 1 << 30),
        ] {
            assert!(adc.write(register, value, BEGIN, CLOCK).is_err(), "{register:#x}: {value:#x}");
        }
    }
}
