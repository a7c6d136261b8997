//! Description of a board's program, from which its host can certify as well.

use fixed::types::{I1F31, I4F28, I8F24, I12F20, I16F16};
use serde::{Deserialize, Serialize};

use super::changes::Changes;
use crate::build_error::BuildError;
use crate::certificate::{Parameter, Rejection};
use crate::environment::{Environment, Wall};
use crate::host::{HostResponse, HostTimes, HostTorque, ServoNumbers};
use crate::number::{Format, Number};
use crate::scene::Scene;
use crate::servo::{
    Latched, OutputMode, OutputTiming, RenderingOptions, Simultaneous, SupportsTiming, Transducers,
};
use crate::tuning::{self, Parameters, RenderError, Tunable};

/// The scene that runs on a board, with everything that its servo is built from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// The scene, its environment as data.
    pub scene: Scene,
    /// Sensor and motor.
    pub transducers: Transducers,
    /// Options of the rendering.
    pub rendering: RenderingOptions,
    /// The number format of the servo.
    pub format: Format,
    /// The time at which torques reach the motor.
    pub timing: OutputTiming,
}

/// The scene with a weak spring in place of an environment whose law or table only the board has: the
/// encoder, the motor or the limits may still be the reason why its servo cannot be built.
fn with_spring(scene: &Scene) -> Scene {
    const WEAK: f64 = 1e-3;
    let spring = Wall::spring(WEAK, scene.environment.delay().max(1));
    Scene { environment: spring.alone(), ..*scene }
}

impl Description {
    /// The reason why the board refuses changes of the running scene, computed from the same numbers with the
    /// same code, because the board has no room for the text. `has` lists the parameters that can be changed
    /// there, and `host` is the budget of a host beside the scene.
    ///
    /// # Errors
    /// The reason. `Ok` if the changes can run, or if the servo cannot be built in one of the rarer number
    /// formats.
    pub fn explain(
        &self,
        has: Parameters,
        host: Option<&HostTorque>,
        changes: &[(Parameter, f64)],
    ) -> Result<(), RenderError> {
        tuning::check(has, changes)?;
        match self.other_mode(changes) {
            None => {
                self.judge(changes)?;
                host.map_or(Ok(()), |host| self.judge_host(host, changes))
            }
            Some(mode) => self.judge_without(mode, changes),
        }
    }

    /// The reason why the torques of the scene with these changes are beyond the motor, whether it is certified or not:
    /// a board that refuses its servo has certified the scene, by readings and a friction that it does not send.
    ///
    /// # Errors
    /// The reason.
    pub fn check_torques(&self, changes: &[(Parameter, f64)]) -> Result<(), RenderError> {
        let scene = tuning::apply(&self.scene, changes)?;
        self.transducers.limiter::<f64>(scene.torque_limit)?;
        if let Some(anticogging) = &scene.environment.parts().anticogging {
            self.transducers.check_anticogging(anticogging, scene.torque_limit)?;
        }
        Ok(())
    }

    /// The number of the mode that the changes select, if the board has that mode and does not run it: the
    /// table of that mode is only on the board, so the host cannot repeat the step that refused it.
    pub fn other_mode(&self, changes: &[(Parameter, f64)]) -> Option<f64> {
        let running = self.scene.environment.profile()?.modes?;
        let (_, mode) = changes.iter().find(|(parameter, _)| *parameter == Parameter::Mode)?;
        (running.selecting(*mode).index().is_some() && *mode != running.mode).then_some(*mode)
    }

    /// The reason why another mode is refused with these changes. Its table is not available here, so only a
    /// number that is invalid in every mode is found.
    fn judge_without(&self, mode: f64, changes: &[(Parameter, f64)]) -> Result<(), RenderError> {
        let is_kept = |change: &&(Parameter, f64)| change.0 != Parameter::Mode;
        let others: Changes = changes.iter().filter(is_kept).copied().collect();
        match self.judge(&others) {
            Err(
                reason @ (RenderError::Rejected(Rejection::Invalid(_)) | RenderError::Build(_)),
            ) => Err(reason),
            _ => Err(RenderError::OtherMode { mode }),
        }
    }

    /// The reason why a host is refused beside the scene with these changes.
    fn judge_host(
        &self,
        host: &HostTorque,
        changes: &[(Parameter, f64)],
    ) -> Result<(), RenderError> {
        let Self { transducers, rendering, format, timing, .. } = self;
        let certified = tuning::apply(&self.scene, changes)?.certify_in(*format)?;
        let (scene, injected) = (certified.as_data(), rendering.injection.unwrap_or(0.0));
        let margin = certified.assessment().margin_injecting(scene, injected);
        let cogging = scene.environment.parts().against_cogging();
        let servo = ServoNumbers::of(scene, cogging, margin, transducers, rendering, *timing)?;
        let is_plain = HostTimes::of(&scene.latency, scene.timing.period).is_plain;
        let ticks = usize::from(*timing == OutputTiming::Latched);
        HostResponse::beside(host, &servo, HostTimes { ticks, is_plain })?;
        Ok(())
    }

    /// The reason why the scene with these changes is refused.
    fn judge(&self, changes: &[(Parameter, f64)]) -> Result<(), RenderError> {
        match self.timing {
            OutputTiming::Latched => self.by_mode::<Latched>(changes),
            OutputTiming::Simultaneous => self.by_mode::<Simultaneous>(changes),
            timing @ OutputTiming::AtPhase(_) => {
                let certified = tuning::apply(&self.scene, changes)?.certify_in(self.format)?;
                certified.assessment().renders_at(certified.as_data(), timing)?;
                Ok(())
            }
        }
    }

    fn by_mode<M: OutputMode>(&self, changes: &[(Parameter, f64)]) -> Result<(), RenderError>
    where
        Environment: SupportsTiming<M>,
    {
        match self.format {
            Format::F32 => self.by_number::<f32, M>(changes),
            Format::F64 => self.by_number::<f64, M>(changes),
            Format::Fixed { fraction_bits: 16 } => self.by_number::<I16F16, M>(changes),
            Format::Fixed { fraction_bits: 20 } => self.by_number::<I12F20, M>(changes),
            Format::Fixed { fraction_bits: 24 } => self.by_number::<I8F24, M>(changes),
            Format::Fixed { fraction_bits: 28 } => self.by_number::<I4F28, M>(changes),
            Format::Fixed { fraction_bits: 31 } => self.by_number::<I1F31, M>(changes),
            format => {
                let certified = tuning::apply(&self.scene, changes)?.certify_in(format)?;
                certified.time::<M>()?;
                Ok(())
            }
        }
    }

    fn by_number<N: Number, M: OutputMode>(
        &self,
        changes: &[(Parameter, f64)],
    ) -> Result<(), RenderError>
    where
        Environment: Tunable<N> + SupportsTiming<M>,
    {
        let Self { scene, transducers, rendering, .. } = self;
        match tuning::explain::<Environment, N, M>(scene, changes, transducers, rendering) {
            Err(RenderError::Build(BuildError::LawElsewhere)) => {
                let scene = with_spring(&tuning::apply(scene, changes)?);
                tuning::explain::<Environment, N, M>(&scene, &[], transducers, rendering)
            }
            outcome => outcome,
        }
    }
}
