//! The set-up of a simulation: scene, plant, inputs, and the integration over a tick.

use std::path::Path;

use haptic_servo::host::{HostTorque, Sampling};
use haptic_servo::scene::Scene;

use super::discrete_plant::{DiscretePlant, Discretization};
use super::error::SimulationError;
use super::method::Method;
use super::plant::Plant;
use super::torque_signal::TorqueSignal;
use crate::beside_host;
use crate::device::Motion;
use crate::disturbance::{Cogging, Disturbance};
use crate::file::SceneFile;
use crate::missed::Missed;

/// Everything that determines the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The scene; its device is where the canceller's damping comes from.
    pub scene: Scene,
    /// The machine, with the hand that holds it; the lags at its two ends are the scene's.
    pub plant: Plant,
    /// How the device moves at sample 0.
    pub start: Motion,
    /// Number of samples.
    pub samples: usize,
    /// Torque of the hand.
    pub hand_torque: TorqueSignal,
    /// Angle of an encoder count in rad, if the angle is floored to whole counts.
    pub encoder_step: Option<f64>,
    /// Coulomb friction of the motor's mass in N m.
    pub friction: f64,
    /// Cogging of the motor.
    pub cogging: Cogging,
    /// Time in s from a sample to its torque besides the scene's delay, less than the period.
    pub latency: f64,
    /// Ticks in which the servo does not run.
    pub missed: Missed,
    /// Readings of the encoder that fail.
    pub dropped: Missed,
    /// A host that adds torques.
    pub host: Option<HostSignal>,
}

/// A host with its budget, and the torques in N m that it wants, one a sample; none after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct HostSignal {
    /// What it may do.
    pub budget: HostTorque,
    /// How the servo reads positions and gives torques.
    pub sampling: Sampling,
    /// What it wants.
    pub wanted: Vec<f64>,
}

impl Experiment {
    /// The experiment of a scene file; `folder` is the folder of its torque file.
    ///
    /// # Errors
    /// Where the file has no `[simulation]`, or its torque file cannot be read.
    pub fn of(file: &SceneFile, folder: &Path) -> Result<Self, SimulationError> {
        let Some(simulation) = &file.simulation else {
            return Err(SimulationError::NoSimulation { scene: file.name.clone() });
        };
        Ok(Self {
            samples: simulation.samples,
            start: Motion { position: simulation.position, velocity: simulation.velocity },
            hand_torque: TorqueSignal::load(
                &simulation.torque,
                folder,
                simulation.samples,
                file.scene.timing.period,
            )?,
            friction: simulation.friction,
            latency: simulation.latency,
            missed: simulation.missed,
            dropped: simulation.dropped,
            encoder_step: file.encoder_step,
            host: file.host.map(|budget| HostSignal {
                budget,
                sampling: beside_host::sampling(file),
                wanted: simulation.host.clone().unwrap_or_default(),
            }),
            ..Self::at_rest(file)
        })
    }

    /// The scene and the machine of a file, at rest, undisturbed except for latency.
    pub fn at_rest(file: &SceneFile) -> Self {
        Self {
            plant: Plant::of(&file.chain).with_hand(file.hand.unwrap_or_default()),
            cogging: file.cogging.unwrap_or_default(),
            latency: file.simulation.as_ref().map_or(0.0, |simulation| simulation.latency),
            ..Self::still(&file.scene)
        }
    }

    /// A scene on its rigid device without a hand, at rest and undisturbed.
    pub fn still(scene: &Scene) -> Self {
        Self {
            scene: *scene,
            plant: Plant::rigid(scene.device),
            start: Motion::default(),
            samples: 0,
            hand_torque: TorqueSignal::Free,
            encoder_step: None,
            friction: 0.0,
            cogging: Cogging::default(),
            latency: 0.0,
            missed: Missed::None,
            dropped: Missed::None,
            host: None,
        }
    }

    /// Whether `computed` samples are all that there should be.
    ///
    /// # Errors
    /// Where the motion has left the range of numbers before, or the readings of the encoder were a fault.
    pub fn completed(&self, computed: usize) -> Result<(), SimulationError> {
        if computed >= self.samples {
            return Ok(());
        }
        let time = computed as f64 * self.scene.timing.period;
        if self.fault() == Some(computed) {
            let allowed = self.scene.latency.encoder.dropped;
            return Err(SimulationError::Readings { sample: computed, time, allowed });
        }
        Err(SimulationError::Overflow { sample: computed, time })
    }

    /// Friction and cogging of the motor.
    pub fn disturbance(&self) -> Disturbance {
        Disturbance { friction: self.friction, cogging: self.cogging }
    }

    /// Whether the loop is linear and the same in every tick.
    pub(super) fn is_linear(&self) -> bool {
        let wall = self.scene.environment.wall();
        let centred = wall.is_none_or(|wall| !wall.is_one_sided() && wall.face() == 0.0);
        let unlimited =
            self.host.is_none() && self.scene.torque_limit.is_none() && self.encoder_step.is_none();
        let anticogs = self.scene.environment.parts().anticogging.is_some();
        let reads_linearly = self.scene.latency.encoder.linearity == 0.0;
        centred
            && unlimited
            && reads_linearly
            && !anticogs
            && self.disturbance().is_none()
            && self.missed == Missed::None
            && self.dropped == Missed::None
    }

    /// The first sample at which more readings in a row have failed than the scene allows.
    pub(super) fn fault(&self) -> Option<usize> {
        self.dropped.fault(self.scene.latency.encoder.dropped, self.samples)
    }

    /// The machine with the scene's lags at its two ends.
    pub fn machine(&self) -> Plant {
        self.plant.clone().with_lags(&self.scene.latency, self.scene.timing.period)
    }

    /// The plant over a tick.
    ///
    /// # Errors
    /// Where the machine is too fast for its motion over a period to be computed.
    pub fn tick(&self, integration: Integration) -> Result<DiscretePlant, SimulationError> {
        DiscretePlant::checked(
            &self.machine(),
            &self.discretization(integration),
            self.hand_torque.omega(),
        )
    }

    /// How the plant is taken through a tick.
    pub fn discretization(&self, integration: Integration) -> Discretization {
        let over_a_tick = Discretization {
            method: integration.method,
            substeps: integration.substeps.max(1),
            ..Discretization::exact(self.scene.timing.period)
        };
        over_a_tick.delayed(&self.scene.latency, self.latency)
    }
}

/// Integration method and substeps per tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integration {
    /// The method.
    pub method: Method,
    /// Steps a tick, at least one; the result of the exact method does not depend on them.
    pub substeps: u32,
}

impl Default for Integration {
    fn default() -> Self {
        Self { method: Method::Exact, substeps: 1 }
    }
}
