//! The loop with everything in it that is not linear.

use firmware::torque::LimitReason;
use nalgebra::DVector;

use super::drive::Drive;
use super::error::SimulationError;
use super::experiment::{Experiment, Stride};
use super::friction::Rubbing;
use super::kernel::{DEAD, LOOK};
use super::plant::{POSITION, VELOCITY};
use super::rendering::Rendering;
use super::served::Served;
use super::tick::Tick;
use super::trajectory::Columns;
use crate::missed::Missed;

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
pub(crate) enum Machine {
    /// Without.
    Smooth(Box<Smooth>),
    /// With.
    Rubbing(Box<Rubbing>),
}

/// A plant whose ticks are all one matrix.
#[derive(Debug)]
pub(crate) struct Smooth {
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

    /// The next samples, and what the servo did at each.
    pub fn fill(&mut self, drive: &Drive, columns: Columns<'_>, limit: &mut [Served]) {
        let Columns { position, velocity, torque } = columns;
        let samples = position.iter_mut().zip(velocity).zip(torque).zip(limit);
        for (((position, velocity), torque), served) in samples {
            let state = self.machine.state();
            (*position, *velocity) = (state[POSITION], state[VELOCITY]);
            let before = self.torque;
            *served = self.serve(*position);
            *torque = self.torque;
            self.machine.tick(self.k, drive, [-before, -self.torque]);
            self.k += 1;
        }
    }

    /// The servo's part in a tick that starts with the device at `position` rad.
    fn serve(&mut self, position: f64) -> Served {
        if self.missed.next().unwrap_or(false) {
            return Served::Missed;
        }
        let (angle, standing_still) = match self.encoder_step {
            Some(step) => read(position, step),
            None => (position, LimitReason::None),
        };
        let (torque, limit) = self.rendering.tick(angle, standing_still);
        self.torque = torque;
        Served::Ran(limit)
    }
}

/// The angle in rad that an encoder with this step shows, and whether its count was too large for
/// the servo's 32 bits, where the angle stands still.
fn read(position: f64, step: f64) -> (f64, LimitReason) {
    let count = (position / step).floor();
    let nearest = count.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
    let reason = if nearest == count { LimitReason::None } else { LimitReason::Angle };
    (nearest * step, reason)
}

fn ticks(missed: Missed) -> Box<dyn Ticks> {
    Box::new(missed.ticks())
}

impl Machine {
    /// The plant of an experiment at its start.
    pub(crate) fn new(experiment: &Experiment, stride: Stride) -> Self {
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

    /// Its states.
    pub(crate) fn state(&self) -> &DVector<f64> {
        match self {
            Self::Smooth(smooth) => &smooth.state,
            Self::Rubbing(rubbing) => rubbing.state(),
        }
    }

    /// One tick with the motor torques before and after the latency, in N m.
    pub(crate) fn tick(&mut self, k: usize, drive: &Drive, torques: [f64; 2]) {
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
