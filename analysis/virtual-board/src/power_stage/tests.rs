//! A current loop's registers, written by hand, and what the circuit makes of them.

use super::gate_log::{any_high, first_high, off_since, shortest_dead_time};
use super::*;
use crate::board::VirtualBoard;
use crate::chip::B_G431B_ESC1;
use crate::device::{FixedDevice, Motion};
use crate::motor::{Motor, Winding};

const RCC: u32 = 0x4002_1000;
const TIM1: u32 = 0x4001_2C00;
const COMP: u32 = 0x4001_0200;
const OPAMP: u32 = 0x4001_0300;
const ADC1: u32 = 0x5000_0000;
const ADC2: u32 = 0x5000_0100;
const ADC12: u32 = 0x5000_0300;
const DAC3: u32 = 0x5000_1000;
const PORTS: u32 = 0x4800_0000;

const CORE: f64 = 170e6;
const TOP: u32 = 2125;
const PERIOD: u64 = 2 * TOP as u64;
const DEAD: u32 = 85;
const MAIN_OUTPUT: u32 = 1 << 15;
const OFF: u32 = DEAD | 0b11 << 10 | 0b11 << 12 | 0b11 << 16;
const ENDED: u32 = 1 << 6;

const SUPPLY: f64 = 24.0;
const RESISTANCE: f64 = 1.0;
const INDUCTANCE: f64 = 0.5e-3;
const CONSTANT: f64 = 0.05;
/// The DAC's code of a threshold near 35 A in a phase.
const THRESHOLD: u32 = 234;
/// Volts of a current at the converters.
const VOLTS_PER_AMP: f64 = 0.003 * 64.0 / 7.0;
/// Volts at a shunt's pin without a current: 0.9/7 V, from Kirchhoff's law with 1.5, 2.2 and 22 kΩ.
const NO_CURRENT: f64 = 0.9 / 7.0;
/// Its count of a converter behind the gain of 16.
const IDLE: u16 = 2553;

/// A motor with a moment of inertia and some friction.
#[derive(Clone, Copy)]
struct Flywheel {
    inertia: f64,
    damping: f64,
    angle: f64,
    speed: f64,
    count: i32,
}

impl Flywheel {
    fn new(inertia: f64, damping: f64) -> Self {
        Self { inertia, damping, angle: 0.0, speed: 0.0, count: 0 }
    }
}

impl Device for Flywheel {
    fn sample(&mut self, _: Option<u16>, _: bool) -> i32 {
        0
    }

    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        self.speed += (torque - self.damping * self.speed) * seconds / self.inertia;
        self.angle += self.speed * seconds;
        let count = (self.angle / std::f64::consts::TAU * 4096.0).floor() as i32;
        let counts = count - std::mem::replace(&mut self.count, count);
        Motion { counts, angle: self.angle, speed: self.speed }
    }
}

struct Driver(VirtualBoard);

impl Driver {
    /// A board with this motor and device, set up as a program does, with the gates off.
    fn new(motor: Motor, device: impl Device + Send + 'static) -> Self {
        let mut driver = Self::unprepared(motor, device);
        driver.clocks();
        driver.pins();
        driver.modulator();
        driver.thresholds();
        driver.converters();
        driver
    }

    fn unprepared(motor: Motor, device: impl Device + Send + 'static) -> Self {
        let mut board = VirtualBoard::new(&B_G431B_ESC1, Box::new(device));
        board.gates = Some(Vec::new());
        board.power_stage.circuit.motor = Some(motor);
        Self(board)
    }

    fn write(&mut self, address: u32, value: u32) {
        self.0.now += 1;
        self.0.advance();
        self.0.write(address, 4, value);
        assert!(self.0.stopped.is_none(), "{}", self.0.stopped.as_ref().unwrap());
    }

    fn read(&mut self, address: u32) -> u32 {
        let value = self.0.read(address, 4);
        assert!(self.0.stopped.is_none(), "{}", self.0.stopped.as_ref().unwrap());
        value
    }

    fn set(&mut self, address: u32, bits: u32) {
        let value = self.read(address);
        self.write(address, value | bits);
    }

    /// 170 MHz from the crystal, and the units' clocks.
    fn clocks(&mut self) {
        self.set(RCC, 1 << 16);
        self.write(RCC + 0x0C, 3 | 1 << 4 | 85 << 8 | 1 << 24);
        self.set(RCC, 1 << 24);
        // In two steps: half of it first.
        self.write(RCC + 0x08, 3 | 0b1000 << 4);
        self.write(RCC + 0x08, 3);
        self.write(RCC + 0x4C, 0b111 | 1 << 13 | 1 << 18);
        self.write(RCC + 0x60, 1 | 1 << 11);
        assert_eq!(self.0.clock.core(), 170_000_000);
    }

    /// The gates, low and then TIM1's.
    fn pins(&mut self) {
        for ((port, pin), function) in B_G431B_ESC1.gates.unwrap() {
            let base = PORTS + 0x400 * *port as u32;
            let modes = self.read(base) & !(0b11 << (2 * pin));
            self.write(base, modes | 0b01 << (2 * pin));
            self.set(base + 0x20 + pin / 8 * 4, function << (4 * (pin % 8)));
            self.write(base, modes | 0b10 << (2 * pin));
        }
    }

    fn modulator(&mut self) {
        let channel = 0x78 | 0x78 << 8;
        for (offset, value) in [
            (0x44, OFF),
            (0x00, 1 << 5 | 1 << 2),
            (0x04, 0b010 << 4),
            (0x28, 0),
            (0x2C, TOP),
            (0x30, 1),
            (0x18, channel),
            (0x1C, 0x78),
            (0x34, TOP / 2),
            (0x38, TOP / 2),
            (0x3C, TOP / 2),
            (0x20, 0x555),
            (0x60, 1 << 1 | 1 << 2 | 1 << 4),
            (0x14, 1),
            (0x10, 0),
        ] {
            self.write(TIM1 + offset, value);
        }
    }

    fn thresholds(&mut self) {
        for (offset, value) in
            [(0x3C, 3 | 3 << 16), (0x08, THRESHOLD), (0x14, THRESHOLD), (0x00, 1 | 1 << 16)]
        {
            self.write(DAC3 + offset, value);
        }
        for number in [0, 1, 3] {
            self.write(COMP + 4 * number, 1 | 0b100 << 4);
        }
    }

    fn converters(&mut self) {
        for number in 0..3 {
            self.write(OPAMP + 4 * number, 1 | 0b10 << 5 | 1 << 7 | 0b01011 << 14);
        }
        self.write(ADC12 + 8, 0b11 << 16);
        for (base, slow) in [(ADC1, 5), (ADC2, 1)] {
            self.write(base + 0x08, 0);
            self.write(base + 0x08, 1 << 28);
            self.run_for(3400);
            self.set(base + 0x08, 1 << 31);
            while self.read(base + 0x08) & 1 << 31 != 0 {
                self.run_for(10);
            }
            self.set(base + 0x08, 1);
            while self.read(base) & 1 == 0 {
                self.run_for(10);
            }
            self.write(base + 0x0C, 1 << 31);
            self.write(base + 0x14, 1 << 9 | 4 << (3 * slow));
            self.write(base + 0x30, slow << 6);
            self.write(base + 0x4C, 1 << 7 | 3 << 9);
            self.set(base + 0x08, 1 << 3);
        }
        self.write(ADC1 + 0x04, ENDED);
    }

    fn start(&mut self) {
        self.set(TIM1, 1);
    }

    fn gates_on(&mut self) {
        self.write(TIM1 + 0x10, !(1 << 7));
        self.write(TIM1 + 0x44, OFF | MAIN_OUTPUT);
    }

    /// Compare values, by the parts of a period for which the high sides conduct.
    fn set_duties(&mut self, duties: [f64; 3]) {
        for (phase, duty) in duties.into_iter().enumerate() {
            let compare = (f64::from(TOP) * (1.0 - duty)).round() as u32;
            self.write(TIM1 + 0x34 + 4 * phase as u32, compare);
        }
    }

    fn run_for(&mut self, clocks: u64) {
        let end = self.0.now + clocks;
        while self.0.due() <= end {
            self.0.now = self.0.due();
            self.0.advance();
        }
        self.0.now = end;
        self.0.advance();
        assert_eq!(self.0.power_stage.shoot_through(), None);
    }

    /// To the end of the next injected conversions, which are acknowledged: the codes of phases U and V.
    fn next_currents(&mut self) -> [u16; 2] {
        while !self.0.power_stage.conversion_line() {
            self.0.now = self.0.due();
            self.0.advance();
        }
        self.write(ADC1, ENDED);
        [ADC1, ADC2].map(|base| self.read(base + 0x80) as u16)
    }

    fn periods(&mut self, periods: u64) -> [u16; 2] {
        (0..periods).fold([0; 2], |_, _| self.next_currents())
    }

    /// The slow channels: temperature and supply.
    fn slow(&mut self) -> [u16; 2] {
        for base in [ADC1, ADC2] {
            self.set(base + 0x08, 1 << 2);
        }
        self.next_currents();
        [ADC1, ADC2].map(|base| self.read(base + 0x40) as u16)
    }

    fn currents(&self) -> [f64; 3] {
        self.0.power_stage.circuit.currents()
    }

    fn gates(&self) -> &[(u64, Gates)] {
        self.0.gates.as_deref().unwrap()
    }

    fn motor(&mut self) -> &mut Motor {
        self.0.power_stage.circuit.motor.as_mut().unwrap()
    }
}

fn brushed() -> Motor {
    Motor::new(Winding::Brushed, RESISTANCE, INDUCTANCE, CONSTANT)
}

fn brushless(pole_pairs: u32) -> Motor {
    let winding = Winding::Brushless { pole_pairs, offset: 0.0 };
    Motor::new(winding, RESISTANCE, INDUCTANCE, CONSTANT)
}

/// A driver whose gates are on, without voltage.
fn driving(motor: Motor, device: impl Device + Send + 'static) -> Driver {
    let mut driver = Driver::new(motor, device);
    driver.start();
    driver.set_duties([0.0; 3]);
    driver.periods(2);
    driver.gates_on();
    // The supplies of the high sides' gates are charged.
    driver.periods(60);
    driver.set_duties([0.5; 3]);
    driver.periods(2);
    assert_eq!(driver.0.power_stage.uncharged(), None);
    driver
}

/// The drivers supply the gates of the high sides from capacitors, which only the low sides charge.
#[test]
fn a_high_side_whose_supply_is_not_charged_does_not_conduct() {
    let mut driver = Driver::new(brushed(), FixedDevice);
    driver.start();
    driver.set_duties([1.0, 0.0, 0.5]);
    driver.periods(2);
    driver.gates_on();
    driver.periods(4);
    assert!(driver.0.power_stage.uncharged().is_some());
    assert_eq!(driver.currents()[0], 0.0);
}

fn counts(amps: f64) -> f64 {
    amps * VOLTS_PER_AMP / REFERENCE * 4096.0
}

fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} in place of {expected}");
}

#[test]
fn no_gate_is_high_before_the_main_output_is_enabled() {
    let mut driver = Driver::new(brushed(), FixedDevice);
    driver.start();
    driver.periods(5);
    let now = driver.0.now;
    assert!(!any_high(driver.gates(), 0, now));
    assert_eq!(driver.0.power_stage.gates(), [Level::Low; 6]);
    driver.gates_on();
    let on = driver.0.now;
    driver.periods(1);
    let first = first_high(driver.gates(), 0).unwrap();
    assert_eq!(first, on + u64::from(DEAD));
}

#[test]
fn legs_switch_with_their_dead_time_and_never_together() {
    let mut driver = driving(brushed(), FixedDevice);
    for duty in [0.5, 0.9, 0.03, 0.01, 0.0, 1.0, 0.5] {
        driver.set_duties([duty, 1.0 - duty, 0.5]);
        driver.periods(4);
    }
    assert_eq!(shortest_dead_time(driver.gates()), Some(u64::from(DEAD)));
}

/// The sample in the middle of the low side is the mean; a dead time takes its part of the voltage by the
/// sign of the current.
#[test]
fn the_sampled_current_is_that_of_the_duties() {
    let mut driver = driving(brushed(), FixedDevice);
    let idle = driver.periods(1);
    assert_eq!(idle, [IDLE; 2]);
    for duty in [0.6, 0.35] {
        driver.set_duties([duty, 1.0 - duty, 0.5]);
        let [u, v] = driver.periods(200);
        let dead = 2.0 * f64::from(DEAD) / PERIOD as f64;
        let wanted = 2.0 * duty - 1.0;
        let current = SUPPLY * (wanted - dead * wanted.signum()) / RESISTANCE;
        let expected = counts(current);
        assert_near(f64::from(IDLE) - f64::from(u), expected, 1.0 + 0.01 * expected.abs());
        assert_near(f64::from(v) - f64::from(IDLE), expected, 1.0 + 0.01 * expected.abs());
        let mean = driver.0.power_stage.circuit.mean_torque();
        assert_near(mean, CONSTANT * current, 0.01 * mean.abs());
    }
}

/// The step response in the samples: the exponential of the winding from the update on at which the duties
/// are taken over, which is the one behind the write.
#[test]
fn a_step_of_the_duties_acts_from_the_next_update_on() {
    let mut driver = driving(brushed(), FixedDevice);
    driver.set_duties([0.7, 0.3, 0.5]);
    let lag = INDUCTANCE / RESISTANCE;
    let dead = 2.0 * f64::from(DEAD) / PERIOD as f64;
    let settled = SUPPLY * (0.4 - dead) / RESISTANCE;
    for instant in 0..20 {
        let [u, v] = driver.next_currents();
        let seconds = f64::from(instant) * PERIOD as f64 / CORE;
        let expected = counts(settled * (1.0 - (-seconds / lag).exp()));
        let sampled = 0.5 * (f64::from(v) - f64::from(u));
        assert_near(sampled, expected, 1.0 + 0.01 * expected);
    }
}

/// The clock at which the threshold is reached, and the filter's eight clocks behind it; long before the
/// period ends.
#[test]
fn a_short_breaks_the_gates_within_the_period() {
    let mut driver = driving(brushed(), FixedDevice);
    driver.set_duties([0.6, 0.4, 0.5]);
    driver.periods(20);
    // In the short, at the beginning of a period in which nothing else happens.
    driver.motor().short = Some((0.01, 0.5e-6));
    let before = driver.0.now;
    driver.run_for(PERIOD);
    let off = off_since(driver.gates()).expect("no gate is high any more");
    assert!(off - before < PERIOD, "{} clocks", off - before);
    println!("gates off {} clocks behind the short", off - before);
    assert_eq!(driver.0.power_stage.gates(), [Level::Low; 6]);
    assert_eq!(driver.read(TIM1 + 0x44) & MAIN_OUTPUT, 0);
    assert_eq!(driver.read(TIM1 + 0x10) & 1 << 7, 1 << 7);
    // It stays so, although the current is gone.
    driver.motor().short = None;
    driver.periods(10);
    assert_eq!(off_since(driver.gates()), Some(off));
    assert_eq!(driver.currents(), [0.0; 3]);
    driver.gates_on();
    driver.periods(1);
    assert_eq!(off_since(driver.gates()), None);
}

/// With the low sides on, so that the shunt sees it: the current is at the threshold at the clock of the
/// break, but for the filter.
#[test]
fn a_break_comes_at_the_clock_at_which_the_current_reaches_the_threshold() {
    let mut driver = driving(brushed(), FixedDevice);
    let threshold = (f64::from(THRESHOLD) / 4096.0 * REFERENCE - NO_CURRENT) * 16.0 / VOLTS_PER_AMP;
    // 1 for U, nearly 0 for V: its low side conducts but for some clocks.
    driver.motor().resistance = 0.1;
    driver.set_duties([1.0, 0.0, 0.5]);
    driver.periods(1);
    let mut before = driver.currents()[0];
    while driver.0.power_stage.timer.is_on() {
        before = driver.currents()[0];
        driver.run_for(1);
    }
    let slope = SUPPLY / INDUCTANCE / CORE;
    assert_near(before, threshold + 8.0 * slope, 2.0 * slope);
}

#[test]
fn a_current_below_the_threshold_does_not_break() {
    let mut driver = driving(brushed(), FixedDevice);
    driver.motor().resistance = 0.66;
    // The low side of U conducts for long enough to charge the supply of its high side.
    driver.set_duties([0.95, 0.0, 0.5]);
    driver.periods(400);
    assert!(driver.currents()[0] > 33.0);
    assert!(driver.0.power_stage.timer.is_on());
    driver.motor().resistance = 0.62;
    driver.periods(400);
    assert!(!driver.0.power_stage.timer.is_on());
}

#[test]
fn supply_and_temperature_are_sampled() {
    let mut driver = driving(brushed(), FixedDevice);
    // 1.055 V at 25 degrees (UM2516's motor control software has the same).
    assert_eq!(driver.slow(), [1310, (24.0 * 18.0 / 187.0 / 3.3 * 4096.0_f64).round() as u16]);
    driver.0.power_stage.circuit.temperature = 90.0;
    driver.0.power_stage.circuit.supply = Supply::stiff(30.0);
    let [hot, high] = driver.slow();
    assert!(hot > 3100 && high > 3580, "{hot} {high}");
}

#[test]
fn an_amplifier_with_an_error_and_an_open_wire_are_seen() {
    let mut driver = driving(brushed(), FixedDevice);
    driver.0.power_stage.circuit.amplifier_errors[1] = 0.2;
    assert_eq!(driver.periods(2), [IDLE, IDLE + 249]);
    driver.motor().open[0] = true;
    driver.set_duties([0.8, 0.2, 0.5]);
    assert_eq!(driver.periods(50), [IDLE, IDLE + 249]);
}

#[test]
fn a_motor_turns_and_its_back_emf_limits_the_current() {
    let mut driver = driving(brushed(), Flywheel::new(2e-6, 0.0));
    driver.set_duties([0.6, 0.4, 0.5]);
    driver.periods(4000);
    let [current, ..] = driver.currents();
    assert!(current.abs() < 0.3, "{current}");
    // Without load its speed is limited by the voltage; the loss is the dead time's.
    let count = driver.0.encoder.value(0, 1);
    driver.periods(1);
    assert_eq!(count, 0, "the encoder's pins are not the timer's in this test");
    let speed = driver.0.power_stage.circuit.mean_torque();
    assert_near(speed, 0.0, 0.01);
}

/// A supply that takes nothing back rises while the motor is braked through the bridge.
#[test]
fn braking_lifts_a_supply_that_takes_nothing_back() {
    let mut driver = driving(brushed(), Flywheel::new(5e-5, 0.0));
    driver.0.power_stage.circuit.supply = Supply::that_stores(SUPPLY, 5e-4);
    driver.set_duties([0.75, 0.25, 0.5]);
    driver.periods(8000);
    assert_eq!(driver.0.power_stage.circuit.supply.volts, SUPPLY);
    driver.set_duties([0.6, 0.4, 0.5]);
    driver.periods(600);
    let volts = driver.0.power_stage.circuit.supply.volts;
    assert!(volts > SUPPLY + 1.0, "{volts}");
}

/// A current vector that turns slowly takes the rotor with it: as many electrical turns as the motor has
/// pole pairs for one of the shaft, and the other way with two wires swapped.
#[test]
fn a_turning_current_vector_takes_the_rotor_with_it() {
    for (pole_pairs, wires, sign) in
        [(7, [0, 1, 2], 1.0), (2, [0, 1, 2], 1.0), (7, [1, 0, 2], -1.0)]
    {
        let mut motor = brushless(pole_pairs);
        motor.wires = wires;
        let mut driver = driving(motor, Flywheel::new(1e-6, 1e-3));
        let turned = |driver: &mut Driver, from: i32, to: i32| {
            for step in from..=to {
                let angle = f64::from(step) * 2.5e-4 * std::f64::consts::TAU;
                let duties = [0.0, 1.0, 2.0]
                    .map(|phase| 0.5 + 0.2 * (angle - phase * std::f64::consts::TAU / 3.0).cos());
                driver.set_duties(duties);
                driver.next_currents();
            }
            driver.0.power_stage.circuit.motion.angle
        };
        let begin = turned(&mut driver, -2000, 0);
        let end = turned(&mut driver, 1, 8000);
        let expected = sign * 2.0 * std::f64::consts::TAU / f64::from(pole_pairs);
        assert_near(end - begin, expected, 0.1 * expected.abs());
    }
}

#[test]
fn a_shaft_that_is_held_does_not_turn() {
    let mut driver = driving(brushed(), Flywheel::new(1e-6, 0.0));
    driver.0.power_stage.circuit.is_blocked = true;
    driver.set_duties([0.6, 0.4, 0.5]);
    driver.periods(300);
    assert_eq!(driver.0.power_stage.circuit.motion.angle, 0.0);
    assert!(driver.currents()[0] > 3.0, "no back-EMF");
}

#[test]
fn a_reset_lets_the_gates_float_at_once_and_the_current_ends() {
    let mut driver = driving(brushed(), FixedDevice);
    driver.set_duties([0.7, 0.3, 0.5]);
    driver.periods(50);
    assert!(driver.currents()[0] > 2.0);
    driver.0.reset(crate::peripheral::clock::Cause::Watchdog);
    let reset = driver.0.now;
    assert_eq!(driver.0.power_stage.gates(), [Level::Floating; 6]);
    assert_eq!(off_since(driver.gates()), Some(reset));
    driver.run_for(30_000);
    assert_eq!(driver.currents(), [0.0; 3]);
}

#[test]
fn the_clock_s_failure_is_a_break() {
    let mut driver = driving(brushed(), FixedDevice);
    driver.0.break_power_stage();
    assert_eq!(driver.0.power_stage.gates(), [Level::Low; 6]);
    assert_eq!(driver.read(TIM1 + 0x10) & 1 << 13, 1 << 13);
}

#[test]
fn an_interrupt_that_does_not_come_leaves_the_duties_as_they_were() {
    let mut driver = driving(brushed(), FixedDevice);
    driver.set_duties([0.6, 0.4, 0.5]);
    driver.periods(50);
    driver.run_for(20 * PERIOD);
    assert!(driver.0.power_stage.conversion_line());
    assert!(driver.0.power_stage.timer.is_on());
    let compared = driver.0.power_stage.timer.compared();
    assert_eq!(compared[..2], [850, 1275]);
}

#[test]
fn two_switches_of_a_leg_are_never_on_unnoticed() {
    let mut driver = Driver::unprepared(brushed(), FixedDevice);
    driver.clocks();
    for (port, pin) in [(0, 8), (2, 13)] {
        let base = PORTS + 0x400 * port;
        let modes = driver.read(base) & !(0b11 << (2 * pin));
        driver.write(base, modes | 0b01 << (2 * pin));
        driver.write(base + 0x18, 1 << pin);
    }
    assert_eq!(driver.0.power_stage.shoot_through(), Some((driver.0.now, 0)));
}

#[test]
fn a_channel_that_nothing_drives_is_named() {
    let mut driver = driving(brushed(), FixedDevice);
    driver.write(OPAMP, 0);
    driver.run_for(PERIOD);
    let stopped = driver.0.stopped.unwrap().to_string();
    assert!(stopped.contains("ADC1") && stopped.contains("nothing drives"), "{stopped}");
}
