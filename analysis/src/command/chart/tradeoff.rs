//! `haptic chart tradeoff`: speed against accuracy, measured, kept as a table and drawn.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::chart::tradeoff::Panels;
use crate::chart::{self, Picture};
use crate::command::shared_arguments::DEFAULT_TICKS;
use crate::command::status::{CommandError, CommandStatus};
use crate::compare_run::{Backend, Input, run_with_backend};
use crate::program::{self, Program};
use crate::progress;
use crate::quantity::significant;
use crate::studies::tradeoff::{
    Comparison, Tradeoff, certificate, rate, servo, simulation, sine, ticks,
};
use crate::table::Table;
use crate::toolchain::{self, NumberFormat, Tools};

/// Arguments of `haptic chart tradeoff`.
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
    /// Draw only the panels of these cases and errors, into this .svg
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    /// Name of a case in the table; default: all
    #[arg(long, value_name = "CASE", requires = "picture")]
    pub case: Vec<String>,
    /// Column of an error in the table; default: all
    #[arg(long, value_name = "COLUMN", requires = "picture")]
    pub error: Vec<String>,
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
    /// Methods of integration: time against error of the motion and of the verdict
    Simulation,
    /// Methods to compute the certificate: time against error of the index and of the verdict
    Certificate,
    /// Sample rates: share of the processor against stiffness and ripple of the encoder
    Rate,
}

/// All topics except [`Topic::All`].
const TOPICS: [Topic; 5] =
    [Topic::Servo, Topic::Sine, Topic::Simulation, Topic::Certificate, Topic::Rate];

impl Topic {
    fn topics(self) -> Vec<Self> {
        if self == Self::All { TOPICS.to_vec() } else { vec![self] }
    }

    fn comparison(self) -> &'static Comparison {
        match self {
            Self::Servo => &servo::COMPARISON,
            Self::Sine => &sine::COMPARISON,
            Self::All | Self::Simulation => &simulation::COMPARISON,
            Self::Certificate => &certificate::COMPARISON,
            Self::Rate => &rate::COMPARISON,
        }
    }

    fn measure(self) -> Result<Tradeoff, CommandError> {
        match self {
            Self::Servo => Ok(servo::measure()?),
            Self::Sine => Ok(sine::measure()?),
            Self::All | Self::Simulation => Ok(simulation::measure()?),
            Self::Certificate => Ok(certificate::measure()),
            Self::Rate => Ok(rate::table(&interrupts()?)),
        }
    }
}

/// Measures, stores and draws; prints the methods on the fronts.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("pictures/tradeoff");
    let folder = arguments.output.as_ref().unwrap_or(&kept);
    if let (Some(picture), Topic::All) = (&arguments.picture, arguments.topic) {
        let topics = TOPICS.map(|topic| topic.comparison().name).join(", ");
        return Err(CommandError::NoTopic { picture: picture.clone(), topics });
    }
    arguments.picture.as_deref().map_or(Ok(()), Picture::check_name)?;
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
        match &arguments.picture {
            Some(picture) => {
                let panels = arguments.panels(&tradeoff)?;
                chart::tradeoff::tradeoff(&tradeoff, &panels)?.write(picture)?;
            }
            None => draw(&tradeoff, folder)?,
        }
        write!(io::stdout(), "{}", fronts(&tradeoff))?;
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

/// Writes a table into a folder.
fn keep(measured: &Tradeoff, folder: &Path) -> Result<(), CommandError> {
    let path = table_of(measured.comparison, folder);
    let written = File::create(&path).and_then(|out| measured.write(out));
    written.map_err(|source| unwritable(&path, source))
}

/// Draws all panels of a table into a folder.
fn draw(tradeoff: &Tradeoff, folder: &Path) -> Result<(), CommandError> {
    let name = tradeoff.comparison.name;
    for (word, panels) in Panels::all(tradeoff) {
        let picture = chart::tradeoff::tradeoff(tradeoff, &panels)?;
        let name = word.map_or_else(|| name.to_owned(), |word| format!("{name}-{word}"));
        picture.write(&folder.join(&name).with_extension("svg"))?;
    }
    Ok(())
}

impl Arguments {
    /// The requested panels.
    fn panels(&self, tradeoff: &Tradeoff) -> Result<Panels, CommandError> {
        let cases = tradeoff.cases();
        let columns: Vec<_> = tradeoff.comparison.errors.iter().map(|e| e.name).collect();
        let known = |asked: &[String], there: &[&str], what| match asked
            .iter()
            .find(|word| !there.contains(&word.as_str()))
        {
            Some(word) => {
                let there: Vec<_> = there.iter().map(|name| format!("`{name}`")).collect();
                Err(CommandError::NoPanel { what, word: word.clone(), there: there.join(", ") })
            }
            None => Ok(()),
        };
        known(&self.case, &cases, "case")?;
        known(&self.error, &columns, "error")?;
        let is_asked = |asked: &[String], word: &str| {
            asked.is_empty() || asked.iter().any(|asked| asked == word)
        };
        let cases = cases.into_iter().filter(|case| is_asked(&self.case, case));
        let errors = (0..columns.len()).filter(|&error| is_asked(&self.error, columns[error]));
        Ok(Panels { cases: cases.map(str::to_owned).collect(), errors: errors.collect() })
    }
}

/// The programs that render a wall, with the mean instructions of their interrupts on the emulated board
/// while a hand comes and goes.
fn interrupts() -> Result<Vec<(&'static Program, f64)>, CommandError> {
    let toolchain =
        toolchain::prepare(Tools::CompilerAndEmulator, |step| eprintln!("set-up: {step}"))?;
    let has_wall = |program: &&Program| program.scene.environment.wall().is_some();
    let walls: Vec<_> = program::ALL.iter().filter(has_wall).collect();
    let names: Vec<_> = walls.iter().map(|program| program.name).collect();
    let spinner = progress::spinner("the programs of walls");
    let files = toolchain.build_scenes(&names, NumberFormat::F32)?;
    let mean = |(program, file): (&'static Program, PathBuf)| {
        let mut controller = program.controller(NumberFormat::F32, &program.transducers)?;
        let hand = Input::Hand(Box::new(program.device()));
        let backend = Some(Backend::Emulator(&file));
        let board =
            run_with_backend(hand, controller.as_mut(), backend, DEFAULT_TICKS, || {})?.emulated();
        Ok((program, board.map_or(f64::NAN, |board| board.interrupt_instructions.mean)))
    };
    let means = walls.into_iter().zip(files).map(mean).collect();
    spinner.finish_and_clear();
    means
}

/// The methods on the fronts with their figures.
fn fronts(tradeoff: &Tradeoff) -> String {
    let comparison = tradeoff.comparison;
    let mut text = format!("{}\n", comparison.title);
    for case in tradeoff.cases() {
        for (number, error) in comparison.errors.iter().enumerate() {
            text += &format!("  {case}: {} against {}\n", comparison.cost.label, error.label);
            for method in tradeoff.front(case, number) {
                let figure = |value: Option<f64>| significant(value.unwrap_or(f64::NAN), 3);
                let (cost, error) = (figure(method.cost()), figure(method.error(number)));
                text += &format!("    {cost:>9} {error:>9}  {}\n", method.name);
            }
        }
    }
    text
}
