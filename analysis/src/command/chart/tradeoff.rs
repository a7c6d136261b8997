//! `haptic chart tradeoff`: speed against accuracy, measured, kept as a table and drawn.

use std::fs::File;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::chart::{self, Output};
use crate::command::{Answer, CommandError};
use crate::quantity::significant;
use crate::table::Table;
use crate::tradeoff::{Subject, Tradeoff, servo, simulation, sine};

/// Arguments of `haptic chart tradeoff`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// What is compared
    #[arg(value_enum, default_value_t)]
    pub topic: Topic,
    /// Draw the tables that are kept instead of measuring
    #[arg(long)]
    pub draw_only: bool,
    /// Folder of the tables and pictures; that of this repository's unless it is given
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
}

/// What is compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Topic {
    /// Each of the following
    #[default]
    All,
    /// Number formats of the servo: instructions against error, hum and limit cycle
    Servo,
    /// Means of computing a sweep's sine: instructions against error
    Sine,
    /// Methods of integration by their steps: time against error of the motion and of the verdict
    Simulation,
}

/// All but [`Topic::All`].
const TOPICS: [Topic; 3] = [Topic::Servo, Topic::Sine, Topic::Simulation];

impl Topic {
    fn topics(self) -> Vec<Self> {
        if self == Self::All { TOPICS.to_vec() } else { vec![self] }
    }

    fn subject(self) -> &'static Subject {
        match self {
            Self::Servo => &servo::SUBJECT,
            Self::Sine => &sine::SUBJECT,
            Self::All | Self::Simulation => &simulation::SUBJECT,
        }
    }

    fn measure(self) -> Result<Tradeoff, CommandError> {
        match self {
            Self::Servo => servo::measure(),
            Self::Sine => sine::measure(),
            Self::All | Self::Simulation => Ok(simulation::measure()?),
        }
    }
}

/// Measures, keeps and draws; says which methods are on the fronts.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("pictures/tradeoff");
    let folder = arguments.output.as_ref().unwrap_or(&kept);
    let unwritable = |path: &Path| {
        let path = path.to_owned();
        move |source| CommandError::Unwritable { path, source }
    };
    std::fs::create_dir_all(folder).map_err(unwritable(folder))?;
    for topic in arguments.topic.topics() {
        let file = |extension| folder.join(topic.subject().name).with_extension(extension);
        let table = file("csv");
        if !arguments.draw_only {
            let measured = topic.measure()?;
            let out = File::create(&table).map_err(unwritable(&table))?;
            measured.write(out).map_err(unwritable(&table))?;
        }
        let tradeoff = Tradeoff::read(topic.subject(), Table::open(&table)?)?;
        let picture = chart::tradeoff::tradeoff(&tradeoff)?;
        for extension in ["svg", "png"] {
            Output::new(&file(extension))?.write(&picture)?;
        }
        print!("{}", fronts(&tradeoff));
    }
    Ok(Answer::Yes)
}

/// The methods on the fronts with their figures.
fn fronts(tradeoff: &Tradeoff) -> String {
    let subject = tradeoff.subject;
    let mut text = format!("{}\n", subject.title);
    for case in tradeoff.cases() {
        for (number, error) in subject.errors.iter().enumerate() {
            text += &format!("  {case}: {} against {}\n", subject.cost.label, error.label);
            for method in tradeoff.front(case, number) {
                let figure = |value: Option<f64>| significant(value.unwrap_or(f64::NAN), 3);
                let (cost, error) = (figure(method.cost()), figure(method.error(number)));
                text += &format!("    {cost:>9} {error:>9}  {}\n", method.name);
            }
        }
    }
    text
}
