//! `haptic stability`: the spectral radius of the loop of device, hand and servo.

use clap::Args;

use super::shared_arguments::{IntegrationArguments, JsonOption, SceneArgument};
use super::status::{CommandError, CommandStatus};
use crate::nominal_latency::titled_loop;
use crate::quantity::significant;
use crate::simulation::Experiment;
use crate::stability::{Stability, StabilityVerdict, judge};

/// Arguments of `haptic stability`. The scene's table `human`, if it has one, holds the device; the
/// loop is judged as a simulation by this method would show it.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub scene: SceneArgument,
    #[command(flatten)]
    pub steps: IntegrationArguments,
    #[command(flatten)]
    pub answer: JsonOption,
}

/// Judges the linear loop: the status is negative if it is unstable or undecided.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let file = arguments.scene.load_to_simulate()?;
    let stability = judge(&Experiment::at_rest(&file), arguments.steps.integration())?;
    let name = titled_loop(&file.name, &file.scene);
    arguments.answer.print(&stability, |stability| text(&name, stability))?;
    Ok(match stability.verdict {
        StabilityVerdict::Unstable | StabilityVerdict::Undecided => CommandStatus::NegativeVerdict,
        StabilityVerdict::Stable | StabilityVerdict::Marginal => CommandStatus::Success,
    })
}

fn text(name: &str, stability: &Stability) -> String {
    let meaning = match stability.verdict {
        StabilityVerdict::Stable => "STABLE: a small motion decays",
        StabilityVerdict::Unstable => "UNSTABLE: a small motion grows",
        StabilityVerdict::Marginal => "MARGINAL: a small motion neither grows nor decays",
        StabilityVerdict::Undecided => "UNDECIDED: rounding hides whether a small motion decays",
    };
    let stiffness = |value: f64| format!("{} N m/rad", significant(value, 12));
    let critical = match stability.stable_stiffness {
        Some([Some(from), Some(to)]) => {
            format!("{}; stable only from {} to it", stiffness(to), stiffness(from))
        }
        Some([Some(from), None]) => format!("none; stable only above {}", stiffness(from)),
        _ => stability.critical_stiffness.map_or_else(|| "none".to_owned(), stiffness),
    };
    format!(
        "scene               {name}\nverdict             {meaning}\nspectral radius     {}\n\
         critical stiffness  {critical}\n",
        radius(stability)
    )
}

/// The spectral radius with the digits that are known, 12 at most.
fn radius(stability: &Stability) -> String {
    let [low, high] = stability.spectral_radius_enclosure;
    let known = (1..=12).rev().map(|digits| [low, high].map(|end| significant(end, digits)));
    let agreed = known.into_iter().find(|[low, high]| low == high);
    agreed.map_or_else(|| format!("from {low:e} to {high:e}"), |[known, _]| known)
}
