//! The results of a model of a scene: verdicts, motion, and the cost of computing them.

use std::hint::black_box;

use haptic_servo::scene::Scene;
use serde::Serialize;

use super::Model;
use crate::file::SceneFile;
use crate::simulation::{Experiment, Integration, SimulationError, Trajectory, simulate};
use crate::stability;
use crate::studies::bench::median_time;
use crate::verdict::{self, VerdictReport};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelResult {
    /// States of the loop, the servo's included.
    pub states: usize,
    /// Simulated samples per second on one core of this machine.
    pub steps_per_second: f64,
    /// Passivity in N m s/rad for the certificate; `None` if the device of this model has none.
    pub delta: Option<f64>,
    /// The certificate's verdict; `None` without a `delta`.
    pub certificate: Option<verdict::Verdict>,
    /// Whether the loop is stable in the model's hand.
    pub stability: stability::StabilityVerdict,
    /// Stiffness of the environment in N m/rad above which the loop is unstable.
    pub critical_stiffness: Option<f64>,
    #[serde(skip)]
    pub motion: Trajectory,
}

impl ModelResult {
    /// Evaluates a model of a file's machine; `run` is the file's simulation.
    pub(super) fn of(
        model: Model,
        file: &SceneFile,
        run: &Experiment,
    ) -> Result<Self, SimulationError> {
        let (experiment, integration) = (model.experiment(file, run), Integration::default());
        let certificate = certificate(model, file);
        let stability = stability::judge(&experiment, integration)?;
        Ok(Self {
            states: stability::closed_loop(&experiment, integration)?.matrix.nrows(),
            steps_per_second: speed(&experiment),
            delta: certificate.as_ref().map(|report| report.delta),
            certificate: certificate.map(|report| report.verdict),
            stability: stability.verdict,
            critical_stiffness: stability.critical_stiffness,
            motion: simulate(&experiment, integration)?,
        })
    }
}

/// The certificate of the scene on the model's device, if the device has passivity: its own, or the declared
/// passivity if that is less.
fn certificate(model: Model, file: &SceneFile) -> Option<VerdictReport> {
    let mut device = model.chain(file).as_rigid().ok()?;
    if let Some(declared) = declared(file) {
        device.passivity = Some(device.passivity.unwrap_or(device.damping).min(declared));
    }
    Some(verdict::judge(&file.name, &Scene { device, ..model.scene(file) }))
}

/// The file's declared passivity, if it is not that of its chain.
fn declared(file: &SceneFile) -> Option<f64> {
    let own = file.chain.as_rigid().ok()?.passivity;
    file.scene.device.passivity.filter(|&passivity| own != Some(passivity))
}

/// Median over a few rounds.
fn speed(experiment: &Experiment) -> f64 {
    const STEPS: usize = 4096;
    const ROUNDS: usize = 5;
    let experiment = Experiment { samples: STEPS, ..experiment.clone() };
    let run = || _ = black_box(simulate(black_box(&experiment), Integration::default()));
    STEPS as f64 / median_time(ROUNDS, run)
}
