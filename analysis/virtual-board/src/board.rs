//! The board around the core: its peripherals on their bus, and the connected device.

mod bus;

use crate::chip::{
    BREAKS, Bus, CONVERSION_INTERRUPT, Chip, LOCK_UP_BREAKS, TICK_INTERRUPT, TORQUE,
    TRANSFER_INTERRUPT,
};
use crate::core::System;
use crate::core::exceptions::FIRST_INTERRUPT;
use crate::device::{Device, FixedDevice};
use crate::encoder_index::EncoderIndex;
use crate::error::{AccessError, NotModelled};
use crate::magnetic_encoder::MagneticEncoder;
use crate::meter::Meter;
use crate::peripheral::basic_timer::BasicTimer;
use crate::peripheral::checksum::ChecksumUnit;
use crate::peripheral::clock::{Cause, Clock};
use crate::peripheral::counter::Counter;
use crate::peripheral::dac::{Dac, Trigger};
use crate::peripheral::dma::{Dma, Move};
use crate::peripheral::edges::Edges;
use crate::peripheral::pins::{Level, Pins};
use crate::peripheral::registers::Registers;
use crate::peripheral::serial::Serial;
use crate::peripheral::spi::Spi;
use crate::peripheral::watchdog::Watchdog;
use crate::power_stage::{Gates, Outcome, PowerStage, Surroundings};

/// An event on the board's pins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The DAC's output changed.
    Torque(Option<u16>),
    /// The amplifier's line changed.
    Amplifier(Level),
}

/// The converters' first registers.
const CONVERTERS: [u32; 2] = [0x5000_0000, 0x5000_0100];

/// A program's access to a peripheral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusAccess {
    /// When.
    pub at: u64,
    /// Where.
    pub address: u32,
    /// Whether it wrote.
    pub writes: bool,
    /// What it read or wrote.
    pub value: u32,
}

/// The board.
pub struct VirtualBoard {
    /// Instructions since power-on, including waiting.
    pub now: u64,
    /// The core's registers in memory.
    pub system: System,
    /// Reset and clock control.
    pub clock: Clock,
    /// The pacing timer.
    pub tick_timer: BasicTimer,
    /// The timer that triggers the DAC at a phase of the pacing timer's period, if it runs.
    pub phase_timer: BasicTimer,
    /// The encoder's counter.
    pub encoder: Counter,
    /// The encoder's index, if it has a wired index.
    pub index: Option<EncoderIndex>,
    /// A magnetic encoder at the SPI, in place of the quadrature encoder.
    pub magnetic: Option<MagneticEncoder>,
    /// That SPI.
    pub spi: Spi,
    /// The detector of edges.
    edges: Edges,
    /// The unit for checksums.
    checksum: ChecksumUnit,
    /// What moves its words.
    pub dma: Dma,
    /// Whether a timer's request for a transfer was not served yet.
    transfer_requested: bool,
    /// The DAC.
    pub dac: Dac,
    /// The serial port.
    pub serial: Serial,
    /// The power stage, if the board has one.
    pub power_stage: PowerStage,
    /// The device at the motor and the encoder.
    pub device: Box<dyn Device + Send>,
    /// Instructions of the servo's interrupt.
    pub meter: Meter,
    /// Samples so far: updates of the pacing timer.
    pub samples: u64,
    /// A register with a bus error, to simulate a broken peripheral.
    pub broken: Option<u32>,
    /// Events of the pins, if they are recorded.
    pub events: Option<Vec<(u64, Event)>>,
    /// Changes of the power stage's gates, if they are recorded.
    pub gates: Option<Vec<(u64, Gates)>>,
    /// Accesses of the program to peripherals, if they are recorded.
    pub accesses: Option<Vec<BusAccess>>,
    pub(crate) stopped: Option<NotModelled>,
    chip: &'static Chip,
    free_clock: Counter,
    /// The watchdog.
    pub watchdog: Watchdog,
    power: Registers,
    /// The flash memory's interface.
    pub flash: Registers,
    /// System configuration.
    pub configuration: Registers,
    /// The unit for debugging.
    pub debug: Registers,
    ports: Vec<Pins>,
    pub(crate) bus_error: Option<u32>,
    seen: (Option<u16>, Level),
}

impl VirtualBoard {
    /// A board after power-on.
    pub fn new(chip: &'static Chip, device: Box<dyn Device + Send>) -> Self {
        Self {
            now: 0,
            system: System::default(),
            clock: Clock::new(chip.clock, chip.crystal, Cause::Power),
            tick_timer: BasicTimer::default(),
            phase_timer: BasicTimer::default(),
            encoder: Counter::new(chip.counter),
            index: None,
            magnetic: None,
            spi: Spi::default(),
            edges: Edges::default(),
            checksum: ChecksumUnit::default(),
            dma: Dma::default(),
            transfer_requested: false,
            dac: Dac::new(chip.dac),
            serial: Serial::new(chip.usart),
            power_stage: PowerStage::default(),
            device,
            meter: Meter::default(),
            samples: 0,
            broken: None,
            events: None,
            gates: None,
            accesses: None,
            stopped: None,
            chip,
            free_clock: Counter::new(32),
            watchdog: Watchdog::default(),
            power: Registers::new(chip.power),
            flash: Registers::new(chip.flash_interface),
            configuration: Registers::new(chip.configuration),
            debug: Registers::new(chip.debug),
            ports: (0..9).map(chip.ports).collect(),
            bus_error: None,
            seen: (None, Level::Floating),
        }
    }

    /// The chip.
    pub fn chip(&self) -> &'static Chip {
        self.chip
    }

    /// Resets every unit; memory, time, the device, the option bytes and the settings of a debugger stay.
    pub fn reset(&mut self, cause: Cause) {
        self.advance_power_stage();
        let device = std::mem::replace(&mut self.device, Box::new(FixedDevice));
        let mut fresh = Self::new(self.chip, device);
        fresh.flash = self.flash_after_reset();
        fresh.debug = self.debug.clone();
        *self = Self {
            now: self.now,
            meter: self.meter,
            samples: self.samples,
            index: self.index,
            magnetic: self.magnetic.take(),
            broken: self.broken,
            events: self.events.take(),
            gates: self.gates.take(),
            accesses: self.accesses.take(),
            power_stage: self.power_stage.after_reset(),
            clock: self.clock.after_reset(cause),
            seen: self.seen,
            ..fresh
        };
        self.power_stage_changed();
        self.record_pin_events();
    }

    /// The flash memory's interface after reset, with unchanged option bytes.
    fn flash_after_reset(&self) -> Registers {
        let mut flash = Registers::new(self.chip.flash_interface);
        flash.set(self.chip.options, self.flash.get(self.chip.options));
        flash
    }

    /// Level of the amplifier's line.
    pub fn amplifier(&self) -> Level {
        let (port, pin) = self.chip.amplifier;
        self.ports[port].level(pin)
    }

    /// Output level of a pin.
    pub fn level(&self, port: usize, pin: u32) -> Level {
        self.ports[port].level(pin)
    }

    /// Whether the chip pulls an encoder's pin up or down.
    pub fn pulls_encoder(&self) -> bool {
        let (pins, _) = self.chip.encoder;
        pins.iter().any(|&(port, pin)| self.ports[port].is_pulled(pin))
    }

    /// The code at the torque's pin; `None` if it is not driven.
    pub fn torque(&self) -> Option<u16> {
        let (port, pin) = TORQUE;
        self.dac.output().filter(|_| self.ports[port].is_analog(pin))
    }

    /// The time of the next event that is not an instruction.
    pub fn due(&self) -> u64 {
        let timers = [self.tick_timer.due(), self.phase_timer.due()];
        timers
            .into_iter()
            .chain([self.serial.due(), self.watchdog.due(), self.power_stage.due(), self.spi.due()])
            .chain([self.move_due()])
            .flatten()
            .min()
            .unwrap_or(u64::MAX)
    }

    /// Runs due events; returns whether the watchdog resets the board.
    pub fn advance(&mut self) -> bool {
        let now = self.now;
        self.advance_power_stage();
        let divider = self.clock.timer_divider();
        if self.tick_timer.advance(now, divider) {
            self.sample();
            self.request_transfer(self.tick_timer.requests());
        }
        if self.phase_timer.advance(now, divider) && self.phase_timer.triggers() {
            self.dac.trigger(Trigger::Tim7);
        }
        let bus_divider = self.clock.bus_divider();
        self.serial.advance(now, bus_divider);
        let Self { magnetic, ports, chip, spi, .. } = self;
        spi.advance(now, bus_divider, wired(magnetic, ports, chip));
        self.update_interrupt_lines();
        self.record_pin_events();
        self.watchdog.due().is_some_and(|due| due <= now)
    }

    /// The pacing timer's update: it ends a sample for the device, and the DAC begins the next. The output is
    /// the code at the end of the sample; a device whose codes have a phase knows its time.
    fn sample(&mut self) {
        self.end_sample();
        if self.tick_timer.triggers() {
            self.dac.trigger(Trigger::Tim6);
        }
    }

    /// Ends a sample: at an update of the pacing timer, or at the servo's interrupt that the program pends.
    fn end_sample(&mut self) {
        self.samples += 1;
        let is_on = self.amplifier() == Level::High || self.power_stage.timer.is_on();
        let counts = self.device.sample(self.torque(), is_on);
        self.turn_encoder(counts);
    }

    /// Advances the power stage to the present time.
    fn advance_power_stage(&mut self) {
        let Self { power_stage, device, ports, chip, clock, now, .. } = self;
        if chip.gates.is_none() {
            return;
        }
        let around = Surroundings { chip, ports, core: clock.core() };
        let outcome = power_stage.advance(*now, &around, &mut **device);
        self.take(outcome);
    }

    /// Updates the power stage after a change by the program or a test.
    pub fn power_stage_changed(&mut self) {
        let Self { power_stage, ports, chip, clock, .. } = self;
        if chip.gates.is_none() {
            return;
        }
        let mut outcome = Outcome::default();
        let around = Surroundings { chip, ports, core: clock.core() };
        power_stage.changed(&around, &mut outcome);
        self.take(outcome);
    }

    /// Breaks the power stage after a failure of the chip's clock.
    pub(crate) fn break_power_stage(&mut self) {
        self.advance_power_stage();
        self.power_stage.break_by_system();
        self.power_stage_changed();
    }

    /// The core is locked up, which breaks the power stage if the program has configured this.
    pub(crate) fn lock_up(&mut self) {
        if self.chip.gates.is_some() && self.configuration.get(BREAKS) & LOCK_UP_BREAKS != 0 {
            self.break_power_stage();
        }
    }

    fn take(&mut self, outcome: Outcome) {
        let Outcome { turns, gates, request, floating } = outcome;
        self.request_transfer(request);
        for (counts, triggers) in turns {
            self.turn_encoder(counts);
            if triggers {
                self.encoder.capture();
            }
        }
        if let Some(recorded) = &mut self.gates {
            recorded.extend(gates);
        }
        if let Some(number) = floating {
            let address = CONVERTERS[number];
            let unit = self.chip.at(address).map(|map_entry| map_entry.name);
            let (written, why) = (None, AccessError::Floating);
            self.stopped.get_or_insert(NotModelled { unit, address, written, why });
        }
    }

    /// A timer may make the request for a transfer, which only counts while a channel serves it.
    fn request_transfer(&mut self, is_made: bool) {
        let serves = |bus: Bus| self.dma.serves(bus.begins);
        self.transfer_requested |= is_made && self.chip.bus.is_some_and(serves);
    }

    /// The next move of the DMA, whose memory is the core's.
    pub(crate) fn next_move(&mut self) -> Option<Move> {
        let requests = self.requests();
        let next = self.dma.next(self.now, |request| requests.contains(&Some(request)))?;
        let begins = self.chip.bus.map(|bus| bus.begins);
        self.transfer_requested &= begins != Some(next.request);
        Some(next)
    }

    /// When the DMA moves next.
    fn move_due(&self) -> Option<u64> {
        let requests = self.requests();
        self.dma.due(|request| requests.contains(&Some(request)))
    }

    /// The requests of units to the DMA.
    fn requests(&self) -> [Option<u32>; 3] {
        let Some(Bus { received, wanted, begins, .. }) = self.chip.bus else { return [None; 3] };
        [
            self.transfer_requested.then_some(begins),
            self.spi.requests_taking().then_some(received),
            self.spi.requests_word().then_some(wanted),
        ]
    }

    /// Turns the encoder, which counts if the program has configured its pins as wired.
    pub fn turn_encoder(&mut self, counts: i32) {
        if let Some(magnetic) = &mut self.magnetic {
            magnetic.is_cut = self.device.readings_fail();
            magnetic.turn(counts, self.now);
            return;
        }
        let rose = self.index.as_mut().and_then(|index| index.turn(counts));
        if !self.is_wired(self.chip.encoder) {
            return;
        }
        let before = rose.unwrap_or(0);
        self.encoder.turn(before);
        let is_index_wired = self.chip.index.is_some_and(|(pin, function)| {
            let (port, pin) = pin;
            self.ports[port].function(pin) == Some(function)
        });
        if rose.is_some() && is_index_wired {
            self.encoder.index();
        }
        self.encoder.turn(counts - before);
    }

    /// Sends bytes on the line to the program, if its pin is configured for that.
    pub fn send(&mut self, bytes: &[u8]) {
        if self.is_wired(self.chip.serial) {
            self.serial.send(bytes);
            self.serial.advance(self.now, self.clock.bus_divider());
        }
    }

    /// Whether both pins have this alternate function.
    fn is_wired(&self, pins: ([(usize, u32); 2], u32)) -> bool {
        is_wired(&self.ports, pins)
    }

    /// Sets the interrupt lines from the units.
    fn update_interrupt_lines(&mut self) {
        let exceptions = &mut self.system.exceptions;
        exceptions.set_line(FIRST_INTERRUPT + TICK_INTERRUPT, self.tick_timer.line());
        exceptions.set_line(FIRST_INTERRUPT + TRANSFER_INTERRUPT, self.dma.line());
        exceptions.set_line(FIRST_INTERRUPT + self.chip.serial_interrupt, self.serial.line());
        if self.chip.gates.is_some() {
            let line = self.power_stage.conversion_line();
            exceptions.set_line(FIRST_INTERRUPT + CONVERSION_INTERRUPT, line);
        }
    }

    /// Records the events of pins that have changed.
    fn record_pin_events(&mut self) {
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

    /// Whether an event is due before the next instruction.
    pub(crate) fn wants_attention(&self) -> bool {
        self.stopped.is_some()
            || self.bus_error.is_some()
            || self.system.reset_requested
            || self.move_due().is_some_and(|due| due <= self.now)
    }
}

/// The chip at the bus, if the program has connected all its pins.
fn wired<'c>(
    magnetic: &'c mut Option<MagneticEncoder>,
    ports: &[Pins],
    chip: &Chip,
) -> Option<&'c mut MagneticEncoder> {
    magnetic.as_mut().filter(|_| chip.bus.is_some_and(|bus| is_wired(ports, bus.pins)))
}

/// Whether all of some pins have this alternate function.
fn is_wired<const N: usize>(ports: &[Pins], (pins, function): ([(usize, u32); N], u32)) -> bool {
    pins.iter().all(|&(port, pin)| ports[port].function(pin) == Some(function))
}
