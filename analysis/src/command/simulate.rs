//! `haptic simulate`: simulates a scene sample by sample.

use std::io::{self, Write};

use clap::Args;
use haptic_servo::scene::Scene;
use serde::Serialize;

use super::shared_arguments::{IntegrationArguments, JsonOption, SceneArgument, json};
use super::status::{CommandError, CommandStatus};
use crate::nominal_latency::left_out;
use crate::quantity::{rounded, significant};
use crate::simulation::tick_status::TickStatus;
use crate::simulation::{Experiment, Integration, Simulator, Trajectory, simulate};

/// Samples that are computed before they are written, if each is written.
const CHUNK: usize = 4096;

/// Arguments of `haptic simulate`; the scene needs a table `simulation`.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub scene: SceneArgument,
    #[command(flatten)]
    pub steps: IntegrationArguments,
    /// Print one row for each sample: time (s), position (rad), velocity (rad/s), torque (N m),
    /// limit reason; with a host, its torque at the motor (N m) and its tank's level (J)
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    #[command(flatten)]
    pub answer: JsonOption,
}

/// A sample as a line of CSV.
#[derive(Serialize)]
struct Row {
    time: f64,
    position: f64,
    velocity: f64,
    torque: f64,
    limit: TickStatus,
    #[serde(skip_serializing_if = "Option::is_none")]
    host_torque: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    host_energy: Option<f64>,
}

#[derive(Serialize)]
struct Answer<'t> {
    #[serde(flatten)]
    trajectory: &'t Trajectory,
    /// The part of the scene's latency that is not simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    left_out: Option<&'static str>,
}

/// Angle in rad from zero beyond which a motion counts as divergent: 160 000 turns.
const FARTHEST: f64 = 1e6;

/// Simulates the scene, certified or not. If a motion grows beyond the range of numbers, the part before is
/// printed. The status is negative then, and if the device runs away.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let file = arguments.scene.load_to_simulate()?;
    let experiment = Experiment::of(&file, arguments.scene.folder())?;
    let integration = arguments.steps.integration();
    let mut out = io::BufWriter::new(io::stdout().lock());
    let (computed, far) = if arguments.csv {
        rows(&experiment, integration, &mut out)?
    } else {
        let trajectory = simulate(&experiment, integration)?;
        if arguments.answer.json {
            let left_out = left_out(&experiment.scene.latency);
            json(&mut out, &Answer { trajectory: &trajectory, left_out })?;
        } else {
            write!(out, "{}", text(&file.name, &experiment.scene, &trajectory))?;
        }
        (trajectory.samples(), far(&trajectory))
    };
    out.flush()?;
    experiment.completed(computed)?;
    match far {
        None => Ok(CommandStatus::Success),
        Some(sample) => {
            let time = sample as f64 * experiment.scene.timing.period;
            Err(CommandError::RanAway { farthest: FARTHEST, sample, time })
        }
    }
}

/// The first sample at which the device has run away.
fn far(trajectory: &Trajectory) -> Option<usize> {
    trajectory.position.iter().position(|position| position.abs() > FARTHEST)
}

/// Writes the samples in constant memory; returns their number, and the sample at which the device has run
/// away.
fn rows(
    experiment: &Experiment,
    integration: Integration,
    out: impl Write,
) -> Result<(usize, Option<usize>), CommandError> {
    let mut writer = csv::Writer::from_writer(out);
    let mut simulator = Simulator::new(experiment, integration)?;
    let (mut done, mut ran_away) = (0, None);
    while done < experiment.samples {
        let wanted = CHUNK.min(experiment.samples - done);
        let mut chunk = Trajectory::of_length(wanted);
        simulator.fill(&mut chunk);
        for (i, &position) in chunk.position.iter().enumerate() {
            // Without the last digits, which come from the product's rounding.
            let time = rounded((done + i) as f64 * experiment.scene.timing.period, 15);
            let (velocity, torque, limit) = (chunk.velocity[i], chunk.torque[i], chunk.limit[i]);
            let of_host = |column: &Option<Vec<f64>>| column.as_ref().map(|column| column[i]);
            let (host_torque, host_energy) =
                (of_host(&chunk.host_torque), of_host(&chunk.host_energy));
            let row = Row { time, position, velocity, torque, limit, host_torque, host_energy };
            writer.serialize(row)?;
        }
        ran_away = ran_away.or(far(&chunk).map(|sample| done + sample));
        done += chunk.samples();
        if chunk.samples() < wanted {
            break;
        }
    }
    writer.flush()?;
    Ok((done, ran_away))
}

/// The motion in a few lines of text.
fn text(name: &str, scene: &Scene, trajectory: &Trajectory) -> String {
    let period = scene.timing.period;
    let simplified =
        left_out(&scene.latency).map_or_else(String::new, |words| format!("latency    {words}\n"));
    let Some(last) = trajectory.samples().checked_sub(1) else { return String::new() };
    let time = |sample: usize| significant(sample as f64 * period, 6);
    let row = |label: &str, column: &[f64], unit: &str| {
        let largest =
            (0..column.len()).max_by(|&a, &b| column[a].abs().total_cmp(&column[b].abs()));
        let largest = largest.unwrap_or(0);
        format!(
            "{label:<10} {} {unit} at the end; largest {} {unit} at {} s\n",
            significant(column[last], 6),
            significant(column[largest], 6),
            time(largest)
        )
    };
    let host = match (&trajectory.host_torque, &trajectory.host_energy) {
        (Some(torque), Some(energy)) => {
            let least = energy.iter().copied().fold(f64::INFINITY, f64::min);
            let energy = [energy[last], least].map(|energy| significant(energy, 6));
            row("host", torque, "N m")
                + &format!("tank       {} J at the end; least {} J\n", energy[0], energy[1])
        }
        _ => String::new(),
    };
    format!(
        "scene      {name}\n{simplified}samples    {} over {} s\n{}{}{}{host}",
        last + 1,
        time(last),
        row("position", &trajectory.position, "rad"),
        row("velocity", &trajectory.velocity, "rad/s"),
        row("torque", &trajectory.torque, "N m")
    )
}
