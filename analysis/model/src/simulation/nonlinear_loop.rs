//! The sampled loop with its non-linear elements: limits, wall face, quantisation, friction.

use std::collections::VecDeque;

use haptic_servo::scene::Timing;
use haptic_servo::torque::LimitReason;
use nalgebra::DVector;

use super::discrete_plant::DiscretePlant;
use super::disturbed_plant::{DisturbedPlant, DisturbedState, TickInputs};
use super::error::SimulationError;
use super::experiment::{Experiment, Integration};
use super::hosted::Hosted;
use super::kernel::{DEAD, LOOK};
use super::plant::{POSITION, VELOCITY};
use super::reading::Reading;
use super::tick_status::TickStatus;
use super::torque_signal::TorqueSignal;
use super::trajectory::{Columns, HostColumns};
use super::unquantized_servo::UnquantizedServo;
use crate::missed::Ticks;

/// A loop in motion.
#[derive(Debug)]
pub struct NonlinearLoop {
    servo: UnquantizedServo,
    machine: Machine,
    reading: Reading,
    missed: Ticks,
    /// Whether a tick whose reading fails is left out.
    leaves_out: bool,
    /// The sample of the fault of the readings.
    fault: Option<usize>,
    torque: f64,
    host: Option<Hosted>,
    k: usize,
}

/// The plant with the torques that have not acted on it yet.
#[derive(Debug)]
pub struct Machine {
    body: Body,
    measured: usize,
    whole: usize,
    /// Motor torques in N m of the ticks before, the newest first.
    torques: VecDeque<f64>,
}

/// The plant, with friction and cogging or without.
#[derive(Debug)]
enum Body {
    Smooth(Box<Smooth>),
    Disturbed(Box<Disturbed>),
}

/// A plant with friction and cogging.
#[derive(Debug)]
struct Disturbed {
    plant: DisturbedPlant,
    period: f64,
    state: DisturbedState,
}

/// A plant with one matrix for all ticks.
#[derive(Debug)]
struct Smooth {
    tick: DiscretePlant,
    period: f64,
    state: DVector<f64>,
    next: DVector<f64>,
}

impl NonlinearLoop {
    /// Sets an experiment up.
    ///
    /// # Errors
    /// If the scene has no law that can run.
    pub fn new(experiment: &Experiment, integration: Integration) -> Result<Self, SimulationError> {
        let Timing { period, worst_period } = experiment.scene.timing;
        let encoder = experiment.scene.latency.encoder;
        Ok(Self {
            servo: UnquantizedServo::new(&experiment.scene)?,
            machine: Machine::new(experiment, integration)?,
            reading: Reading::new(encoder, experiment.encoder_step).failing(experiment.dropped),
            leaves_out: encoder.leaves_out(period, worst_period),
            fault: experiment.fault(),
            missed: experiment.missed.ticks(),
            torque: 0.0,
            host: Hosted::new(experiment)?,
            k: 0,
        })
    }

    /// Whether a host adds torques.
    pub fn has_host(&self) -> bool {
        self.host.is_some()
    }

    /// Computes the next samples, and the status of the servo at each; with a host, its columns, too.
    pub fn fill(
        &mut self,
        hand_torque: &TorqueSignal,
        columns: Columns<'_>,
        limit: &mut [TickStatus],
        mut hosts: Option<HostColumns<'_>>,
    ) {
        let Columns { position, velocity, torque } = columns;
        let samples = position.iter_mut().zip(velocity).zip(torque).zip(limit).enumerate();
        for (sample, (((position, velocity), torque), status)) in samples {
            if self.fault == Some(self.k) {
                // The trajectory ends here.
                *position = f64::NAN;
                continue;
            }
            let state = self.machine.state();
            (*position, *velocity) = (state[POSITION], state[VELOCITY]);
            let fails = self.reading.fails();
            let (angle, saturated) = match fails {
                true => self.reading.shown(self.reading.last()),
                false => self.reading.of(self.machine.measured()),
            };
            *status = self.run_servo(angle, saturated, fails && self.leaves_out);
            *torque = self.torque;
            let mut added = 0.0;
            if let (Some(host), Some(columns)) = (&mut self.host, &mut hosts) {
                let given = host.tick(self.k, angle);
                added = given.command;
                (columns.torque[sample], columns.energy[sample]) = (given.torque, given.energy);
                if *status == TickStatus::UNLIMITED {
                    *status = TickStatus::Ran(given.limit);
                }
            }
            self.machine.tick(self.k, hand_torque, added - self.torque);
            self.k += 1;
        }
    }

    /// The servo's part in a tick that starts with a reading of `angle` rad, and may be left out.
    fn run_servo(&mut self, angle: f64, saturated: LimitReason, left_out: bool) -> TickStatus {
        if self.missed.next().unwrap_or(false) || left_out {
            return TickStatus::Missed;
        }
        let (torque, limit) = self.servo.tick(angle, saturated);
        self.torque = torque;
        TickStatus::Ran(limit)
    }
}

impl Machine {
    /// The plant of an experiment at its start.
    ///
    /// # Errors
    /// Where the machine is too fast for its motion over a period to be computed.
    pub fn new(experiment: &Experiment, integration: Integration) -> Result<Self, SimulationError> {
        let tick = experiment.tick(integration)?;
        let (plant, discretization) =
            (&experiment.machine(), experiment.discretization(integration));
        let omega = experiment.hand_torque.omega();
        let state = plant.state_at(experiment.start.position, experiment.start.velocity);
        let disturbance = experiment.disturbance();
        let period = discretization.period;
        let body = if !disturbance.is_none() {
            let plant = DisturbedPlant::new(plant, disturbance, &discretization, omega);
            let state = plant.at(&state);
            Body::Disturbed(Box::new(Disturbed { plant, period, state }))
        } else {
            let next = state.clone();
            Body::Smooth(Box::new(Smooth { tick, period, state, next }))
        };
        let whole = discretization.whole;
        let torques = VecDeque::from(vec![0.0; whole + 1]);
        Ok(Self { body, measured: plant.measured(), whole, torques })
    }

    /// Its states.
    pub fn state(&self) -> &DVector<f64> {
        match &self.body {
            Body::Smooth(smooth) => &smooth.state,
            Body::Disturbed(disturbed) => disturbed.state.states(),
        }
    }

    /// The angle in rad that the servo reads.
    pub fn measured(&self) -> f64 {
        self.state()[self.measured]
    }

    /// One tick with the motor torque in N m of its sample.
    pub fn tick(&mut self, k: usize, hand_torque: &TorqueSignal, torque: f64) {
        self.torques.push_front(torque);
        let torques = [self.whole + 1, self.whole].map(|age| self.torques[age]);
        self.torques.pop_back();
        match &mut self.body {
            Body::Smooth(smooth) => smooth.tick(k, hand_torque, torques),
            Body::Disturbed(disturbed) => disturbed.tick(k, hand_torque, torques),
        }
    }
}

impl Disturbed {
    fn tick(&mut self, k: usize, hand_torque: &TorqueSignal, motor: [f64; 2]) {
        let sine = hand_torque.sine(k, self.period);
        let inputs = TickInputs { hand: hand_torque.held(k), sine, motor };
        self.plant.tick(&mut self.state, &inputs, |_| ());
    }
}

impl Smooth {
    fn tick(&mut self, k: usize, hand_torque: &TorqueSignal, [before, after]: [f64; 2]) {
        let Self { tick, state, next, period } = self;
        next.gemv(1.0, &tick.transition, state, 0.0);
        next.axpy(after, &tick.motor, 1.0);
        next.axpy(before, &tick.previous, 1.0);
        match hand_torque {
            TorqueSignal::Free => {}
            TorqueSignal::Held(_) => next.axpy(hand_torque.held(k), &tick.hand, 1.0),
            TorqueSignal::Sine { .. } => {
                let [s, c] = hand_torque.sine(k, *period);
                next.axpy(s, &tick.sine[0], 1.0);
                next.axpy(c, &tick.sine[1], 1.0);
            }
        }
        std::mem::swap(state, next);
        if k.is_multiple_of(LOOK) && state.iter().all(|state| state.abs() < DEAD) {
            state.fill(0.0);
        }
    }
}
