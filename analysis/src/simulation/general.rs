//! The loop with everything in it that is not linear.

use nalgebra::DVector;

use super::drive::Drive;
use super::friction::Rubbing;
use super::kernel::{DEAD, LOOK};
use super::missed::Missed;
use super::plant::{POSITION, VELOCITY};
use super::rendering::Rendering;
use super::tick::Tick;
use super::{Columns, Experiment, SimulationError, Stride};

/// A loop in motion.
#[derive(Debug)]
pub struct General {
    rendering: Rendering,
    machine: Machine,
    encoder_step: Option<f64>,
    missed: Box<dyn Ticks>,
    torque: f64,
    k: usize,
}

/// Whether each tick is missed.
trait Ticks: Iterator<Item = bool> + std::fmt::Debug {}
impl<T: Iterator<Item = bool> + std::fmt::Debug> Ticks for T {}

/// The plant, with dry friction or without.
#[derive(Debug)]
enum Machine {
    Smooth(Box<Smooth>),
    Rubbing(Box<Rubbing>),
}

/// A plant whose ticks are all one matrix.
#[derive(Debug)]
struct Smooth {
    tick: Tick,
    period: f64,
    state: DVector<f64>,
    next: DVector<f64>,
}

impl General {
    /// Sets an experiment up.
    ///
    /// # Errors
    /// Where the scene has no law that could run.
    pub fn new(experiment: &Experiment, stride: Stride) -> Result<Self, SimulationError> {
        Ok(Self {
            rendering: Rendering::new(&experiment.scene)?,
            machine: Machine::new(experiment, stride),
            encoder_step: experiment.encoder_step,
            missed: ticks(experiment.missed),
            torque: 0.0,
            k: 0,
        })
    }

    /// The next samples.
    pub fn fill(&mut self, drive: &Drive, columns: Columns<'_>) {
        let Columns { position, velocity, torque } = columns;
        let samples = position.iter_mut().zip(velocity).zip(torque);
        for ((position, velocity), torque) in samples {
            let state = self.machine.state();
            (*position, *velocity) = (state[POSITION], state[VELOCITY]);
            let before = self.torque;
            if !self.missed.next().unwrap_or(false) {
                let angle = match self.encoder_step {
                    Some(step) => (*position / step).floor() * step,
                    None => *position,
                };
                self.torque = self.rendering.tick(angle);
            }
            *torque = self.torque;
            self.machine.tick(self.k, drive, [-before, -self.torque]);
            self.k += 1;
        }
    }
}

fn ticks(missed: Missed) -> Box<dyn Ticks> {
    Box::new(missed.ticks())
}

impl Machine {
    fn new(experiment: &Experiment, stride: Stride) -> Self {
        let (plant, stepping) = (&experiment.plant, experiment.stepping(stride));
        let omega = experiment.drive.omega();
        let state = plant.moving(experiment.start.position, experiment.start.velocity);
        if experiment.friction > 0.0 {
            let rubbing = Rubbing::new(plant, experiment.friction, &stepping, omega, &state);
            return Self::Rubbing(Box::new(rubbing));
        }
        let tick = Tick::new(plant, &stepping, omega);
        let next = state.clone();
        Self::Smooth(Box::new(Smooth { tick, period: stepping.period, state, next }))
    }

    fn state(&self) -> &DVector<f64> {
        match self {
            Self::Smooth(smooth) => &smooth.state,
            Self::Rubbing(rubbing) => rubbing.state(),
        }
    }

    fn tick(&mut self, k: usize, drive: &Drive, torques: [f64; 2]) {
        match self {
            Self::Smooth(smooth) => smooth.tick(k, drive, torques),
            Self::Rubbing(rubbing) => rubbing.tick(k, drive, torques),
        }
    }
}

impl Smooth {
    fn tick(&mut self, k: usize, drive: &Drive, [before, after]: [f64; 2]) {
        let Self { tick, state, next, period } = self;
        next.gemv(1.0, &tick.transition, state, 0.0);
        next.axpy(after, &tick.motor, 1.0);
        next.axpy(before, &tick.previous, 1.0);
        match drive {
            Drive::Free => {}
            Drive::Held(_) => next.axpy(drive.held(k), &tick.hand, 1.0),
            Drive::Sine { .. } => {
                let [s, c] = drive.sine(k, *period);
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
