//! `haptic chart turn`: the torque on a hand that turns a torque profile.

use clap::Args;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

use super::output::OutputArguments;
use crate::chart::{self, Chart, Data};
use crate::command::file_scene::scene_file;
use crate::command::status::CommandError;
use crate::device::Hand;
use crate::felt_turn::{FINGERS, FeltTurn, FeltTurnError};
use crate::program::Program;
use crate::quantity::{shortened, significant};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a scene's program, or scene file; `-` is standard input
    #[arg(value_name = "SCENE")]
    pub scene: String,
    #[command(flatten)]
    pub output: OutputArguments,
}

/// Turns a scene's device and draws the torque that the hand feels.
pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    match Program::find(&arguments.scene) {
        Some(Program { name, scene, transducers, .. }) => {
            of_scene(name, scene, transducers, FINGERS)
        }
        None => {
            let file = scene_file(&arguments.scene)?;
            let (hand, transducers) = (file.hand.unwrap_or(FINGERS), file.transducers(None, None));
            of_scene(&file.name, &file.scene, &transducers, hand)
        }
    }
}

fn of_scene(
    name: &str,
    scene: &Scene,
    transducers: &Transducers,
    hand: Hand,
) -> Result<Chart, CommandError> {
    let turn = FeltTurn::of(scene, transducers, hand).map_err(|error| match error {
        FeltTurnError::NoProfile => CommandError::NoProfile { scene: name.to_owned() },
        FeltTurnError::Rejected(rejection) => CommandError::Refused(rejection),
        FeltTurnError::Servo(error) => error.into(),
        FeltTurnError::Simulation(error) => error.into(),
    })?;
    let period = significant(1e3 * scene.timing.period, 4);
    let title =
        format!("{}: what a hand feels that turns it, T = {period} ms", shortened(name, 40));
    let picture = chart::turn::turn(&title, &turn)?;
    let FeltTurn { time, angle, setpoint, torque, .. } = turn;
    let rows = (0..time.len())
        .map(move |i| [time[i], angle[i], setpoint[i], torque[i]].map(Into::into).to_vec());
    let data = Data::new("time (s),angle (rad),hand (rad),torque (N m)", rows);
    Ok(Chart { picture, data })
}
