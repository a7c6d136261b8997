//! `haptic simulate`: what would a scene do?

use std::io::{self, Write};
use std::path::Path;

use clap::Args;
use serde::Serialize;

use super::{Answer, CommandError};
use crate::file::{self, Purpose};
use crate::quantity::significant;
use crate::simulation::method::Method;
use crate::simulation::served::Served;
use crate::simulation::{Experiment, Simulator, Stride, Trajectory, simulate};

/// Samples that are computed before they are written, where they are written one by one.
const CHUNK: usize = 4096;

/// Arguments of `haptic simulate`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file with a table `simulation`, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Method of integration of the device; the servo is computed tick by tick in all of them
    #[arg(long, value_enum, default_value_t)]
    pub method: Method,
    /// Steps of the method in each tick
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub substeps: u32,
    /// Print one JSON object: position (rad), velocity (rad/s), torque (N m) at the samples, and
    /// what limited the torque
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// Print a line for each sample: time (s), position, velocity, torque, limit
    #[arg(long)]
    pub csv: bool,
}

/// A sample as a line of CSV.
#[derive(Serialize)]
struct Row {
    time: f64,
    position: f64,
    velocity: f64,
    torque: f64,
    limit: Served,
}

/// Simulates the scene, certified or not.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let file = file::load_for(Purpose::Simulate, &arguments.file)?;
    let folder = Path::new(&arguments.file).parent().unwrap_or(Path::new(""));
    let experiment = Experiment::of(&file, folder)?;
    let stride = Stride { method: arguments.method, substeps: arguments.substeps };
    let mut out = io::BufWriter::new(io::stdout().lock());
    if arguments.csv {
        rows(&experiment, stride, &mut out)?;
    } else {
        let trajectory = simulate(&experiment, stride)?;
        if arguments.json {
            serde_json::to_writer(&mut out, &trajectory).map_err(io::Error::from)?;
            writeln!(out)?;
        } else {
            write!(out, "{}", text(&file.name, experiment.scene.timing.period, &trajectory))?;
        }
    }
    out.flush()?;
    Ok(Answer::Yes)
}

/// Writes the samples as they come, in constant memory.
fn rows(experiment: &Experiment, stride: Stride, out: impl Write) -> Result<(), CommandError> {
    let mut writer = csv::Writer::from_writer(out);
    let mut simulator = Simulator::new(experiment, stride)?;
    let mut done = 0;
    while done < experiment.samples {
        let mut chunk = Trajectory::of_length(CHUNK.min(experiment.samples - done));
        simulator.fill(&mut chunk);
        for (i, &position) in chunk.position.iter().enumerate() {
            let time = (done + i) as f64 * experiment.scene.timing.period;
            let (velocity, torque, limit) = (chunk.velocity[i], chunk.torque[i], chunk.limit[i]);
            writer.serialize(Row { time, position, velocity, torque, limit }).map_err(written)?;
        }
        done += chunk.position.len();
    }
    writer.flush()?;
    Ok(())
}

/// Numbers always fit a line of CSV: what fails is the writing.
fn written(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

/// The motion in a few lines, for a person.
fn text(name: &str, period: f64, trajectory: &Trajectory) -> String {
    let time = |sample: usize| significant(sample as f64 * period, 6);
    let last = trajectory.position.len().saturating_sub(1);
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
    format!(
        "scene      {name}\nsamples    {} over {} s\n{}{}{}",
        last + 1,
        time(last),
        row("position", &trajectory.position, "rad"),
        row("velocity", &trajectory.velocity, "rad/s"),
        row("torque", &trajectory.torque, "N m")
    )
}
