//! The board around the core: its peripherals on their bus, and the world that is wired to them.

use crate::chip::{Chip, DEBUG, PACER_INTERRUPT, Place, TORQUE, Unit};
use crate::core::System;
use crate::core::exceptions::{FIRST_INTERRUPT, SYS_TICK};
use crate::core::system::{SYSTEM, WATCH};
use crate::device::{Device, Still};
use crate::meter::Meter;
use crate::peripheral::clock::{Cause, Clock};
use crate::peripheral::converter::Converter;
use crate::peripheral::counter::Counter;
use crate::peripheral::pacer::Pacer;
use crate::peripheral::pins::{Level, Pins};
use crate::peripheral::plain::Plain;
use crate::peripheral::serial::Serial;
use crate::peripheral::watchdog::Watchdog;
use crate::peripheral::{Access, Unmodelled};
use crate::trouble::{NotModelled, Why};

/// What happened on the board's pins, with the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The converter's output changed.
    Torque(Option<u16>),
    /// The amplifier's line changed.
    Amplifier(Level),
}

/// The board.
pub struct Board {
    /// Instructions since power was switched on, waiting included.
    pub now: u64,
    /// The core's registers in memory.
    pub system: System,
    /// Reset and clock control.
    pub clock: Clock,
    /// The pacing timer.
    pub pacer: Pacer,
    /// The encoder's counter.
    pub encoder: Counter,
    /// The converter.
    pub converter: Converter,
    /// The serial port.
    pub serial: Serial,
    /// What is wired to the motor and the encoder.
    pub device: Box<dyn Device + Send>,
    /// Instructions of the servo's interrupt.
    pub meter: Meter,
    /// Samples so far: updates of the pacing timer.
    pub samples: u64,
    /// A register on which the bus gives an error, as of a broken peripheral.
    pub broken: Option<u32>,
    /// What happened, if somebody wants to know.
    pub events: Option<Vec<(u64, Event)>>,
    pub(crate) stopped: Option<NotModelled>,
    chip: &'static Chip,
    free_clock: Counter,
    /// The watchdog.
    pub watchdog: Watchdog,
    power: Plain,
    flash: Plain,
    configuration: Plain,
    debug: Plain,
    ports: Vec<Pins>,
    pub(crate) bus_error: Option<u32>,
    seen: (Option<u16>, Level),
}

impl Board {
    /// A board whose power has just been switched on.
    pub fn new(chip: &'static Chip, device: Box<dyn Device + Send>) -> Self {
        Self {
            now: 0,
            system: System::default(),
            clock: Clock::new(chip.clock, chip.crystal, Cause::Power),
            pacer: Pacer::new(),
            encoder: Counter::new(chip.counter),
            converter: Converter::new(chip.converter),
            serial: Serial::new(chip.face),
            device,
            meter: Meter::default(),
            samples: 0,
            broken: None,
            events: None,
            stopped: None,
            chip,
            free_clock: Counter::new(32),
            watchdog: Watchdog::default(),
            power: (chip.power)(),
            flash: (chip.flash_interface)(),
            configuration: (chip.configuration)(),
            debug: Plain::new(DEBUG),
            ports: (0..9).map(chip.ports).collect(),
            bus_error: None,
            seen: (None, Level::Floating),
        }
    }

    /// The chip.
    pub fn chip(&self) -> &'static Chip {
        self.chip
    }

    /// Every unit as out of reset; memory, time and the world stay.
    pub fn reset(&mut self, cause: Cause) {
        let device = std::mem::replace(&mut self.device, Box::new(Still));
        let fresh = Self::new(self.chip, device);
        *self = Self {
            now: self.now,
            meter: self.meter,
            samples: self.samples,
            broken: self.broken,
            events: self.events.take(),
            clock: self.clock.after_reset(cause),
            seen: self.seen,
            ..fresh
        };
        self.look();
    }

    /// Level of the amplifier's line.
    pub fn amplifier(&self) -> Level {
        let (port, pin) = self.chip.amplifier;
        self.ports[port].level(pin)
    }

    /// What the torque's pin is driven with.
    pub fn torque(&self) -> Option<u16> {
        let (port, pin) = TORQUE;
        self.converter.output().filter(|_| self.ports[port].is_analog(pin))
    }

    /// When something happens next that the program has not asked for.
    pub fn due(&self) -> u64 {
        [self.pacer.due(), self.serial.due(), self.watchdog.due(), self.system.systick.due()]
            .into_iter()
            .flatten()
            .min()
            .unwrap_or(u64::MAX)
    }

    /// Does what is due; whether the watchdog resets the board.
    pub fn advance(&mut self) -> bool {
        let now = self.now;
        if self.pacer.advance(now, self.clock.timer_divider()) {
            self.sample();
        }
        self.serial.advance(now, self.clock.bus_divider());
        if self.system.systick.advance(now) {
            self.system.exceptions.pend(SYS_TICK);
        }
        self.lines();
        self.look();
        self.watchdog.due().is_some_and(|due| due <= now)
    }

    /// The pacing timer's update: the sample that it ends goes into the device, and the converter
    /// begins the next one.
    fn sample(&mut self) {
        self.samples += 1;
        let counts = self.device.sample(self.torque(), self.amplifier() == Level::High);
        self.turn(counts);
        if self.pacer.triggers() {
            self.converter.trigger();
        }
    }

    /// Turns the encoder, where it is wired as the program has set its pins up.
    pub fn turn(&mut self, counts: i32) {
        if self.is_wired(self.chip.encoder) {
            self.encoder.turn(counts);
        }
    }

    /// Puts bytes on the line to the program, where its pin is set up for that.
    pub fn send(&mut self, bytes: &[u8]) {
        if self.is_wired(self.chip.serial) {
            self.serial.send(bytes);
            self.serial.advance(self.now, self.clock.bus_divider());
        }
    }

    /// Whether the program has given both pins this alternate function.
    fn is_wired(&self, (pins, function): ([(usize, u32); 2], u32)) -> bool {
        pins.iter().all(|&(port, pin)| self.ports[port].function(pin) == Some(function))
    }

    /// Reads for the program.
    pub fn read(&mut self, address: u32, size: usize) -> u32 {
        if self.broken == Some(address) {
            self.bus_error = Some(address);
            return 0;
        }
        match self.find_and_read(address, size) {
            Ok(value) => value,
            Err((unit, why)) => {
                self.stop(unit, address, None, why);
                0
            }
        }
    }

    /// Writes for the program.
    pub fn write(&mut self, address: u32, size: usize, value: u32) {
        if self.broken == Some(address) {
            self.bus_error = Some(address);
            return;
        }
        if let Err((unit, why)) = self.find_and_write(address, size, value) {
            self.stop(unit, address, Some(value), why);
        }
        self.serial.advance(self.now, self.clock.bus_divider());
        self.lines();
        self.look();
    }

    fn find_and_read(&mut self, address: u32, size: usize) -> Result<u32, Fault> {
        let now = self.now;
        if let Some(offset) = within(address, SYSTEM) {
            if let Some(number) = System::priority_at(offset) {
                return Ok((0..size as u16).rev().fold(0, |word, i| {
                    word << 8 | u32::from(self.system.exceptions.priority(number + i))
                }));
            }
            return self.system.read(offset, now).map_err(of("the system control space"));
        }
        if let Some(offset) = within(address, WATCH) {
            return self.system.read_watch(offset, now).map_err(of("the DWT"));
        }
        let place = self.place(address)?;
        let offset = address - place.base;
        // The serial port's data register may be accessed by bytes.
        if size == 1 && place.unit != Unit::Serial {
            return Err((Some(place.name), Why::Width));
        }
        self.read_unit(place, offset).map_err(of(place.name))
    }

    fn find_and_write(&mut self, address: u32, size: usize, value: u32) -> Result<(), Fault> {
        let now = self.now;
        if let Some(offset) = within(address, SYSTEM) {
            if let Some(number) = System::priority_at(offset) {
                for (i, byte) in value.to_le_bytes().into_iter().enumerate().take(size) {
                    self.system.exceptions.set_priority(number + i as u16, byte);
                }
                return Ok(());
            }
            return self.system.write(offset, value, now).map_err(of("the system control space"));
        }
        if let Some(offset) = within(address, WATCH) {
            return self.system.write_watch(offset, value, now).map_err(of("the DWT"));
        }
        let place = self.place(address)?;
        let offset = address - place.base;
        if size == 1 && place.unit != Unit::Serial {
            return Err((Some(place.name), Why::Width));
        }
        self.write_unit(place, offset, value).map_err(of(place.name))
    }

    /// The unit at an address, if it is clocked and not held in reset.
    fn place(&self, address: u32) -> Result<&'static Place, Fault> {
        let place = self.chip.at(address).ok_or((None, Why::Nobody))?;
        match place.clocked {
            Some((clock, reset, bit))
                if !self.clock.is_set(clock, bit) || self.clock.is_set(reset, bit) =>
            {
                Err((Some(place.name), Why::Stopped))
            }
            _ => Ok(place),
        }
    }

    fn read_unit(&mut self, place: &Place, offset: u32) -> Access<u32> {
        let (now, divider) = (self.now, self.clock.timer_divider());
        match place.unit {
            Unit::Clock => self.clock.read(offset),
            Unit::Power => self.power.read(offset),
            Unit::Flash => self.flash.read(offset),
            Unit::Configuration => self.configuration.read(offset),
            Unit::Debug => self.debug.read(offset),
            Unit::Pins(port) => self.ports[port].read(offset),
            Unit::Pacer => self.pacer.read(offset),
            Unit::FreeClock => self.free_clock.read(offset, now, divider),
            Unit::Encoder => {
                self.meter.read(now);
                self.encoder.read(offset, now, divider)
            }
            Unit::Converter => self.converter.read(offset),
            Unit::Serial => self.serial.read(offset),
            Unit::Watchdog => self.watchdog.read(offset),
        }
    }

    fn write_unit(&mut self, place: &Place, offset: u32, value: u32) -> Access<()> {
        let (now, divider) = (self.now, self.clock.timer_divider());
        match place.unit {
            Unit::Clock => {
                self.clock.write(offset, value)?;
                self.reset_units(offset);
                Ok(())
            }
            Unit::Power => self.power.write(offset, value),
            Unit::Flash => self.flash.write(offset, value),
            Unit::Configuration => self.configuration.write(offset, value),
            Unit::Debug => self.debug.write(offset, value),
            Unit::Pins(port) => self.ports[port].write(offset, value),
            Unit::Pacer => self.pacer.write(offset, value, now, divider),
            Unit::FreeClock => self.free_clock.write(offset, value, now, divider),
            Unit::Encoder => self.encoder.write(offset, value, now, divider),
            Unit::Converter => {
                self.meter.write(now);
                self.converter.write(offset, value)
            }
            Unit::Serial => self.serial.write(offset, value),
            Unit::Watchdog => self.watchdog.write(offset, value, now, self.clock.core()),
        }
    }

    /// Resets the units whose bits are set in the register of resets at `offset`.
    fn reset_units(&mut self, offset: u32) {
        for place in self.chip.map {
            if let Some((_, reset, bit)) = place.clocked
                && reset == offset
                && self.clock.is_set(reset, bit)
            {
                self.reset_unit(place.unit);
            }
        }
    }

    fn reset_unit(&mut self, unit: Unit) {
        match unit {
            Unit::Clock | Unit::Watchdog => {}
            Unit::Power => self.power = (self.chip.power)(),
            Unit::Flash => self.flash = (self.chip.flash_interface)(),
            Unit::Configuration => self.configuration = (self.chip.configuration)(),
            Unit::Debug => self.debug = Plain::new(DEBUG),
            Unit::Pins(port) => self.ports[port] = (self.chip.ports)(port),
            Unit::Pacer => self.pacer = Pacer::new(),
            Unit::FreeClock => self.free_clock = Counter::new(32),
            Unit::Encoder => self.encoder = Counter::new(self.chip.counter),
            Unit::Converter => self.converter = Converter::new(self.chip.converter),
            Unit::Serial => self.serial = Serial::new(self.chip.face),
        }
    }

    /// The interrupt lines as the units hold them.
    fn lines(&mut self) {
        let exceptions = &mut self.system.exceptions;
        exceptions.set_line(FIRST_INTERRUPT + PACER_INTERRUPT, self.pacer.line());
        exceptions.set_line(FIRST_INTERRUPT + self.chip.serial_interrupt, self.serial.line());
    }

    /// Takes down what has changed on the pins.
    fn look(&mut self) {
        let now = (self.torque(), self.amplifier());
        if now == self.seen {
            return;
        }
        if let Some(events) = &mut self.events {
            if now.0 != self.seen.0 {
                events.push((self.now, Event::Torque(now.0)));
            }
            if now.1 != self.seen.1 {
                events.push((self.now, Event::Amplifier(now.1)));
            }
        }
        self.seen = now;
    }

    /// Whether something has to be done before the next instruction.
    pub(crate) fn wants_attention(&self) -> bool {
        self.stopped.is_some() || self.bus_error.is_some() || self.system.reset_requested
    }

    fn stop(&mut self, unit: Option<&'static str>, address: u32, written: Option<u32>, why: Why) {
        let place = self.chip.at(address);
        let register = place.and_then(|place| (self.chip.names)(place.unit, address - place.base));
        self.stopped.get_or_insert(NotModelled { unit, register, address, written, why });
    }
}

/// Who has no answer, and why.
type Fault = (Option<&'static str>, Why);

fn of(name: &'static str) -> impl Fn(Unmodelled) -> Fault {
    move |why| (Some(name), Why::Unit(why))
}

/// The place in a region of 4 KiB.
fn within(address: u32, base: u32) -> Option<u32> {
    (address & !0xFFF == base).then(|| address - base)
}
