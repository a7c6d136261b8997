//! `haptic design`: the largest or smallest value of a quantity that certifies, the stiffest wall, and the
//! numbers of a motor.

mod answer;
mod motor;
mod stiffest;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::output_file::{FileArgument, refuse_overwriting};
use super::shared_arguments::{JsonOption, folder, json, warned};
use super::status::{CommandError, CommandStatus};
use crate::design::{self, Choice, DesignLimit, Judge, Quantity, Terms, board_refusal};
use crate::file::simulation::HandTorque;
use crate::file::{self, SceneFile};
use answer::{SoughtQuantity, answer, changed};

/// Arguments of `haptic design`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The quantity to find.
    #[command(subcommand)]
    pub question: DesignGoal,
    /// Fraction of the device's passivity to use, above 0 and up to 1
    #[arg(long, global = true, value_name = "PART", default_value_t = 1.0, value_parser = part,
          allow_hyphen_values = true)]
    pub safety: f64,
    /// Keep the coupling of the scene instead of the standard coupling, 2 delta / T.
    /// `design device` always takes the standard coupling. Where torques lag, and where the coupling is
    /// matched, it is kept without this option
    #[arg(long, global = true)]
    pub keep_coupling: bool,
    /// Print the last number that certifies, with all its digits, and not the nearest of three digits
    #[arg(long, global = true)]
    pub exact: bool,
    /// Write the certified scene into this file (.toml), or several into this folder, instead of standard
    /// output; of `design stiffest` also the chart (.svg), or its numbers (.csv)
    #[arg(long, short, global = true, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub answer: JsonOption,
}

/// The directions of a design.
#[derive(Debug, Subcommand)]
pub enum DesignGoal {
    /// Find the stiffest wall at the handle that certifies on a board, over coupling, time of the output,
    /// rate and damper, and what a better device would buy
    Stiffest(stiffest::Arguments),
    /// Find the largest bandwidth, torque and speed of a motor on a board's bridge
    Motor(motor::Arguments),
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

impl DesignGoal {
    /// The scene files that it reads.
    fn files(&self) -> Vec<&str> {
        match self {
            Self::Motor(_) => vec![],
            Self::Stiffest(stiffest::Arguments { file, .. })
            | Self::Largest { file, .. }
            | Self::Border { file, .. } => vec![file],
            Self::Lowest { files, .. } | Self::Device { files } | Self::Period { files } => {
                files.iter().map(String::as_str).collect()
            }
        }
    }
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

/// Runs the command; the status is negative if no value passes.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    arguments.check_output()?;
    let terms = arguments.terms();
    match &arguments.question {
        DesignGoal::Stiffest(stiffest) => stiffest::run(arguments, stiffest),
        DesignGoal::Motor(motor) => motor::run(motor, &arguments.answer),
        DesignGoal::Border { first, second, file, points } => {
            let file = warned(file::load(file)?);
            let (wanted, points) = ([*first, *second], *points as usize);
            let of = |terms: &Terms| design::border(&file.scene, wanted, points, terms);
            let mut points = of(&Terms { exact: true, ..terms });
            if points.is_empty() && board_refusal(&file.scene).is_some_and(|it| !it.is_rejection) {
                points = of(&Terms { judge: Judge::Certificate, exact: true, ..terms });
            }
            let prepared =
                SceneFile { scene: design::prepared(&file.scene, &terms), ..file.clone() };
            for note in changed(&file, &prepared) {
                writeln!(io::stderr(), "note: {note}")?;
            }
            border(arguments, wanted, &points)
        }
        DesignGoal::Largest { quantity, file } => {
            let file = arguments.load(file)?;
            let (name, unit) = quantity.name_and_unit();
            let sought = SoughtQuantity { which: "largest", name, unit, note: None };
            let terms = Terms { full_scale: file.full_scale, ..terms };
            let whole = |scene| vec![SceneFile { scene, ..file.clone() }];
            let (found, note) = on_a_board(&terms, |terms| {
                design::largest(&file.scene, *quantity, terms).map(whole)
            });
            if matches!(found, DesignLimit::NoSuchNumber) {
                return Err(CommandError::NoSuchQuantity { scene: file.name, quantity: name });
            }
            answer(arguments, &sought, &found, &[file], note)
        }
        DesignGoal::Lowest { quantity: Lowest::Rate, files } => {
            let files = arguments.load_all(files)?;
            let sought = SoughtQuantity { which: "lowest", name: "rate", unit: "Hz", note: None };
            let (found, note) = on_a_board(&terms, |terms| design::rate(&files, terms));
            answer(arguments, &sought, &found, &files, note)
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
            let (found, note) = on_a_board(&terms, |terms| design::device(&files, terms));
            answer(arguments, &sought, &found, &files, note)
        }
        DesignGoal::Period { files } => {
            let files = arguments.load_all(files)?;
            let sought = SoughtQuantity { which: "longest", name: "period", unit: "s", note: None };
            let (found, note) = on_a_board(&terms, |terms| design::period(&files, terms));
            answer(arguments, &sought, &found, &files, note)
        }
    }
}

/// The answer of a design on a board. None certifies with a motor that the board's own bridge does not drive. Where
/// nothing passes on one, the reason comes with it; if no board has the times of such a scene, or the scene states no
/// limits of a board, the answer is that of the certificate alone.
fn on_a_board(
    terms: &Terms,
    design: impl Fn(&Terms) -> DesignLimit<Vec<SceneFile>>,
) -> (DesignLimit<Vec<SceneFile>>, Option<String>) {
    let found = design(terms);
    let files = found.value_and_result().1.map_or([].as_slice(), Vec::as_slice);
    if let Some(why) = files.iter().find_map(|file| file.own_bridge().err()) {
        return (DesignLimit::Nothing, Some(format!("no board renders it: {why}")));
    }
    let is_zero = matches!(found, DesignLimit::Limit(0.0, _));
    if !(is_zero || matches!(found, DesignLimit::Nothing)) {
        return (found, None);
    }
    let alone = design(&Terms { judge: Judge::Certificate, ..*terms });
    let files = alone.value_and_result().1.map_or([].as_slice(), Vec::as_slice);
    let Some(refusal) = files.iter().find_map(|file| board_refusal(&file.scene)) else {
        return (found, None);
    };
    let has_limits = |file: &SceneFile| {
        file.scene.torque_limit.or(file.encoder_step).or(file.full_scale).is_some()
    };
    let is_for_a_board = refusal.is_rejection && files.iter().any(has_limits);
    let more = if is_zero { " with more" } else { "" };
    let note = format!("no board renders it{more}: {}", refusal.sentence);
    (if is_zero || is_for_a_board { found } else { alone }, Some(note))
}

impl Arguments {
    fn terms(&self) -> Terms {
        let coupling = if self.keep_coupling { Choice::Kept } else { Choice::Standard };
        let Self { safety, exact, .. } = *self;
        Terms { safety, coupling, judge: Judge::BOARD, exact, full_scale: None }
    }

    /// Refuses to overwrite a scene or the device file that it names.
    fn check_output(&self) -> Result<(), CommandError> {
        let scenes: Vec<_> =
            self.question.files().into_iter().filter(|file| *file != "-").collect();
        let devices: Vec<_> =
            scenes.iter().filter_map(|scene| file::device_file_of(scene)).collect();
        let scenes = scenes.iter().map(|scene| FileArgument::of("FILE", Some(Path::new(*scene))));
        let devices =
            devices.iter().map(|device| FileArgument::of("the `device` of FILE", Some(device)));
        let inputs: Vec<_> = scenes.chain(devices).collect();
        refuse_overwriting(&inputs, &[FileArgument::of("-o", self.output.as_deref())])
    }

    fn load_all(&self, files: &[String]) -> Result<Vec<SceneFile>, CommandError> {
        files.iter().map(|name| self.load(name)).collect()
    }

    /// Reads a scene file. A copy in another folder still finds its torque file.
    fn load(&self, name: &str) -> Result<SceneFile, CommandError> {
        let mut file = warned(file::load(name)?);
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
