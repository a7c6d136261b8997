//! `haptic design`: how far may one go, and what does it take?

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use firmware::scene::Scene;
use serde::Serialize;

use super::{Answer, CommandError};
use crate::design::{self, Choice, Quantity, Terms};
use crate::file::{self, SceneFile, write};

/// Arguments of `haptic design`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// What is looked for.
    #[command(subcommand)]
    pub question: Question,
    /// Part of the device's passivity to count on, above 0 and up to 1
    #[arg(long, global = true, value_name = "PART", default_value_t = 1.0, value_parser = part,
          allow_negative_numbers = true)]
    pub safety: f64,
    /// Keep the coupling of the scene instead of the standard one, 2 delta / T
    #[arg(long, global = true)]
    pub keep_coupling: bool,
    /// Write the scenes that certify into this folder instead of standard output
    #[arg(long, short, global = true, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long, global = true)]
    pub json: bool,
}

/// The directions of a design.
#[derive(Debug, Subcommand)]
pub enum Question {
    /// The most of one quantity that may be rendered on the scene's device
    Largest {
        /// Which quantity
        #[arg(value_enum)]
        quantity: Quantity,
        /// Scene file
        file: String,
    },
    /// The most of one quantity for each value of another
    Border {
        /// Quantity that is taken from none to the most
        #[arg(value_enum)]
        first: Quantity,
        /// Quantity whose limit is asked for
        #[arg(value_enum)]
        second: Quantity,
        /// Scene file
        file: String,
        /// Number of values
        #[arg(long, default_value_t = 21, value_parser = clap::value_parser!(u32).range(2..=100_000))]
        points: u32,
    },
    /// The damping that a device needs for all these scenes, and the coupling that goes with it
    Device {
        /// Scene files
        #[arg(required = true)]
        files: Vec<String>,
    },
    /// The longest period with which all these scenes may be rendered
    Period {
        /// Scene files
        #[arg(required = true)]
        files: Vec<String>,
    },
}

fn part(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 1.0 => Ok(value),
        _ => Err("must be a number above 0 and up to 1".to_owned()),
    }
}

/// An answer as JSON.
#[derive(Serialize)]
struct Report<'r> {
    quantity: &'r str,
    unit: &'r str,
    /// The last value that certifies; null where every value does, or none.
    value: Option<f64>,
    limited: bool,
    possible: bool,
    /// The scenes that certify, as TOML.
    scenes: Vec<String>,
}

/// Answers: no where nothing passes.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let coupling = if arguments.keep_coupling { Choice::Kept } else { Choice::Standard };
    let terms = Terms { safety: arguments.safety, coupling };
    match &arguments.question {
        Question::Border { first, second, file, points } => {
            let scene = file::load(file)?.scene;
            let points = design::border(&scene, [*first, *second], *points as usize, &terms);
            border(arguments, [*first, *second], &points)
        }
        Question::Largest { quantity, file } => {
            let files = [file::load(file)?];
            let found = match design::largest(&files[0].scene, *quantity, &terms) {
                design::Answer::Limit(value, scene) => design::Answer::Limit(value, vec![scene]),
                design::Answer::Unlimited => design::Answer::Unlimited,
                design::Answer::Nothing => design::Answer::Nothing,
                design::Answer::NoSuchNumber => {
                    let (quantity, scene) = (quantity.name_and_unit().0, files[0].name.clone());
                    return Err(CommandError::NoSuchQuantity { scene, quantity });
                }
            };
            let (name, unit) = quantity.name_and_unit();
            answer(arguments, ("largest ", name, unit), &files, &found)
        }
        Question::Device { files } => {
            let (files, scenes) = load(files)?;
            let found = design::device(&scenes, &terms);
            answer(arguments, ("least ", "device damping", "N m s/rad"), &files, &found)
        }
        Question::Period { files } => {
            let (files, scenes) = load(files)?;
            let found = design::period(&scenes, &terms);
            answer(arguments, ("longest ", "period", "s"), &files, &found)
        }
    }
}

fn load(files: &[String]) -> Result<(Vec<SceneFile>, Vec<Scene>), CommandError> {
    let files = files.iter().map(|name| file::load(name)).collect::<Result<Vec<_>, _>>()?;
    let scenes = files.iter().map(|file| file.scene).collect();
    Ok((files, scenes))
}

fn border(
    arguments: &Arguments,
    quantities: [Quantity; 2],
    points: &[(f64, f64)],
) -> Result<Answer, CommandError> {
    let mut out = io::stdout().lock();
    let [first, second] = quantities.map(|quantity| quantity.name_and_unit().0);
    if arguments.json {
        let column = |pick: fn(&(f64, f64)) -> f64| points.iter().map(pick).collect::<Vec<_>>();
        let object = serde_json::json!({ first: column(|p| p.0), second: column(|p| p.1) });
        writeln!(out, "{object}")?;
    } else {
        writeln!(out, "{first},{second}")?;
        for (value, limit) in points {
            writeln!(out, "{value:?},{limit:?}")?;
        }
    }
    out.flush()?;
    Ok(if points.is_empty() { Answer::No } else { Answer::Yes })
}

/// Prints the answer, and the scenes as files that can be certified as they are: the answer is a
/// comment in them.
fn answer(
    arguments: &Arguments,
    (which, name, unit): (&str, &str, &str),
    files: &[SceneFile],
    found: &design::Answer<Vec<Scene>>,
) -> Result<Answer, CommandError> {
    let (value, scenes) = match found {
        design::Answer::Limit(value, scenes) => (Some(*value), scenes.as_slice()),
        _ => (None, [].as_slice()),
    };
    let sentence = match found {
        design::Answer::Limit(value, _) => format!("{which}{name}: {value:?} {unit}"),
        design::Answer::Unlimited => format!("{which}{name}: any value certifies"),
        _ => format!("{which}{name}: no value certifies"),
    };
    let possible = value.is_some() || *found == design::Answer::Unlimited;
    let texts: Vec<String> = files
        .iter()
        .zip(scenes)
        .map(|(file, scene)| format!("# {sentence}\n{}", write::toml(&file.name, scene)))
        .collect();
    let mut out = io::stdout().lock();
    if let Some(folder) = &arguments.output {
        save(folder, &texts)?;
    }
    if arguments.json {
        let limited = value.is_some();
        let report = Report { quantity: name, unit, value, limited, possible, scenes: texts };
        serde_json::to_writer(&mut out, &report).map_err(io::Error::from)?;
        writeln!(out)?;
    } else if arguments.output.is_some() || texts.len() != 1 {
        writeln!(out, "{sentence}")?;
    } else {
        write!(out, "{}", texts[0])?;
    }
    out.flush()?;
    Ok(if possible { Answer::Yes } else { Answer::No })
}

/// Writes each scene as `design-1.toml` and so on.
fn save(folder: &Path, texts: &[String]) -> Result<(), CommandError> {
    std::fs::create_dir_all(folder)?;
    for (index, text) in texts.iter().enumerate() {
        std::fs::write(folder.join(format!("design-{}.toml", index + 1)), text)?;
    }
    Ok(())
}
