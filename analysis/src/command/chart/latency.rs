//! `haptic chart latency`: the largest stiffness of a spring behind a current loop, over the servo's rate.

use std::ops::Range;

use clap::Args;

use super::output::OutputArguments;
use crate::chart::{self, Chart, Data};
use crate::command::shared_arguments::SceneArgument;
use crate::command::status::CommandError;
use crate::command::value_parsers::{number, positive_range};
use crate::latency_limits::{LatencyLimits, LatencyPoint};
use crate::progress;
use crate::quantity::{shortened, significant};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file, of which the device's passivity counts
    #[command(flatten)]
    pub scene: SceneArgument,
    /// Range of the servo's rate in Hz, the horizontal axis
    #[arg(long, visible_alias = "x", value_name = "MIN..MAX", value_parser = positive_range,
          default_value = "500..50000", allow_hyphen_values = true)]
    pub rates: Range<f64>,
    /// Bandwidths of the current loop in Hz, a panel each
    #[arg(long, value_name = "HZ,..", value_parser = positive, allow_hyphen_values = true, value_delimiter = ',',
          default_value = "500,1000,2000,3000")]
    pub loops: Vec<f64>,
    /// Time in s from a count to its torque, where that is at a fixed phase
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true, default_value = "1e-5")]
    pub phase: f64,
    #[command(flatten)]
    pub output: OutputArguments,
}

const RATES: usize = 61;

pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    let file = arguments.scene.load()?;
    let bar = progress::bar(arguments.loops.len() as u64, "limits");
    let limits = |bandwidth: &f64| {
        let rates = arguments.rates.clone();
        let limits =
            LatencyLimits::new(&file.scene.device, *bandwidth, arguments.phase, rates, RATES);
        bar.inc(1);
        limits
    };
    let loops: Vec<_> = arguments.loops.iter().map(limits).collect();
    bar.finish_and_clear();
    let title = format!(
        "{}: largest spring, torques {} us after their counts",
        shortened(&file.name, 32),
        significant(arguments.phase * 1e6, 4)
    );
    let picture = chart::latency::latency(&title, &loops)?;
    let rows = loops.into_iter().flat_map(|limits| {
        limits.points.into_iter().map(move |point| {
            let oscillates = f64::from(u8::from(point.folklore_is_unsafe()));
            let LatencyPoint { rate, at_phase, latched, whole_samples, folklore, .. } = point;
            let known = [Some(limits.bandwidth), Some(rate), at_phase, Some(latched)];
            let assumed = [whole_samples, Some(folklore), Some(oscillates)];
            known.into_iter().chain(assumed).map(Into::into).collect()
        })
    });
    let header = "current loop (Hz),servo rate (Hz),at a phase (N m/rad),latched (N m/rad),\
                  whole samples (N m/rad),b/(T/2 + tau) (N m/rad),oscillates (1)";
    Ok(Chart { picture, data: Data::new(header, rows) })
}

fn positive(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value > 0.0 { Ok(value) } else { Err(format!("{value} must be greater than 0")) }
}
