//! `haptic chart limits`: the largest stiffness of a wall, and the ripple by the encoder, over the sample
//! rate.

use std::ops::Range;

use clap::Args;
use haptic_servo::scene::Coupling;

use super::output::OutputArguments;
use crate::chart::limits::{DelayCurve, Own};
use crate::chart::{self, Chart, ChartError, Data};
use crate::command::shared_arguments::SceneArgument;
use crate::command::status::CommandError;
use crate::command::value_parsers::{counts, number, positive_range};
use crate::limits::{Curves, Limit, Point, at_period, largest_stiffness, with_wall};
use crate::progress;
use crate::quantity::{shortened, significant};
use crate::stability_map::MapError;

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub scene: SceneArgument,
    /// Range of the sample rate in Hz, the horizontal axis
    #[arg(long, visible_alias = "x", value_name = "MIN..MAX", value_parser = positive_range,
          default_value = "500..100000", allow_hyphen_values = true)]
    pub rates: Range<f64>,
    /// Range of the stiffness in N m/rad, the vertical axis; default: all data
    #[arg(long, value_name = "MIN..MAX", value_parser = positive_range, allow_hyphen_values = true)]
    pub y: Option<Range<f64>>,
    /// Encoder counts per turn; default: from `encoder_step` in the scene's table `limits`, or
    /// 65536
    #[arg(long, value_name = "N", value_parser = counts, allow_hyphen_values = true)]
    pub counts_per_rev: Option<f64>,
    /// Fraction of the largest stiffness at which the ripple is computed: at 1 it has no bound
    #[arg(long, value_name = "PART", value_parser = part, default_value = "0.7")]
    pub used: f64,
    #[command(flatten)]
    pub output: OutputArguments,
}

/// Longest delay in the picture of limits, in samples.
const DELAYS: usize = 4;
/// Sample rates in the picture of limits.
const RATES: usize = 61;

pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    let file = arguments.scene.load()?;
    let Some(wall) = file.scene.environment.wall() else {
        return Err(MapError::NoWall { scene: file.name }.into());
    };
    let rate = 1.0 / file.scene.timing.period;
    let own = Own { rate, stiffness: wall.stiffness, delay: wall.delay };
    let curves = Curves {
        rates: arguments.rates.clone(),
        points: RATES,
        counts_per_turn: file.transducers(arguments.counts_per_rev, None).counts_per_turn,
        used: arguments.used,
    };
    let bar = progress::bar(DELAYS as u64 + 1, "limits");
    let drawn: Vec<_> = (0..=DELAYS)
        .map(|delay| {
            let points = curves.of(&file.scene, delay);
            let slowest = at_period(&file.scene, 1.0 / curves.rates.start);
            let undelayed = with_wall(&slowest, 0.0, Some(delay));
            bar.inc(1);
            let is_coupling = largest_stiffness(&undelayed) == Limit::Any;
            DelayCurve { delay, is_coupling, points }
        })
        .collect();
    bar.finish_and_clear();
    let coupling = match file.scene.coupling {
        Coupling::Rigid => "rigid coupling",
        Coupling::Matched => "behind the matched coupling",
        Coupling::Spring { .. } => "behind the standard coupling 2 delta/T",
    };
    let note = format!(
        "ripple of half a count of {} a turn, at {} % of the largest stiffness, {coupling}",
        significant(whole(curves.counts_per_turn), 7),
        significant(100.0 * curves.used, 3)
    );
    let title = format!("{}: largest stiffness over sample rate", shortened(&file.name, 48));
    let picture = chart::limits::limits(&title, &note, &drawn, &own, arguments.y.clone());
    let picture = picture.map_err(|error| match error {
        ChartError::TooFewPoints => CommandError::NoStiffness { scene: file.name.clone() },
        other => other.into(),
    })?;
    let rows = drawn.into_iter().flat_map(|curve| {
        let delay = curve.delay as f64;
        curve.points.into_iter().map(move |Point { rate, stiffness, ripple }| {
            vec![delay.into(), rate.into(), stiffness.into(), ripple.into()]
        })
    });
    let header = "delay (samples),sample rate (Hz),largest stiffness (N m/rad),ripple (N m)";
    Ok(Chart { picture, data: Data::new(header, rows) })
}

/// The whole number of counts of a rounded step in rad, if one is near enough.
fn whole(counts: f64) -> f64 {
    let nearest = counts.round();
    if (counts - nearest).abs() <= 1e-5 * nearest { nearest } else { counts }
}

fn part(text: &str) -> Result<f64, String> {
    let part = number(text)?;
    if part > 0.0 && part < 1.0 { Ok(part) } else { Err(format!("{part} must be between 0 and 1")) }
}
