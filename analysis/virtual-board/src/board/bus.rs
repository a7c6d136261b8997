//! The board's bus: the reads and writes of a program, and the errors of accesses.

use super::{BusAccess, VirtualBoard, wired};
use crate::chip::{LINE_PORTS, MapEntry, Stage, TICK_INTERRUPT, Unit};
use crate::core::System;
use crate::core::exceptions::Number;
use crate::core::system::{SYSTEM, pends};
use crate::error::{AccessError, NotModelled};
use crate::peripheral::Access;
use crate::peripheral::basic_timer::BasicTimer;
use crate::peripheral::checksum::ChecksumUnit;
use crate::peripheral::counter::Counter;
use crate::peripheral::dac::Dac;
use crate::peripheral::dma::Dma;
use crate::peripheral::edges::Edges;
use crate::peripheral::pins::{self, Level};
use crate::peripheral::registers::Registers;
use crate::peripheral::serial::Serial;
use crate::peripheral::spi::Spi;
use crate::power_stage::Surroundings;

/// The target of an address, with the offset of a register.
enum Target {
    /// Priorities of exceptions, a byte each, from this exception on.
    Priorities(Number),
    /// The system control space.
    System(u32),
    /// A peripheral.
    Unit(&'static MapEntry, u32),
}

impl Target {
    fn name(&self) -> &'static str {
        match self {
            Self::Priorities(_) | Self::System(_) => "the system control space",
            Self::Unit(map_entry, _) => map_entry.name,
        }
    }
}

/// The unit and the error of a failed access.
type Fault = (Option<&'static str>, AccessError);

impl VirtualBoard {
    /// Reads for the program.
    pub fn read(&mut self, address: u32, size: usize) -> u32 {
        if self.has_bus_error(address) {
            return 0;
        }
        let value = self.try_read(address, size).unwrap_or_else(|fault| {
            self.stop(fault, address, None);
            0
        });
        self.record_access(address, false, value);
        value
    }

    /// Writes for the program.
    pub fn write(&mut self, address: u32, size: usize, value: u32) {
        if self.has_bus_error(address) {
            return;
        }
        self.record_access(address, true, value);
        if let Err(fault) = self.try_write(address, size, value) {
            self.stop(fault, address, Some(value));
        }
        self.serial.advance(self.now, self.clock.bus_divider());
        self.update_interrupt_lines();
        self.record_pin_events();
    }

    fn record_access(&mut self, address: u32, writes: bool, value: u32) {
        let at = self.now;
        if let Some(accesses) = &mut self.accesses {
            accesses.push(BusAccess { at, address, writes, value });
        }
    }

    /// Whether the bus has an error there, which is stored for the core.
    fn has_bus_error(&mut self, address: u32) -> bool {
        let is_broken = self.broken == Some(address);
        if is_broken {
            self.bus_error = Some(address);
        }
        is_broken
    }

    fn try_read(&mut self, address: u32, size: usize) -> Result<u32, Fault> {
        let target = self.find(address, size)?;
        let value = match target {
            Target::Priorities(first) => {
                let numbers = first..first + size as Number;
                let bytes = numbers.rev().map(|number| self.system.exceptions.priority(number));
                Ok(bytes.fold(0, |word, byte| word << 8 | u32::from(byte)))
            }
            Target::System(offset) => self.system.read(offset),
            Target::Unit(map_entry, offset) => self.read_unit(map_entry.unit, offset),
        };
        value.map_err(|why| (Some(target.name()), AccessError::Unit(why)))
    }

    fn try_write(&mut self, address: u32, size: usize, value: u32) -> Result<(), Fault> {
        let target = self.find(address, size)?;
        let done = match target {
            Target::Priorities(first) => {
                for (number, byte) in (first..first + size as Number).zip(value.to_le_bytes()) {
                    self.system.exceptions.set_priority(number, byte);
                }
                Ok(())
            }
            Target::System(offset) => {
                // With a bridge.
                if pends(offset, value, TICK_INTERRUPT) {
                    self.end_sample();
                }
                self.system.write(offset, value)
            }
            Target::Unit(map_entry, offset) => self.write_unit(map_entry.unit, offset, value),
        };
        done.map_err(|why| (Some(target.name()), AccessError::Unit(why)))
    }

    /// The target of an access with a size in bytes.
    fn find(&self, address: u32, size: usize) -> Result<Target, Fault> {
        if let Some(offset) = within(address, SYSTEM) {
            let priorities = System::priority_at(offset).map(Target::Priorities);
            return Ok(priorities.unwrap_or(Target::System(offset)));
        }
        let map_entry = self.map_entry(address)?;
        // The serial port's data register may be accessed by bytes.
        if size == 1 && map_entry.unit != Unit::Serial {
            return Err((Some(map_entry.name), AccessError::Width));
        }
        Ok(Target::Unit(map_entry, address - map_entry.base))
    }

    /// The unit at an address, if it is clocked and not held in reset.
    fn map_entry(&self, address: u32) -> Result<&'static MapEntry, Fault> {
        let map_entry = self.chip.at(address).ok_or((None, AccessError::Nobody))?;
        match map_entry.clocked {
            Some((clock, reset, bit))
                if !self.clock.is_set(clock, bit) || self.clock.is_set(reset, bit) =>
            {
                Err((Some(map_entry.name), AccessError::Stopped))
            }
            _ => Ok(map_entry),
        }
    }

    fn read_unit(&mut self, unit: Unit, offset: u32) -> Access<u32> {
        let (now, divider) = (self.now, self.clock.timer_divider());
        match unit {
            Unit::Clock => self.clock.read(offset),
            Unit::Power => self.power.read(offset),
            Unit::Flash => self.flash.read(offset),
            Unit::Configuration => self.configuration.read(offset),
            Unit::Debug => self.debug.read(offset),
            Unit::Pins(port) if offset == pins::INPUT => {
                self.advance_power_stage();
                Ok(self.input(port))
            }
            Unit::Pins(port) => self.ports[port].read(offset),
            Unit::TickTimer => self.tick_timer.read(offset),
            Unit::PhaseTimer => self.phase_timer.read(offset),
            Unit::FreeClock => self.free_clock.read(offset, now, divider),
            Unit::Encoder => {
                self.meter.read(now);
                self.encoder.read(offset, now, divider)
            }
            Unit::Dac => self.dac.read(offset),
            Unit::Serial => self.serial.read(offset),
            Unit::Spi => self.spi.read(offset, now),
            Unit::Dma => self.dma.read(offset),
            Unit::DmaMultiplexer => self.dma.read_multiplexer(offset),
            Unit::Edges => self.edges.read(offset, self.fallen()),
            Unit::Checksum => self.checksum.read(offset),
            Unit::Watchdog => self.watchdog.read(offset),
            Unit::Stage(unit) => {
                self.advance_power_stage();
                // The comparators' levels are updated first.
                if unit == Stage::Comparators {
                    self.power_stage_changed();
                }
                self.power_stage.read(unit, offset)
            }
        }
    }

    /// The pin of a magnetic encoder's data line, if it is connected to the detector of edges, and when it has fallen.
    fn fallen(&self) -> Option<(u32, u64)> {
        let ([_, _, (port, pin), _], _) = self.chip.bus?.pins;
        let ports = self.configuration.get(LINE_PORTS + pin / 4 * 4);
        let is_of_port = ports >> (4 * (pin % 4)) & 0xF == port as u32;
        let fell = self.magnetic.as_ref()?.fell?;
        is_of_port.then_some((pin, fell))
    }

    /// IDR: the pins that this chip drives high, and a magnetic encoder's data line. Other pins that others drive are
    /// not modelled.
    fn input(&self, port: usize) -> u32 {
        let gates = self.chip.gates.iter().flat_map(|gates| gates.iter());
        let gates = gates.zip(self.power_stage.gates());
        let of_timer = |pin: u32| {
            gates.clone().any(|(gate, level)| gate.0 == (port, pin) && level == Level::High)
        };
        let of_encoder = |pin: u32| {
            let is_line = self.chip.bus.is_some_and(|bus| bus.pins.0[2] == (port, pin));
            let is_pulled = self.ports[port].is_pulled(pin);
            is_line && self.magnetic.as_ref().map_or(is_pulled, |chip| chip.line(self.now))
        };
        let is_high = |pin: &u32| {
            self.ports[port].level(*pin) == Level::High || of_timer(*pin) || of_encoder(*pin)
        };
        (0..16).filter(is_high).map(|pin| 1 << pin).sum()
    }

    fn write_unit(&mut self, unit: Unit, offset: u32, value: u32) -> Access<()> {
        let changes_power_stage = matches!(unit, Unit::Stage(_))
            || matches!(unit, Unit::Pins(_) | Unit::Clock) && self.chip.gates.is_some();
        if changes_power_stage {
            self.advance_power_stage();
        }
        self.write_registers(unit, offset, value)?;
        if changes_power_stage {
            self.power_stage_changed();
        }
        Ok(())
    }

    fn write_registers(&mut self, unit: Unit, offset: u32, value: u32) -> Access<()> {
        let (now, divider) = (self.now, self.clock.timer_divider());
        match unit {
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
            Unit::TickTimer => self.tick_timer.write(offset, value, now, divider),
            Unit::PhaseTimer => self.phase_timer.write(offset, value, now, divider),
            Unit::FreeClock => self.free_clock.write(offset, value, now, divider),
            Unit::Encoder => self.encoder.write(offset, value, now, divider),
            Unit::Dac => {
                self.meter.write(now);
                self.dac.write(offset, value)
            }
            Unit::Serial => self.serial.write(offset, value),
            Unit::Spi => {
                let bus_divider = self.clock.bus_divider();
                let Self { magnetic, ports, chip, spi, .. } = self;
                spi.write(offset, value, (now, bus_divider), wired(magnetic, ports, chip))
            }
            Unit::Dma => self.dma.write(offset, value),
            Unit::DmaMultiplexer => self.dma.write_multiplexer(offset, value),
            Unit::Edges => self.edges.write(offset, value, now),
            Unit::Checksum => self.checksum.write(offset, value),
            Unit::Watchdog => self.watchdog.write(offset, value, now, self.clock.core()),
            Unit::Stage(unit) => {
                let Self { power_stage, ports, chip, clock, .. } = self;
                let around = Surroundings { chip, ports, core: clock.core() };
                if power_stage.write(unit, offset, value, &around)? {
                    self.encoder.capture();
                }
                Ok(())
            }
        }
    }

    /// Resets the units whose bits are set in the register of resets at `offset`.
    fn reset_units(&mut self, offset: u32) {
        for map_entry in self.chip.units() {
            if let Some((_, reset, bit)) = map_entry.clocked
                && reset == offset
                && self.clock.is_set(reset, bit)
            {
                self.reset_unit(map_entry.unit);
            }
        }
    }

    fn reset_unit(&mut self, unit: Unit) {
        match unit {
            Unit::Clock | Unit::Watchdog => {}
            Unit::Power => self.power = Registers::new(self.chip.power),
            Unit::Flash => self.flash = self.flash_after_reset(),
            Unit::Configuration => self.configuration = Registers::new(self.chip.configuration),
            Unit::Debug => self.debug = Registers::new(self.chip.debug),
            Unit::Pins(port) => self.ports[port] = (self.chip.ports)(port),
            Unit::TickTimer => self.tick_timer = BasicTimer::default(),
            Unit::PhaseTimer => self.phase_timer = BasicTimer::default(),
            Unit::FreeClock => self.free_clock = Counter::new(32),
            Unit::Encoder => self.encoder = Counter::new(self.chip.counter),
            Unit::Dac => self.dac = Dac::new(self.chip.dac),
            Unit::Serial => self.serial = Serial::new(self.chip.usart),
            Unit::Spi => self.spi = Spi::default(),
            Unit::Dma | Unit::DmaMultiplexer => self.dma = Dma::default(),
            Unit::Edges => self.edges = Edges::default(),
            Unit::Checksum => self.checksum = ChecksumUnit::default(),
            Unit::Stage(unit) => self.power_stage.reset_unit(unit),
        }
    }

    /// Stores the first failed access, which ends the run.
    fn stop(&mut self, (unit, why): Fault, address: u32, written: Option<u32>) {
        self.stopped.get_or_insert(NotModelled { unit, address, written, why });
    }
}

/// The place in a region of 4 KiB.
fn within(address: u32, base: u32) -> Option<u32> {
    (address & !0xFFF == base).then(|| address - base)
}
