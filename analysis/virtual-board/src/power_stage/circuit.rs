//! The circuit at the power stage's chip on a B-G431B-ESC1 (UM2516 and the schematic of MB1419): the motor,
//! the supply, the shunts, and the sensors.

use super::REFERENCE;
use super::parts::{BOOTSTRAP_ENOUGH, BOOTSTRAP_LOSS, Parts};
use crate::device::{Device, Motion};
use crate::motor::{Leg, Motor};

const ZERO_CELSIUS: f64 = 273.15;

/// The supply at the bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// Volts.
    pub volts: f64,
    /// Capacitance in F of a supply that takes nothing back: energy from the motor stays there. `None` for a
    /// supply that keeps its voltage.
    pub capacitance: Option<f64>,
    /// Volts that it does not fall below.
    pub source: f64,
}

impl Supply {
    /// A supply that takes energy back and keeps its voltage.
    pub fn stiff(volts: f64) -> Self {
        Self { volts, capacitance: None, source: volts }
    }

    /// A supply that takes nothing back, with this capacitance in F at the bridge.
    pub fn that_stores(volts: f64, capacitance: f64) -> Self {
        Self { volts, capacitance: Some(capacitance), source: volts }
    }

    fn deliver(&mut self, charge: f64) {
        if let Some(capacitance) = self.capacitance {
            self.volts = (self.volts - charge / capacitance).max(self.source);
        }
    }
}

/// The circuit around the chip.
#[derive(Clone, Copy, Debug)]
pub struct Circuit {
    /// The motor, where one is wired.
    pub motor: Option<Motor>,
    /// The parts around the chip.
    pub parts: Parts,
    /// The supply.
    pub supply: Supply,
    /// Temperature in °C at the board's sensor.
    pub temperature: f64,
    /// What a fault adds to each amplifier's output, in V.
    pub amplifier_errors: [f64; 3],
    /// Current in A from the supply into each output, as through a resistor of a short circuit: through the low
    /// side to ground while it conducts.
    pub leaks: [f64; 3],
    /// Charge of the supply of each high side's gate, as a part of the full one.
    bootstraps: [f64; 3],
    /// Whether the motor's shaft is held.
    pub is_blocked: bool,
    /// How the device moved last.
    pub(super) motion: Motion,
    /// Integral of the torque since the device's last step, in N m s.
    torque: f64,
    /// Mean of the torque in the device's last step, in N m.
    mean: f64,
}

impl Default for Circuit {
    fn default() -> Self {
        Self {
            motor: None,
            parts: Parts::NOMINAL,
            supply: Supply::stiff(24.0),
            temperature: 25.0,
            amplifier_errors: [0.0; 3],
            leaks: [0.0; 3],
            bootstraps: [0.0; 3],
            is_blocked: false,
            motion: Motion::default(),
            torque: 0.0,
            mean: 0.0,
        }
    }
}

impl Circuit {
    /// Mean of the torque in the last step of the device, in N m.
    pub fn mean_torque(&self) -> f64 {
        self.mean
    }

    /// Currents into the motor, in A.
    pub fn currents(&self) -> [f64; 3] {
        self.motor.map_or([0.0; 3], |motor| motor.currents())
    }

    /// Time passes, in s.
    pub(super) fn advance(&mut self, legs: [Leg; 3], seconds: f64) {
        for (charge, leg) in self.bootstraps.iter_mut().zip(legs) {
            let (end, lag) = match leg {
                Leg::Low => (1.0, self.parts.bootstrap),
                Leg::High | Leg::Off => (0.0, BOOTSTRAP_LOSS),
            };
            *charge = end + (*charge - end) * (-seconds / lag).exp();
        }
        if let Some(motor) = &mut self.motor {
            let totals = motor.advance(legs, self.supply.volts, seconds);
            self.supply.deliver(totals.charge);
            self.torque += totals.torque;
        }
    }

    /// Whether a high side's gate has the voltage to conduct.
    pub(super) fn is_charged(&self, phase: usize) -> bool {
        self.bootstraps[phase] >= BOOTSTRAP_ENOUGH
    }

    /// The device goes on by the time since the last step, in s; the counts that the encoder shows of it.
    pub(super) fn step(&mut self, device: &mut dyn Device, seconds: f64) -> i32 {
        let Some(motor) = &mut self.motor else { return 0 };
        self.mean = if seconds > 0.0 { self.torque / seconds } else { 0.0 };
        self.torque = 0.0;
        if self.is_blocked {
            self.motion = Motion { counts: 0, speed: 0.0, ..self.motion };
        } else {
            self.motion = device.turn(self.mean, seconds);
        }
        // The angle in the middle of the period to come.
        motor.turn(self.motion.angle + 0.5 * seconds * self.motion.speed, self.motion.speed);
        self.motion.counts
    }

    /// How far the voltage at a shunt's pin can change within a time, in V and s, while no leg is switched.
    pub(super) fn largest_shunt_change(&self, seconds: f64) -> f64 {
        let change = |motor: &Motor| motor.largest_change(self.supply.volts, seconds);
        let per_amp = self.parts.senses.map(|sense| sense.pin_per_amp()).into_iter();
        per_amp.fold(0.0, f64::max) * self.motor.as_ref().map_or(0.0, change)
    }

    /// Voltage at a shunt's pin of the chip: a current into the motor pulls it down.
    pub(super) fn shunt(&self, phase: usize, leg: Leg) -> f64 {
        let motor = self.motor.map_or(0.0, |motor| motor.low_side_current(phase, leg));
        let leak = if leg == Leg::Low { self.leaks[phase] } else { 0.0 };
        let current = motor - leak;
        self.parts.senses[phase].pin(current, REFERENCE)
    }

    /// Voltage that a shunt's comparator compares: at its pin, without the comparator's offset.
    pub(super) fn compared(&self, phase: usize, leg: Leg) -> f64 {
        self.shunt(phase, leg) - self.parts.senses[phase].comparator_offset
    }

    /// Voltage at its amplifier's output, which ends at the rails.
    pub(super) fn amplified(&self, phase: usize, leg: Leg) -> f64 {
        let volts = self.parts.senses[phase].amplified(self.shunt(phase, leg));
        (volts + self.amplifier_errors[phase]).clamp(0.0, REFERENCE)
    }

    /// Voltage of the thermistor against its resistor to ground.
    pub(super) fn thermistor(&self) -> f64 {
        let [resistance, beta, to_ground] = self.parts.thermistor;
        let inverse = |celsius: f64| 1.0 / (celsius + ZERO_CELSIUS);
        let resistance = resistance * (beta * (inverse(self.temperature) - inverse(25.0))).exp();
        REFERENCE * to_ground / (to_ground + resistance)
    }

    /// Voltage of the supply's divider.
    pub(super) fn divided(&self) -> f64 {
        let [upper, lower] = self.parts.divider;
        (self.supply.volts * lower / (upper + lower)).min(REFERENCE)
    }
}
