//! An analogue-to-digital converter (ADC, RM0440, 21.4): one injected channel, started by the power stage's
//! timer, and one regular channel, started by the program. Times are in core clocks.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled, only};

const ISR: u32 = 0x00;
const IER: u32 = 0x04;
const CR: u32 = 0x08;
const CFGR: u32 = 0x0C;
const SMPR1: u32 = 0x14;
const SMPR2: u32 = 0x18;
const SQR1: u32 = 0x30;
const DR: u32 = 0x40;
const JSQR: u32 = 0x4C;
const JDR1: u32 = 0x80;

/// ISR and IER.
const READY: u32 = 1;
const REGULAR_CONVERTED: u32 = 1 << 2;
const REGULAR_ENDED: u32 = 1 << 3;
const OVERRUN: u32 = 1 << 4;
const INJECTED_CONVERTED: u32 = 1 << 5;
const INJECTED_ENDED: u32 = 1 << 6;
const FLAGS: u32 =
    READY | REGULAR_CONVERTED | REGULAR_ENDED | OVERRUN | INJECTED_CONVERTED | INJECTED_ENDED;
/// CR.
const ENABLE: u32 = 1;
const START_REGULAR: u32 = 1 << 2;
const START_INJECTED: u32 = 1 << 3;
const REGULATOR: u32 = 1 << 28;
const DEEP_POWER_DOWN: u32 = 1 << 29;
const CALIBRATE: u32 = 1 << 31;
/// CFGR: a context that does not queue.
const NO_QUEUE: u32 = 1 << 31;
/// JSQR: TIM1's trigger output at its rising edge, and the one channel.
const RISING: u32 = 0b01 << 7;
const CHANNEL: u32 = 0x1F;

/// The regulator's start, in millionths of a second.
const REGULATOR_START: u64 = 20;
/// Clocks of the converter for a calibration, and from being switched on to being ready.
const CALIBRATION: u64 = 116;
const START: u64 = 4;
/// Twice the converter's clocks of each sampling time, and of the conversion after it.
const SAMPLING: [u64; 8] = [5, 13, 25, 49, 95, 185, 495, 1281];
const CONVERSION: u64 = 25;

const REGISTERS: Table = &[
    (IER, 0, FLAGS),
    (CFGR, NO_QUEUE, NO_QUEUE),
    (SMPR1, 0, 0x3FFF_FFFF),
    (SMPR2, 0, 0x3FFF_FFFF),
    // One channel.
    (SQR1, 0, CHANNEL << 6),
    // One channel, and TIM1's trigger output.
    (JSQR, 0, RISING | CHANNEL << 9),
];

/// The starts of conversions during which a register must not be changed.
fn held_by(register: u32) -> u32 {
    match register {
        CFGR | SMPR1 | SMPR2 => START_REGULAR | START_INJECTED,
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
    code: u32,
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
            (conversion.samples, conversion.code) = (None, code.into());
        }
    }

    /// Runs the events due at a time, except the end of a sampling.
    pub fn advance(&mut self, now: u64, clock: AdcClock) {
        if self.calibrated.take_if(|at| *at <= now).is_some() {
            self.is_calibrated = true;
            self.control &= !CALIBRATE;
        }
        if self.ready.take_if(|at| *at <= now).is_some() {
            self.flags |= READY;
        }
        let has_ended = |it: &mut Conversion| it.samples.is_none() && it.ends <= now;
        if let Some(conversion) = self.conversion.take_if(has_ended) {
            self.converted(conversion, clock);
        }
    }

    /// The trigger output of TIM1 rises.
    pub fn trigger(&mut self, now: u64, clock: AdcClock) {
        if self.control & START_INJECTED == 0 {
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

    /// The level of its interrupt line.
    pub fn line(&self) -> bool {
        self.registers.has(IER, self.flags)
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
            _ => self.registers.read(offset),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, clock: AdcClock) -> Access<()> {
        match offset {
            // Bits are cleared by writing one.
            ISR => {
                only(value, FLAGS)?;
                self.flags &= !value;
                Ok(())
            }
            CR => self.set_control(value, now, clock),
            _ if self.control & held_by(offset) != 0 => Err(Unmodelled::Bits(value)),
            _ => self.registers.write(offset, value),
        }
    }

    /// CR: bits are set by the program, and most of them cleared by the converter. What the chip demands of their
    /// order is demanded here.
    fn set_control(&mut self, value: u32, now: u64, clock: AdcClock) -> Access<()> {
        let starts = START_REGULAR | START_INJECTED;
        let power = REGULATOR | DEEP_POWER_DOWN;
        only(value, ENABLE | starts | power | CALIBRATE)?;
        let new = value & !self.control;
        self.set_power(value & power, now, clock);
        let is_regulated = self.regulated.is_some_and(|at| at <= now);
        let (is_enabled, is_ready) = (self.control & ENABLE != 0, self.flags & READY != 0);
        // Contexts that do not queue, and that a trigger starts.
        let has_context = self.registers.has(CFGR, NO_QUEUE) && self.registers.has(JSQR, RISING);
        for (bit, is_possible) in [
            (CALIBRATE, is_regulated && !is_enabled && clock.divider.is_some()),
            (ENABLE, is_regulated && self.is_calibrated && clock.divider.is_some()),
            (START_REGULAR, is_enabled && is_ready),
            (START_INJECTED, is_enabled && is_ready && has_context),
        ] {
            if new & bit != 0 && !is_possible {
                return Err(Unmodelled::Bits(bit));
            }
        }
        self.control |= new & (CALIBRATE | ENABLE | starts);
        let divider = clock.divider.unwrap_or(1);
        if new & CALIBRATE != 0 {
            self.calibrated = Some(now + CALIBRATION * divider);
        }
        if new & ENABLE != 0 {
            self.ready = Some(now + START * divider);
        }
        if new & START_REGULAR != 0 {
            if self.conversion.is_some() {
                self.waits = true;
            } else {
                self.begin(Group::Regular, now, clock);
            }
        }
        Ok(())
    }

    fn set_power(&mut self, power: u32, now: u64, clock: AdcClock) {
        let is_regulated = power == REGULATOR;
        if is_regulated != (self.control & (REGULATOR | DEEP_POWER_DOWN) == REGULATOR) {
            self.regulated = is_regulated.then(|| now + REGULATOR_START * clock.core / 1_000_000);
            self.is_calibrated &= is_regulated;
        }
        self.control = self.control & !(REGULATOR | DEEP_POWER_DOWN) | power;
    }

    fn channel(&self, group: Group) -> u32 {
        match group {
            Group::Regular => self.registers.get(SQR1) >> 6 & CHANNEL,
            Group::Injected => self.registers.get(JSQR) >> 9 & CHANNEL,
        }
    }

    fn begin(&mut self, group: Group, now: u64, clock: AdcClock) {
        let channel = self.channel(group);
        let times = self.registers.get(if channel < 10 { SMPR1 } else { SMPR2 });
        let code = times >> (3 * (channel % 10)) & 0b111;
        let (sampling, divider) = (SAMPLING[code as usize], clock.divider.unwrap_or(1));
        let samples = now + (sampling * divider).div_ceil(2);
        let ends = now + ((sampling + CONVERSION) * divider).div_ceil(2);
        self.conversion = Some(Conversion { group, samples: Some(samples), ends, code: 0 });
    }

    /// Stores the result of a conversion.
    fn converted(&mut self, Conversion { group, ends, code, .. }: Conversion, clock: AdcClock) {
        match group {
            Group::Injected => {
                self.injected_data = code;
                self.flags |= INJECTED_CONVERTED | INJECTED_ENDED;
            }
            // A result that is not read stays.
            Group::Regular if self.flags & REGULAR_CONVERTED != 0 => self.flags |= OVERRUN,
            Group::Regular => self.data = code,
        }
        if group == Group::Regular {
            self.flags |= REGULAR_CONVERTED | REGULAR_ENDED;
            self.control &= !START_REGULAR;
        }
        if std::mem::take(&mut self.waits) {
            self.begin(Group::Regular, ends, clock);
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
        assert_eq!(adc.read(DR), Ok(160 + 190));
        assert_eq!(adc.read(CR), Ok(on), "a start is cleared by its end");
    }

    #[test]
    fn a_start_that_the_chip_would_not_survive_is_refused() {
        let mut adc = Adc::default();
        write(&mut adc, 0, &[(CR, 0), (CR, REGULATOR)]);
        assert!(adc.write(CR, REGULATOR | CALIBRATE, 3399, CLOCK).is_err(), "not regulated");
        assert!(adc.write(CR, REGULATOR | ENABLE, 3400, CLOCK).is_err(), "not calibrated");
        let unclocked = AdcClock { divider: None, ..CLOCK };
        assert!(adc.write(CR, REGULATOR | CALIBRATE, 3400, unclocked).is_err(), "not clocked");
        let mut adc = ready();
        for (register, value) in [
            (JSQR, RISING | 4 << 9),
            (SMPR1, 0),
            (SQR1, 1),
            (0x20, 0),
            (0x84, 0),
            (CR, REGULATOR | ENABLE | START_INJECTED | 1 << 1),
            (CR, REGULATOR | ENABLE | 1 << 30),
        ] {
            assert!(adc.write(register, value, BEGIN, CLOCK).is_err(), "{register:#x}: {value:#x}");
        }
    }
}
