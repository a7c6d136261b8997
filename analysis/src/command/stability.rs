//! `haptic stability`: does the motion of this device in this hand die away?

use std::io::{self, Write};

use clap::Args;

use super::{Answer, CommandError};
use crate::file::{self, Purpose};
use crate::quantity::significant;
use crate::simulation::method::Method;
use crate::simulation::{Experiment, Stride};
use crate::stability::{Stability, Verdict, judge};

/// Arguments of `haptic stability`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file, TOML or JSON; `-` is standard input. Its table `human`, if any, holds the device
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Judge the loop as a simulation by this method would show it
    #[arg(long, value_enum, default_value_t)]
    pub method: Method,
    /// Steps of the method in each tick
    #[arg(long, value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub substeps: u32,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Judges the linear loop: the answer is no where it is unstable.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let file = file::load_for(Purpose::Simulate, &arguments.file)?;
    let stride = Stride { method: arguments.method, substeps: arguments.substeps };
    let stability = judge(&Experiment::at_rest(&file), stride)?;
    let mut out = io::stdout().lock();
    if arguments.json {
        serde_json::to_writer(&mut out, &stability).map_err(io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{}", text(&file.name, &stability))?;
    }
    out.flush()?;
    Ok(if stability.verdict == Verdict::Unstable { Answer::No } else { Answer::Yes })
}

fn text(name: &str, stability: &Stability) -> String {
    let meaning = match stability.verdict {
        Verdict::Stable => "STABLE: a small motion dies away",
        Verdict::Unstable => "UNSTABLE: a small motion grows",
        Verdict::Marginal => "MARGINAL: a small motion neither grows nor dies away",
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
