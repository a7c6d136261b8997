//! `haptic stability`: the spectral radius of the loop of device, hand and servo.

use clap::Args;

use super::shared_arguments::{IntegrationArguments, JsonOption, SceneArgument};
use super::status::{CommandError, CommandStatus};
use crate::nominal_latency::titled;
use crate::quantity::significant;
use crate::simulation::Experiment;
use crate::stability::{Stability, StabilityVerdict, judge};

/// Arguments of `haptic stability`. The scene's table `human`, if it has one, holds the device; the
/// loop is judged as a simulation by this method would show it.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub scene: SceneArgument,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub steps: IntegrationArguments,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub answer: JsonOption,
}

/// Judges the linear loop: the status is negative if it is unstable.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let file = arguments.scene.load_to_simulate()?;
    let stability = judge(&Experiment::at_rest(&file), arguments.steps.integration())?;
    let name = titled(&file.name, [&file.scene.latency]);
    arguments.answer.print(&stability, |stability| text(&name, stability))?;
    Ok(if stability.verdict == StabilityVerdict::Unstable {
        CommandStatus::NegativeVerdict
    } else {
        CommandStatus::Success
    })
}

fn text(name: &str, stability: &Stability) -> String {
    let meaning = match stability.verdict {
        StabilityVerdict::Stable => "STABLE: a small motion decays",
        StabilityVerdict::Unstable => "UNSTABLE: a small motion grows",
        StabilityVerdict::Marginal => "MARGINAL: a small motion neither grows nor decays",
    };
    let critical = match stability.critical_stiffness {
        Some(stiffness) => format!("{} N m/rad", significant(stiffness, 12)),
        None => "none".to_owned(),
    };
    format!(
        "scene               {name}\nverdict             {meaning}\nspectral radius     {}\n\
         critical stiffness  {critical}\n",
        significant(stability.spectral_radius, 12)
    )
}
