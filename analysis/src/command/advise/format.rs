//! `haptic advise --max-limit-cycle --rate`: the cheapest sufficient number format.

use std::f64::consts::TAU;

use clap::Args;
use haptic_servo::certificate::Resolution;
use haptic_servo::encoder::CounterWidth;
use haptic_servo::scene::{Coupling, Scene};
use haptic_servo::servo::Transducers;

use super::report::{FormatReport, message, text};
use crate::command::file_scene::{hand_trajectory, scene_file};
use crate::command::shared_arguments::JsonOption;
use crate::command::status::{CommandError, CommandStatus};
use crate::command::value_parsers::{counts, positive};
use crate::limits::at_period;
use crate::program::Program;
use crate::studies::number_format::{
    Advice, FormatProblem, HALF_A_TURN, Motion, Requirements, cost,
};
use crate::studies::tradeoff::servo::Case;
use crate::studies::tradeoff::{self, Tradeoff, ticks};

#[derive(Debug, Args)]
pub struct FormatArguments {
    /// Largest torque of a limit cycle at rest in N m, peak to peak
    #[arg(long = "max-limit-cycle", alias = "hum", value_name = "TORQUE", value_parser = positive, allow_hyphen_values = true,
          required = false, required_unless_present = "model")]
    pub hum: f64,
    /// Sample rate in Hz
    #[arg(long, value_name = "HZ", value_parser = rate, allow_hyphen_values = true,
          required = false, required_unless_present = "model")]
    pub rate: f64,
    /// Largest error in N m of the torque, compared with f64; default: no limit
    #[arg(long, value_name = "TORQUE", value_parser = positive, allow_hyphen_values = true)]
    pub error: Option<f64>,
    /// Largest share of a 170 MHz core for a tick from count to code; the rest of the interrupt is
    /// the same in every format
    #[arg(long = "cpu-share", alias = "share", value_name = "PART", value_parser = part,
          default_value_t = 0.5, allow_hyphen_values = true)]
    pub share: f64,
    /// Encoder counts per turn; default: those of the scene
    #[arg(long, value_name = "N", value_parser = counts, allow_hyphen_values = true)]
    pub counts_per_rev: Option<f64>,
    /// Coulomb friction of the device in N m; default: that of the scene
    #[arg(long, value_name = "TORQUE", value_parser = positive, allow_hyphen_values = true)]
    pub friction: Option<f64>,
    /// Largest angle in rad that a fixed-point format has to represent, to each side of zero
    #[arg(long = "max-angle", alias = "range", value_name = "ANGLE", value_parser = positive,
          default_value_t = HALF_A_TURN, allow_hyphen_values = true)]
    pub range: f64,
    /// Count the instructions of this scene on the emulated board, instead of using the kept table
    #[arg(long)]
    pub measure: bool,
}

/// Largest rate in Hz: a core of 170 MHz then has 850 cycles per tick.
const LARGEST_RATE: f64 = 200e3;
/// Finds the cheapest format. The verdict is negative if no format, or not even the encoder, satisfies the
/// requirements.
pub fn run(
    scene: &str,
    arguments: &FormatArguments,
    answer: &JsonOption,
) -> Result<CommandStatus, CommandError> {
    let query = query(scene, arguments)?;
    let scene = &query.problem.scene;
    // A scene that is rejected at this rate needs no format.
    scene.certify().map_err(|rejection| CommandError::Refused(Box::new(rejection)))?;
    let motion = query.motion()?;
    let requirements = Requirements {
        hum: arguments.hum,
        error: arguments.error,
        share: arguments.share,
        rate: arguments.rate,
    };
    let look = if arguments.measure { measured } else { kept };
    let advice = look(&motion, &requirements)?;
    let is_yes = advice.choice().is_some_and(|choice| !advice.hums(choice));
    let answered = FormatReport {
        format: advice.choice().map(|choice| choice.format),
        message: message(&query.problem, arguments.hum, &advice),
        scene: query.name,
        rate: arguments.rate,
        coupling_stiffness: match query.problem.scene.coupling {
            Coupling::Rigid | Coupling::Matched => None,
            Coupling::Spring { stiffness } => Some(stiffness),
        },
        encoder_hum: advice.encoder_hum,
        formats: advice.candidates,
    };
    answer.print(&answered, text)?;
    Ok(CommandStatus::of(is_yes))
}

/// The scene at the rate, with its sensor, its motor and a hand's trajectory.
fn query(scene: &str, arguments: &FormatArguments) -> Result<Case, CommandError> {
    let at_rate = |scene: &Scene| at_period(scene, 1.0 / arguments.rate);
    let FormatArguments { counts_per_rev: counts, range, friction, .. } = *arguments;
    Ok(match Program::find(scene) {
        Some(program) => {
            let counts_per_turn = counts.unwrap_or(program.transducers.counts_per_turn);
            let counter = CounterWidth::Bits32;
            let transducers = Transducers { counts_per_turn, counter, ..program.transducers };
            let (scene, steps) = (at_rate(&program.scene), Resolution::of(&transducers, friction));
            Case {
                name: program.name.to_owned(),
                problem: FormatProblem { scene, transducers, steps, range },
                trajectory: (program.trajectory)(),
            }
        }
        None => {
            let file = scene_file(scene)?;
            let transducers = file.transducers(counts, None);
            let said = file.steps();
            let steps = Resolution {
                encoder: counts.map(|counts| TAU / counts).or(said.encoder),
                friction: friction.or(said.friction),
                ..said
            };
            let scene = at_rate(&file.scene);
            Case {
                problem: FormatProblem { scene, transducers, steps, range },
                trajectory: hand_trajectory(&file),
                name: file.name,
            }
        }
    })
}

/// Advises with the kept instruction counts of scenes of this type.
fn kept(motion: &Motion, requirements: &Requirements) -> Result<Advice, CommandError> {
    let table = Tradeoff::kept(&ticks::COMPARISON)?;
    let environment = &motion.problem().scene.environment;
    let instructions = |arithmetic| Ok(ticks::instructions(&table, environment, arithmetic));
    Ok(Advice::new(motion, requirements, instructions)?)
}

/// Advises with the instruction counts of this scene on the emulated board.
fn measured(motion: &Motion, requirements: &Requirements) -> Result<Advice, CommandError> {
    let mut board = tradeoff::any_board()?;
    let advice = Advice::new(motion, requirements, |arithmetic| {
        Ok(cost(&mut board, motion, arithmetic)?.most.into())
    })?;
    board.finish()?;
    Ok(advice)
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = positive(text)?;
    if rate <= LARGEST_RATE {
        Ok(rate)
    } else {
        Err(format!("`{text}` must be at most {LARGEST_RATE} ticks a second"))
    }
}

fn part(text: &str) -> Result<f64, String> {
    let part = positive(text)?;
    if part <= 1.0 { Ok(part) } else { Err(format!("`{text}` must be at most 1")) }
}
