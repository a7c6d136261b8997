//! A servo, the current loop of a board's bridge, a brushed motor and a device in a hand, in closed loop.
//!
//! Motor and device are one system of linear differential equations, whose exact response takes them from one
//! instant of the current loop to the next. The voltage in between is the mean of what the bridge gives: the
//! ripple of the modulation, which is zero at the instants of the samples, is not in it, nor is dead time, so
//! that the design has none either.

use std::f64::consts::TAU;

use analysis::worst_hand::HandImpedance;
use haptic_servo::current::{
    B_G431B_ESC1, CurrentController, CurrentLoop, Drive, Duties, PowerFault, PowerStage, Sample,
};
use haptic_servo::encoder::RawCount;
use haptic_servo::scene::Device;
use haptic_servo::servo::Transducers;
use nalgebra::{DMatrix, DVector};

/// The power stage of all of these boards.
pub const STAGE: PowerStage = PowerStage { dead_time: 0.0, ..B_G431B_ESC1 };

/// Count of a current sensor without a current, and the supply in V.
const OFFSET: f64 = 2553.0;
const BUS: f64 = 24.0;

/// From an angle in rad at a count to the code that the current loop takes over at that count.
pub type Codes = Box<dyn FnMut(f64) -> i16>;
/// From an angle in rad at a count to the torque in N m of a motor without steps, at that count.
pub type Torques = Box<dyn FnMut(f64) -> f64>;

/// Numbers of a device with its motor, and of its servo.
#[derive(Clone, Copy, Debug)]
pub struct Machine {
    pub device: Device,
    pub drive: Drive,
    pub transducers: Transducers,
    /// Period of the servo in s.
    pub period: f64,
}

impl Machine {
    pub fn current_loop(&self) -> CurrentLoop {
        CurrentLoop::design(&self.drive, &STAGE, &self.transducers, self.period).unwrap()
    }

    /// The count of an angle in rad: the nearest, as that of an encoder whose zero is half a count aside.
    pub fn count(&self, angle: f64) -> i32 {
        (angle / TAU * self.transducers.counts_per_turn).round() as i32
    }
}

/// What an instant showed.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    /// Torque of the motor in N m.
    pub torque: f64,
    /// The certified one, of the positions as they are and of codes without steps.
    pub certified: f64,
}

pub struct Rig {
    machine: Machine,
    design: CurrentLoop,
    controller: CurrentController,
    codes: Codes,
    exact: Torques,
    code: i16,
    /// Torque in N m that the positions as they are ask for.
    wanted: f64,
    /// That of the certificate at this instant, and at the next one.
    certified: [f64; 2],
    /// What of a step is left at the next instant.
    left: f64,
    instant: usize,
    loaded: Duties,
    /// Over an instant: angles and speeds, the current, the voltage, and the friction.
    over: DMatrix<f64>,
    state: DVector<f64>,
    next: DVector<f64>,
    /// Coulomb friction of the device in N m.
    pub friction: f64,
}

impl Rig {
    /// A bridge whose gates have just been switched on, at rest.
    pub fn new(machine: &Machine, hand: &HandImpedance, codes: Codes, exact: Torques) -> Self {
        let design = machine.current_loop();
        let mut controller = CurrentController::new(&design);
        for _ in 0..300 {
            controller.measure_offset(&sample(machine, 0.0, 0.0));
        }
        controller.start().unwrap();
        let response = design.response();
        let rates = rates(machine, hand);
        let states = rates.nrows();
        Self {
            machine: *machine,
            design,
            controller,
            codes,
            exact,
            code: 0,
            wanted: 0.0,
            certified: [0.0; 2],
            left: (-response.delay / response.lag).exp(),
            instant: 0,
            loaded: design.no_voltage(),
            over: (rates * response.delay).exp(),
            state: DVector::zeros(states),
            next: DVector::zeros(states),
            friction: 0.0,
        }
    }

    /// The device moves at this speed in rad/s from now on, with what of the hand is on it.
    pub fn push(&mut self, speed: f64) {
        self.state[1] = speed;
    }

    /// An instant, and the time until the next one.
    pub fn step(&mut self) -> Result<Instant, PowerFault> {
        let (angle, current) = (self.state[0], self.state[self.current()]);
        if self.instant.is_multiple_of(self.design.updates().into()) {
            self.code = (self.codes)(angle);
            self.wanted = (self.exact)(angle);
        }
        self.instant += 1;
        let shown = Instant {
            torque: current * self.design.torque_per_amp(),
            certified: self.certified[0],
        };
        follow(&mut self.certified, self.left, self.wanted);
        let [u, v, _] = self.loaded.0.map(f64::from);
        self.loaded = self.controller.step(&sample(&self.machine, angle, current), self.code)?;
        self.pass(BUS * (u - v) / f64::from(self.design.timer_counts()));
        Ok(shown)
    }

    /// The time until the next instant. Friction stops the device if it can: over this time it is the torque that
    /// is nearest to that.
    fn pass(&mut self, voltage: f64) {
        let constant = self.current() + 1;
        self.state[constant] = voltage;
        self.next.gemv(1.0, &self.over, &self.state, 0.0);
        if self.friction > 0.0 {
            let stops = -self.next[1] / self.over[(1, constant + 1)];
            let friction = stops.clamp(-self.friction, self.friction);
            self.next.axpy(friction, &self.over.column(constant + 1), 1.0);
        }
        std::mem::swap(&mut self.state, &mut self.next);
    }

    /// Instants of so many seconds.
    pub fn run(&mut self, time: f64) -> Result<Vec<Instant>, PowerFault> {
        let instants = (time / self.design.response().delay).round() as usize;
        (0..instants).map(|_| self.step()).collect()
    }

    fn current(&self) -> usize {
        self.state.len() - 3
    }
}

/// One lag behind a delay of an instant, at the instants: theory, section 15.1.
fn follow([now, next]: &mut [f64; 2], left: f64, wanted: f64) {
    let after = wanted + (*next - wanted) * left;
    (*now, *next) = (*next, after);
}

fn sample(machine: &Machine, angle: f64, current: f64) -> Sample {
    let count = |value: f64| value.round().clamp(0.0, 4095.0) as u16;
    let counts = current / STAGE.amps_per_count;
    Sample {
        currents: [count(OFFSET - counts), count(OFFSET + counts)],
        bus: count(BUS / STAGE.volts_per_count),
        temperature: STAGE.thermistor.count(30.0),
        position: RawCount::from(machine.count(angle)),
    }
}

/// Rates of the device, of what of a hand is linked to it, of the current, and of the constants: the voltage, and
/// a torque of friction.
fn rates(machine: &Machine, hand: &HandImpedance) -> DMatrix<f64> {
    let held = hand.link.is_none();
    let on_device = |value: f64| if held { value } else { 0.0 };
    let bodies = 1 + usize::from(!held) + hand.absorbers.len();
    let (current, voltage, rubs) = (2 * bodies, 2 * bodies + 1, 2 * bodies + 2);
    let mut rates = DMatrix::zeros(rubs + 1, rubs + 1);
    for body in 0..bodies {
        rates[(2 * body, 2 * body + 1)] = 1.0;
    }
    let inertia = machine.device.inertia + on_device(hand.inertia);
    rates[(1, 0)] = -on_device(hand.stiffness) / inertia;
    rates[(1, 1)] = -(machine.device.damping + on_device(hand.damping)) / inertia;
    let mut link = |body: usize, mass: f64, stiffness: f64, damping: f64| {
        for (column, value) in [(0, stiffness), (1, damping)] {
            for (row, inertia, sign) in [(1, inertia, 1.0), (2 * body + 1, mass, -1.0)] {
                rates[(row, column)] -= sign * value / inertia;
                rates[(row, 2 * body + column)] += sign * value / inertia;
            }
        }
    };
    let mut body = 1;
    if let Some(compliance) = hand.link {
        link(body, hand.inertia, compliance.stiffness, compliance.damping);
        body += 1;
    }
    for absorber in &hand.absorbers {
        link(body, absorber.inertia, absorber.stiffness, 0.0);
        body += 1;
    }
    if !held {
        rates[(3, 2)] -= hand.stiffness / hand.inertia;
        rates[(3, 3)] -= hand.damping / hand.inertia;
    }
    let motor = machine.drive.motor;
    rates[(1, current)] = motor.torque_constant / inertia;
    rates[(1, rubs)] = 1.0 / inertia;
    rates[(current, current)] = -motor.resistance / motor.inductance;
    rates[(current, 1)] = -motor.back_emf() / motor.inductance;
    rates[(current, voltage)] = 1.0 / motor.inductance;
    rates
}
