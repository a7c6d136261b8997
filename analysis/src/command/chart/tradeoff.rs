//! `haptic chart tradeoff`: speed against accuracy, measured, kept as a table and drawn.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::chart;
use crate::command::status::{CommandError, CommandStatus};
use crate::studies::tradeoff::{Comparison, Tradeoff, certificate, servo, sine, ticks};
use crate::table::Table;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Comparison to draw
    #[arg(value_enum, default_value_t)]
    pub topic: Topic,
    /// Draw the kept tables instead of measuring
    #[arg(long)]
    pub draw_only: bool,
    /// Folder of the tables and charts; default: analysis/pictures/tradeoff of this repository
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
}

/// Comparison to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Topic {
    /// Each of the following
    #[default]
    All,
    /// Number formats of the servo: instructions against error and limit cycle
    Servo,
    /// Ways to compute a sine: instructions against error
    Sine,
    /// Methods to compute the certificate: time against error of the index and of the verdict
    Certificate,
}

/// All topics except [`Topic::All`].
const TOPICS: [Topic; 3] = [Topic::Servo, Topic::Sine, Topic::Certificate];

impl Topic {
    fn topics(self) -> Vec<Self> {
        if self == Self::All { TOPICS.to_vec() } else { vec![self] }
    }

    fn comparison(self) -> &'static Comparison {
        match self {
            Self::Servo => &servo::COMPARISON,
            Self::Sine => &sine::COMPARISON,
            Self::All | Self::Certificate => &certificate::COMPARISON,
        }
    }

    fn measure(self) -> Result<Tradeoff, CommandError> {
        match self {
            Self::Servo => Ok(servo::measure()?),
            Self::Sine => Ok(sine::measure()?),
            Self::All | Self::Certificate => Ok(certificate::measure()),
        }
    }
}

/// Measures, stores and draws.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("pictures/tradeoff");
    let folder = arguments.output.as_ref().unwrap_or(&kept);
    if !arguments.draw_only {
        std::fs::create_dir_all(folder).map_err(|source| unwritable(folder, source))?;
    }
    for topic in arguments.topic.topics() {
        let table = table_of(topic.comparison(), folder);
        if !arguments.draw_only {
            keep(&topic.measure()?, folder)?;
            if topic == Topic::Servo {
                // The cost of a tick of any scene, for which there is no chart.
                keep(&ticks::measure()?, folder)?;
            }
        }
        if arguments.draw_only && !table.exists() {
            return Err(CommandError::NothingKept { table });
        }
        let tradeoff = Tradeoff::read(topic.comparison(), Table::open(&table)?)?;
        draw(&tradeoff, folder)?;
    }
    Ok(CommandStatus::Success)
}

fn unwritable(path: &Path, source: io::Error) -> CommandError {
    CommandError::Unwritable { path: path.to_owned(), source }
}

/// The file of a comparison's table in a folder.
fn table_of(comparison: &Comparison, folder: &Path) -> PathBuf {
    folder.join(comparison.name).with_extension("csv")
}

fn keep(measured: &Tradeoff, folder: &Path) -> Result<(), CommandError> {
    let path = table_of(measured.comparison, folder);
    let written = File::create(&path).and_then(|out| measured.write(out));
    written.map_err(|source| unwritable(&path, source))
}

/// Draws a table into a folder: a chart, or one for each of several errors.
fn draw(tradeoff: &Tradeoff, folder: &Path) -> Result<(), CommandError> {
    let Comparison { name, errors, .. } = tradeoff.comparison;
    for (number, error) in errors.iter().enumerate() {
        let name = match errors {
            [_] => (*name).to_owned(),
            _ => format!("{name}-{}", error.name),
        };
        let picture = chart::tradeoff::tradeoff(tradeoff, number)?;
        picture.write(&folder.join(&name).with_extension("svg"))?;
    }
    Ok(())
}
