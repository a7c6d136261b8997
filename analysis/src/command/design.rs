//! `haptic design`: the largest or smallest value of a quantity that certifies.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use haptic_servo::scene::Coupling;
use serde::Serialize;

use super::shared_arguments::{JsonOption, folder, json};
use super::status::{CommandError, CommandStatus};
use crate::design::{self, Choice, Quantity, SAMPLES, Terms};
use crate::file::simulation::HandTorque;
use crate::file::{self, SceneFile, write};
use crate::quantity::significant;

/// Arguments of `haptic design`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The quantity to find.
    #[command(subcommand)]
    pub question: DesignGoal,
    /// Fraction of the device's passivity to use, above 0 and up to 1
    #[arg(long, global = true, value_name = "PART", default_value_t = 1.0, value_parser = part,
          allow_negative_numbers = true)]
    pub safety: f64,
    /// Keep the coupling of the scene instead of the standard coupling, 2 delta / T.
    /// `design device` always takes the standard coupling. Where torques lag, and where the coupling is
    /// matched, it is kept without this option
    #[arg(long, global = true)]
    pub keep_coupling: bool,
    /// Write the certified scenes into this folder instead of standard output
    #[arg(long, short, global = true, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub answer: JsonOption,
}

/// The directions of a design.
#[derive(Debug, Subcommand)]
pub enum DesignGoal {
    /// Find the largest value of one quantity that certifies on the scene's device
    Largest {
        /// Quantity to maximise
        #[arg(value_enum)]
        quantity: Quantity,
        /// Scene file
        file: String,
    },
    /// Find the lowest value of one quantity with which all these scenes certify
    Lowest {
        /// Quantity to minimise
        #[arg(value_enum)]
        quantity: Lowest,
        /// Scene files
        #[arg(required = true)]
        files: Vec<String>,
    },
    /// Find the largest value of one quantity for each value of another
    Border {
        /// Quantity to vary from 0 to its largest value
        #[arg(value_enum)]
        first: Quantity,
        /// Quantity to maximise at each value
        #[arg(value_enum)]
        second: Quantity,
        /// Scene file
        file: String,
        /// Number of values of the first quantity
        #[arg(long, default_value_t = 21, value_parser = clap::value_parser!(u32).range(2..=100_000))]
        points: u32,
    },
    /// Find the smallest device damping with which all these scenes certify, and the coupling for
    /// it
    Device {
        /// Scene files
        #[arg(required = true)]
        files: Vec<String>,
    },
    /// Find the longest period with which all these scenes certify
    Period {
        /// Scene files
        #[arg(required = true)]
        files: Vec<String>,
    },
}

/// A quantity to minimise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Lowest {
    /// Sample rate in Hz: the inverse of the longest period.
    Rate,
}

fn part(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 1.0 => Ok(value),
        _ => Err("must be a number above 0 and up to 1".to_owned()),
    }
}

/// A result as JSON.
#[derive(Serialize)]
struct Report {
    quantity: &'static str,
    unit: &'static str,
    /// The last value that certifies; null if every value certifies, or none.
    value: Option<f64>,
    limited: bool,
    possible: bool,
    /// Other changes in the scenes.
    notes: Vec<String>,
    /// The scenes that certify, as TOML.
    scenes: Vec<String>,
}

/// The sought quantity: largest or smallest, its name, its unit.
struct SoughtQuantity {
    which: &'static str,
    name: &'static str,
    unit: &'static str,
    note: Option<&'static str>,
}

/// Runs the command; the status is negative if no value passes.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let coupling = if arguments.keep_coupling { Choice::Kept } else { Choice::Standard };
    let terms = Terms { safety: arguments.safety, coupling };
    match &arguments.question {
        DesignGoal::Border { first, second, file, points } => {
            let file = file::load(file)?;
            let points = design::border(&file.scene, [*first, *second], *points as usize, &terms);
            let prepared =
                SceneFile { scene: design::prepared(&file.scene, &terms), ..file.clone() };
            for note in changed(&file, &prepared) {
                writeln!(io::stderr(), "note: {note}")?;
            }
            border(arguments, [*first, *second], &points)
        }
        DesignGoal::Largest { quantity, file } => {
            let file = arguments.load(file)?;
            let (name, unit) = quantity.name_and_unit();
            let sought = SoughtQuantity { which: "largest", name, unit, note: None };
            let whole = |scene| vec![SceneFile { scene, ..file.clone() }];
            let found = match design::largest(&file.scene, *quantity, &terms) {
                design::DesignLimit::Limit(value, scene) => {
                    design::DesignLimit::Limit(value, whole(scene))
                }
                design::DesignLimit::Unlimited(scene) => {
                    design::DesignLimit::Unlimited(whole(scene))
                }
                design::DesignLimit::Nothing => design::DesignLimit::Nothing,
                design::DesignLimit::NoSuchNumber => {
                    return Err(CommandError::NoSuchQuantity { scene: file.name, quantity: name });
                }
            };
            answer(arguments, &sought, &found, &[file])
        }
        DesignGoal::Lowest { quantity: Lowest::Rate, files } => {
            let files = arguments.load_all(files)?;
            let sought = SoughtQuantity { which: "lowest", name: "rate", unit: "Hz", note: None };
            answer(arguments, &sought, &design::rate(&files, &terms), &files)
        }
        DesignGoal::Device { files } => {
            let files = arguments.load_all(files)?;
            let unit = "N m s/rad";
            let sought = if files.iter().all(|file| file.chain.is_rigid()) {
                SoughtQuantity { which: "least", name: "device damping", unit, note: None }
            } else {
                let note = Some("only this damper of the chain was changed");
                SoughtQuantity { which: "least", name: "damping of the motor's mass", unit, note }
            };
            answer(arguments, &sought, &design::device(&files, &terms), &files)
        }
        DesignGoal::Period { files } => {
            let files = arguments.load_all(files)?;
            let sought = SoughtQuantity { which: "longest", name: "period", unit: "s", note: None };
            answer(arguments, &sought, &design::period(&files, &terms), &files)
        }
    }
}

impl Arguments {
    fn load_all(&self, files: &[String]) -> Result<Vec<SceneFile>, CommandError> {
        files.iter().map(|name| self.load(name)).collect()
    }

    /// Reads a scene file. A copy in another folder still finds its torque file.
    fn load(&self, name: &str) -> Result<SceneFile, CommandError> {
        let mut file = file::load(name)?;
        if self.output.is_some()
            && let Some(simulation) = &mut file.simulation
            && let HandTorque::File(torque) = &mut simulation.torque
        {
            *torque = std::path::absolute(folder(name).join(&*torque))?;
        }
        Ok(file)
    }
}

fn border(
    arguments: &Arguments,
    quantities: [Quantity; 2],
    points: &[(f64, f64)],
) -> Result<CommandStatus, CommandError> {
    let mut out = io::stdout().lock();
    let [first, second] = quantities.map(|quantity| quantity.name_and_unit().0);
    if arguments.answer.json {
        let column = |pick: fn(&(f64, f64)) -> f64| points.iter().map(pick).collect::<Vec<_>>();
        json(&mut out, &serde_json::json!({ first: column(|p| p.0), second: column(|p| p.1) }))?;
    } else {
        writeln!(out, "{first},{second}")?;
        for (value, limit) in points {
            writeln!(out, "{value:?},{limit:?}")?;
        }
    }
    out.flush()?;
    Ok(CommandStatus::of(!points.is_empty()))
}

impl SoughtQuantity {
    /// The result as a comment of TOML.
    fn comment(&self, found: &design::DesignLimit<Vec<SceneFile>>) -> String {
        let Self { which, name, unit, note } = self;
        let answer = match found {
            design::DesignLimit::Limit(value, _) => match (*unit, *value) {
                (SAMPLES, 1.0) => "1 sample".to_owned(),
                (SAMPLES, samples) => format!("{samples} {SAMPLES}"),
                ("", value) => value.to_string(),
                (unit, value) => last_that_certifies(value, unit),
            },
            design::DesignLimit::Unlimited(_) => "any value certifies".to_owned(),
            _ => "no value certifies".to_owned(),
        };
        let note = note.map_or_else(String::new, |note| format!("# {note}\n"));
        format!("# {which} {name}: {answer}\n{note}")
    }
}

/// Digits of a printed result.
const DIGITS: usize = 6;

/// A limit with few digits, and, if these are beyond it, the exact number.
fn last_that_certifies(value: f64, unit: &str) -> String {
    let short = significant(value, DIGITS);
    if short.parse() == Ok(value) {
        format!("{short} {unit}")
    } else {
        format!("{short} {unit} (the last number that certifies is {value:?})")
    }
}

/// A design's other changes of a scene, as text.
fn changed(file: &SceneFile, designed: &SceneFile) -> Vec<String> {
    let stiffness = |file: &SceneFile| match file.scene.coupling {
        Coupling::Rigid | Coupling::Matched => None,
        Coupling::Spring { stiffness } => Some(stiffness),
    };
    let words = |stiffness: Option<f64>| {
        stiffness
            .map_or("a rigid one".to_owned(), |k| format!("{} N m/rad", significant(k, DIGITS)))
    };
    let (before, after) = (words(stiffness(file)), words(stiffness(designed)));
    let mut notes = Vec::new();
    if before != after {
        notes.push(format!(
            "{}: the coupling is {after}, the standard 2 delta/T; the file has {before}",
            file.name
        ));
    }
    let longest = |file: &SceneFile| file.scene.timing.worst_period;
    if let (Some(before), Some(after)) = (longest(file), longest(designed))
        && before != after
    {
        let (before, after) = (significant(before, DIGITS), significant(after, DIGITS));
        notes.push(format!("{}: worst_period is {after} s; the file has {before} s", file.name));
    }
    notes
}

/// Prints the result, and the scenes as files that can be certified unchanged, with the result as a comment.
/// Several scenes go into a folder.
fn answer(
    arguments: &Arguments,
    sought: &SoughtQuantity,
    found: &design::DesignLimit<Vec<SceneFile>>,
    asked: &[SceneFile],
) -> Result<CommandStatus, CommandError> {
    let (value, files) = match found {
        design::DesignLimit::Limit(value, files) => (Some(*value), files.as_slice()),
        design::DesignLimit::Unlimited(files) => (None, files.as_slice()),
        design::DesignLimit::Nothing | design::DesignLimit::NoSuchNumber => (None, [].as_slice()),
    };
    let comment = sought.comment(found);
    let notes: Vec<Vec<String>> =
        asked.iter().zip(files).map(|(before, after)| changed(before, after)).collect();
    let remarks =
        |notes: &[String]| notes.iter().map(|note| format!("# note: {note}\n")).collect::<String>();
    let scenes: Vec<String> = files
        .iter()
        .zip(&notes)
        .map(|(file, notes)| format!("{comment}{}{}", remarks(notes), write::toml(file)))
        .collect();
    let notes = notes.concat();
    let possible = !scenes.is_empty();
    if let Some(folder) = &arguments.output {
        save(folder, &scenes)?;
    }
    let mut out = io::stdout().lock();
    if arguments.answer.json {
        let SoughtQuantity { name: quantity, unit, .. } = *sought;
        let report =
            Report { quantity, unit, value, limited: value.is_some(), possible, notes, scenes };
        json(&mut out, &report)?;
    } else if let ([scene], None) = (&scenes[..], &arguments.output) {
        write!(out, "{scene}")?;
    } else {
        write!(out, "{comment}{}", remarks(&notes))?;
        if scenes.len() > 1 && arguments.output.is_none() {
            writeln!(out, "# the {} scenes are written with --output FOLDER", scenes.len())?;
        }
    }
    out.flush()?;
    Ok(CommandStatus::of(possible))
}

/// Writes each scene as `design-1.toml` and so on.
fn save(folder: &Path, texts: &[String]) -> Result<(), CommandError> {
    std::fs::create_dir_all(folder)?;
    for (index, text) in texts.iter().enumerate() {
        std::fs::write(folder.join(format!("design-{}.toml", index + 1)), text)?;
    }
    Ok(())
}
