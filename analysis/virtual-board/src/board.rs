//! The board around the core: its peripherals on their bus, and the world that is wired to them.

mod bus;

use crate::chip::{Chip, PACER_INTERRUPT, TORQUE};
use crate::core::System;
use crate::core::exceptions::{FIRST_INTERRUPT, SYS_TICK};
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
use crate::trouble::NotModelled;

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
    /// The flash memory's interface.
    pub flash: Plain,
    /// System configuration.
    pub configuration: Plain,
    /// The unit for debugging.
    pub debug: Plain,
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
            debug: (chip.debug)(),
            ports: (0..9).map(chip.ports).collect(),
            bus_error: None,
            seen: (None, Level::Floating),
        }
    }

    /// The chip.
    pub fn chip(&self) -> &'static Chip {
        self.chip
    }

    /// Every unit as out of reset; memory, time and the world stay, and with them the option bytes and
    /// what a debugger has set.
    pub fn reset(&mut self, cause: Cause) {
        let device = std::mem::replace(&mut self.device, Box::new(Still));
        let mut fresh = Self::new(self.chip, device);
        fresh.flash = self.flash_after_reset();
        fresh.debug = self.debug.clone();
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

    /// The flash memory's interface out of reset, with the option bytes as they are.
    fn flash_after_reset(&self) -> Plain {
        let mut flash = (self.chip.flash_interface)();
        flash.set(self.chip.options, self.flash.get(self.chip.options));
        flash
    }

    /// Level of the amplifier's line.
    pub fn amplifier(&self) -> Level {
        let (port, pin) = self.chip.amplifier;
        self.ports[port].level(pin)
    }

    /// Level that the program gives a pin.
    pub fn level(&self, port: usize, pin: u32) -> Level {
        self.ports[port].level(pin)
    }

    /// Whether the program has the chip pull an encoder's pin up or down.
    pub fn pulls_encoder(&self) -> bool {
        let (pins, _) = self.chip.encoder;
        pins.iter().any(|&(port, pin)| self.ports[port].is_pulled(pin))
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
}
