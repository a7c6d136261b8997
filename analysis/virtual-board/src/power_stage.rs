//! The power stage of a board: TIM1 and the analogue units of the chip, and the circuit around them.
//!
//! Everything here goes from event to event: an edge of a gate, an end of a dead time, a sampling, or the
//! clock at which a current reaches a comparator's threshold. Between two of them, the motor's currents are
//! exponentials.

mod circuit;
pub mod gate_log;
pub mod parts;

pub use circuit::{Circuit, Supply};

use crate::chip::{Chip, Stage};
use crate::device::Device;
use crate::motor::Leg;
use crate::peripheral::Access;
use crate::peripheral::adc::{Adc, AdcClock};
use crate::peripheral::analogue::Analogue;
use crate::peripheral::pins::{Level, Pins};
use crate::peripheral::pwm_timer::{BREAK, PwmTimer, SYSTEM_BREAK};

/// Levels of the gates: high sides, then low sides of the phases U, V and W.
pub type Gates = [Level; 6];

/// The converters' and the DACs' reference in V.
pub const REFERENCE: f64 = 3.3;

/// Pins of the shunts at the amplifiers and the comparators: of COMP1, COMP2 and COMP4, and so of the phases
/// U, V and W.
const SHUNTS: [(usize, u32); 3] = [(0, 1), (0, 7), (1, 0)];
/// Which comparator is at the shunt of each phase.
const COMPARATOR: [usize; 3] = [0, 1, 3];
/// The amplifiers' outputs.
const AMPLIFIED: [(usize, u32); 3] = [(0, 2), (0, 6), (1, 1)];
/// The thermistor, and the divider of the supply.
const THERMISTOR: (usize, u32) = (1, 14);
const DIVIDER: (usize, u32) = (0, 0);

/// The longest time that the circuit goes on for at once, in core clocks, and that of a step of the device
/// while no counter runs.
const LONGEST: u64 = 4250;
/// Places between two events at which the comparators are looked at: between them, a current has no peak.
const LOOKS: u64 = 4;

/// What the stage depends on besides itself.
pub(crate) struct Surroundings<'a> {
    pub chip: &'static Chip,
    pub ports: &'a [Pins],
    /// The core's clock in Hz.
    pub core: u64,
}

/// What a time has brought to the rest of the board.
#[derive(Default)]
pub(crate) struct Outcome {
    /// Counts of the encoder, one after the other, and whether TIM1's trigger output rose behind them.
    pub turns: Vec<(i32, bool)>,
    /// Changes of the gates.
    pub gates: Vec<(u64, Gates)>,
    /// Whether TIM1's channel 4 has made its request.
    pub request: bool,
    /// A converter that has sampled what nothing drives: which.
    pub floating: Option<usize>,
}

/// The power stage.
#[derive(Default)]
pub struct PowerStage {
    /// The circuit at the chip.
    pub circuit: Circuit,
    /// TIM1.
    pub timer: PwmTimer,
    /// ADC1 and ADC2.
    pub adcs: [Adc; 2],
    analogue: Analogue,
    /// Outputs of the comparators.
    tripped: [bool; 4],
    gates: Gates,
    /// Up to when everything here has happened.
    now: u64,
    /// When something happens next.
    due: Option<u64>,
    /// Since when the break's input is active.
    broken: Option<u64>,
    /// When the device has made its last step.
    stepped: u64,
    /// Both switches of a leg were on: when, and which leg.
    shoot_through: Option<(u64, usize)>,
    /// A high side was switched on whose gate's supply was not charged: when, and of which leg.
    uncharged: Option<(u64, usize)>,
}

impl PowerStage {
    /// The chip out of reset, with the circuit as it is.
    #[must_use]
    pub(crate) fn after_reset(&mut self) -> Self {
        Self {
            circuit: std::mem::take(&mut self.circuit),
            gates: self.gates,
            now: self.now,
            stepped: self.stepped,
            ..Self::default()
        }
    }

    /// Levels of the gates.
    pub fn gates(&self) -> Gates {
        self.gates
    }

    /// When both switches of a leg were on, and of which.
    pub fn shoot_through(&self) -> Option<(u64, usize)> {
        self.shoot_through
    }

    /// When a high side was switched on whose gate's supply was not charged, and of which leg.
    pub fn uncharged(&self) -> Option<(u64, usize)> {
        self.uncharged
    }

    /// When something happens next.
    pub fn due(&self) -> Option<u64> {
        self.due
    }

    /// Whether a converter asks for its interrupt.
    pub fn conversion_line(&self) -> bool {
        self.adcs.iter().any(Adc::line)
    }

    /// Goes on to a time.
    pub(crate) fn advance(
        &mut self,
        to: u64,
        around: &Surroundings<'_>,
        device: &mut dyn Device,
    ) -> Outcome {
        let mut outcome = Outcome::default();
        if self.circuit.motor.is_none() {
            self.stepped = self.now;
        }
        while let Some(due) = self.due.filter(|&due| due <= to) {
            self.flow(due, around);
            self.happen(around, device, &mut outcome);
            self.plan(around);
        }
        self.flow(to, around);
        outcome
    }

    /// After the program has changed something: gates may be on or off from now on.
    pub(crate) fn changed(&mut self, around: &Surroundings<'_>, outcome: &mut Outcome) {
        self.compare(around);
        self.drive(around, outcome);
        self.plan(around);
    }

    /// A break by the chip itself.
    pub fn break_by_system(&mut self) {
        self.timer.break_off(SYSTEM_BREAK);
    }

    /// What the program reads.
    pub(crate) fn read(&mut self, unit: Stage, offset: u32) -> Access<u32> {
        match unit {
            Stage::PwmTimer => self.timer.read(offset, self.now),
            Stage::Adc(number) => self.adcs[number].read(offset),
            _ => self.analogue.read(unit, offset, self.tripped),
        }
    }

    /// What the program writes; [`Self::changed`] has to follow. Whether TIM1's trigger output rises.
    pub(crate) fn write(
        &mut self,
        unit: Stage,
        offset: u32,
        value: u32,
        around: &Surroundings<'_>,
    ) -> Access<bool> {
        let (now, clock) = (self.now, self.clock(around));
        match unit {
            Stage::PwmTimer => {
                let triggers = self.timer.write(offset, value, now)?;
                if triggers {
                    self.trigger(around);
                }
                return Ok(triggers);
            }
            Stage::Adc(number) => self.adcs[number].write(offset, value, now, clock),
            _ => self.analogue.write(unit, offset, value),
        }?;
        Ok(false)
    }

    /// One of its units as out of reset.
    pub(crate) fn reset_unit(&mut self, unit: Stage) {
        match unit {
            Stage::PwmTimer => self.timer = PwmTimer::default(),
            Stage::Adc(number) => self.adcs[number] = Adc::default(),
            _ => self.analogue.reset(unit),
        }
    }

    fn clock(&self, around: &Surroundings<'_>) -> AdcClock {
        AdcClock { core: around.core, divider: self.analogue.adc_divider() }
    }

    fn trigger(&mut self, around: &Surroundings<'_>) {
        let clock = self.clock(around);
        for adc in &mut self.adcs {
            adc.trigger(self.now, clock);
        }
    }

    /// Currents flow, and nothing else happens, up to a time.
    fn flow(&mut self, to: u64, around: &Surroundings<'_>) {
        if to > self.now {
            let seconds = seconds(to - self.now, around);
            let legs = self.legs();
            self.circuit.advance(legs, seconds);
            self.now = to;
        }
    }

    /// What happens now.
    fn happen(
        &mut self,
        around: &Surroundings<'_>,
        device: &mut dyn Device,
        outcome: &mut Outcome,
    ) {
        let (now, clock) = (self.now, self.clock(around));
        for number in 0..2 {
            if let Some(channel) = self.adcs[number].samples(now) {
                let volts = self.voltage(number, channel, around);
                if volts.is_none() {
                    outcome.floating = Some(number);
                }
                self.adcs[number].sample(code(volts.unwrap_or(0.0)));
            }
            self.adcs[number].advance(now, clock);
        }
        let instant = self.timer.advance(now);
        if instant.trigger {
            self.trigger(around);
        }
        outcome.request |= instant.request;
        let waits = !self.timer.runs() && self.circuit.motor.is_some();
        let steps = instant.valley || waits && now >= self.stepped + LONGEST;
        let counts = if steps { self.step(around, device) } else { 0 };
        if counts != 0 || instant.trigger {
            outcome.turns.push((counts, instant.trigger));
        }
        self.compare(around);
        self.drive(around, outcome);
    }

    /// A step of the device; the counts that the encoder has turned.
    fn step(&mut self, around: &Surroundings<'_>, device: &mut dyn Device) -> i32 {
        let passed = seconds(self.now - self.stepped, around);
        self.stepped = self.now;
        self.circuit.step(device, passed)
    }

    /// Compares, and lets the timer break.
    fn compare(&mut self, around: &Surroundings<'_>) {
        self.tripped = self.analogue.compare(self.inputs(&self.circuit, around));
        let since = self.broken.unwrap_or(self.now);
        let is_broken = self.timer.is_broken_by(self.tripped);
        self.broken = is_broken.then_some(since);
        if is_broken && self.now >= since + self.timer.filter() {
            self.timer.break_off(BREAK);
        }
    }

    /// Voltages at the comparators' pins, as parts of the reference; none where nothing is wired to one.
    fn inputs(&self, circuit: &Circuit, around: &Surroundings<'_>) -> [Option<f64>; 4] {
        let (mut inputs, legs) = ([None; 4], self.legs());
        for phase in 0..3 {
            let is_wired = is_analog(around.ports, SHUNTS[phase]);
            let part = || circuit.compared(phase, legs[phase]) / REFERENCE;
            inputs[COMPARATOR[phase]] = is_wired.then(part);
        }
        inputs
    }

    /// Voltage at a converter's channel; none where nothing drives it.
    fn voltage(&self, adc: usize, channel: u32, around: &Surroundings<'_>) -> Option<f64> {
        let ports = around.ports;
        let amplified = |phase: usize| {
            let is_on = self.analogue.amplifies(phase) && is_analog(ports, SHUNTS[phase]);
            let leg = self.legs()[phase];
            (is_on && is_analog(ports, AMPLIFIED[phase]))
                .then(|| self.circuit.amplified(phase, leg))
        };
        match (adc, channel) {
            (0, 3) => amplified(0),
            (1, 3) => amplified(1),
            (0, 12) => amplified(2),
            (0, 5) => is_analog(ports, THERMISTOR).then(|| self.circuit.thermistor()),
            (1, 1) => is_analog(ports, DIVIDER).then(|| self.circuit.divided()),
            _ => None,
        }
    }

    /// Sets the gates as the pins and the timer have them.
    fn drive(&mut self, around: &Surroundings<'_>, outcome: &mut Outcome) {
        let Some(pins) = around.chip.gates else { return };
        let gates: Gates = std::array::from_fn(|gate| {
            let ((port, pin), function) = pins[gate];
            let pins = &around.ports[port];
            if pins.function(pin) != Some(function) {
                return pins.level(pin);
            }
            let outputs = self.timer.outputs(gate % 3, self.now);
            if gate < 3 { outputs.high } else { outputs.low }
        });
        if gates == self.gates {
            return;
        }
        self.gates = gates;
        outcome.gates.push((self.now, gates));
        let shorted = (0..3).find(|&leg| is_on(gates[leg]) && is_on(gates[leg + 3]));
        if let Some(leg) = shorted {
            self.shoot_through.get_or_insert((self.now, leg));
        }
        let uncharged = (0..3).find(|&leg| is_on(gates[leg]) && !self.circuit.is_charged(leg));
        if let Some(leg) = uncharged {
            self.uncharged.get_or_insert((self.now, leg));
        }
    }

    /// What the gates switch: a gate that floats is off, by its driver's own resistor, and so is a high side whose
    /// gate has no supply.
    fn legs(&self) -> [Leg; 3] {
        [0, 1, 2].map(|leg| match (is_on(self.gates[leg]), is_on(self.gates[leg + 3])) {
            (true, _) if self.circuit.is_charged(leg) => Leg::High,
            (false, true) => Leg::Low,
            (true, _) | (false, false) => Leg::Off,
        })
    }

    /// When something happens next.
    fn plan(&mut self, around: &Surroundings<'_>) {
        let filtered = self.broken.map(|since| since + self.timer.filter());
        let steps = self.circuit.motor.is_some().then(|| match self.timer.runs() {
            true => self.now + LONGEST,
            false => (self.stepped + LONGEST).max(self.now + 1),
        });
        let [first, second] = [0, 1].map(|number| self.adcs[number].due());
        let events = [self.timer.next(self.now), filtered, steps, first, second];
        let next = events.into_iter().flatten().filter(|&at| at > self.now).min();
        let trips = next.and_then(|next| self.trips(next, around));
        self.due = trips.or(next);
    }

    /// Whether a comparator's output may change before the next event, by how fast currents can change at most.
    fn can_trip(&self, next: u64, around: &Surroundings<'_>) -> bool {
        let seconds = seconds(next - self.now, around);
        let change = self.circuit.largest_shunt_change(seconds) / REFERENCE;
        let inputs = self.inputs(&self.circuit, around);
        let outputs = |change: f64| {
            self.analogue.compare(inputs.map(|input| input.map(|part| part + change)))
        };
        let low = outputs(-change);
        low != outputs(change) || self.timer.is_broken_by(low)
    }

    /// The clock before the next event at which a comparator begins to break the outputs.
    fn trips(&self, next: u64, around: &Surroundings<'_>) -> Option<u64> {
        let cannot = self.broken.is_some() || !self.timer.is_on() || !self.analogue.compares();
        if cannot || !self.can_trip(next, around) {
            return None;
        }
        let breaks = |at: u64| {
            let mut circuit = self.circuit;
            circuit.advance(self.legs(), seconds(at - self.now, around));
            self.timer.is_broken_by(self.analogue.compare(self.inputs(&circuit, around)))
        };
        let look = |number: u64| self.now + (next - self.now) * number / LOOKS;
        let late = (1..=LOOKS).find(|&number| breaks(look(number)))?;
        let (mut before, mut after) = (look(late - 1), look(late));
        while after - before > 1 {
            let middle = before + (after - before) / 2;
            if breaks(middle) { after = middle } else { before = middle }
        }
        (after < next).then_some(after)
    }
}

fn seconds(clocks: u64, around: &Surroundings<'_>) -> f64 {
    clocks as f64 / around.core.max(1) as f64
}

fn is_analog(ports: &[Pins], (port, pin): (usize, u32)) -> bool {
    ports[port].is_analog(pin)
}

fn is_on(level: Level) -> bool {
    level == Level::High
}

/// A converter's code: the nearest.
fn code(volts: f64) -> u16 {
    (volts / REFERENCE * 4096.0 + 0.5).floor().clamp(0.0, 4095.0) as u16
}
