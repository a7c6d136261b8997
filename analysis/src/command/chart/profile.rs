//! `haptic chart profile`: torque and potential of a torque profile over angle.

use clap::Args;

use super::output::OutputArguments;
use crate::chart::{self, Chart, Data};
use crate::command::shared_arguments::SceneArgument;
use crate::command::status::CommandError;
use crate::file::SceneFile;
use crate::profile_curve::ProfileCurve;
use crate::quantity::{shortened, significant};

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub scene: SceneArgument,
    #[command(flatten)]
    pub output: OutputArguments,
}

pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    of_file(&arguments.scene.load()?)
}

pub fn of_file(file: &SceneFile) -> Result<Chart, CommandError> {
    let curve = ProfileCurve::of(&file.scene)
        .ok_or_else(|| CommandError::NoProfile { scene: file.name.clone() })?;
    let delay = file.scene.environment.delay();
    let period = significant(1e3 * file.scene.timing.period, 4);
    let title =
        format!("{}: torque profile of delay {delay}, T = {period} ms", shortened(&file.name, 40));
    let picture = chart::profile::profile(&title, &curve, file.scene.torque_limit)?;
    let compliance = curve.compliance;
    let rows = curve.points.into_iter().map(move |[angle, torque, potential]| {
        let handle = angle + compliance * torque;
        [angle, torque, potential, handle].map(Into::into).to_vec()
    });
    let header = "angle (rad),torque (N m),potential (J),angle at the handle (rad)";
    Ok(Chart { picture, data: Data::new(header, rows) })
}
