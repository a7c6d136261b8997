//! `haptic run`: a scene, tick by tick, on the host, on the emulated board or on a virtual one.

use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use firmware::encoder::CounterWidth;
use firmware::scene::Scene;
use firmware::servo::Transducers;
use serde::Serialize;

use super::common::{ForWhom, json};
use super::identify::positive;
use super::{Answer, CommandError, demo, own};
use crate::controller::{Controller, controller};
use crate::device::Energy;
use crate::file::{self, SceneFile};
use crate::hand::Script;
use crate::program::Program;
use crate::progress;
use crate::quantity::significant;
use crate::rig::{Difference, SimulatedDevice};
use crate::scenario::{Beside, Input, Outcome, play};
use crate::toolchain::{self, Board, NoBoard, NumberFormat, Tools};
use crate::virtual_board::{VirtualBoard, VirtualBoardError};
use crate::{replay, rig, verdict};

/// Where a scene runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// On this machine.
    Host,
    /// On the emulated board, and on this machine beside it: every code is compared.
    Qemu,
    /// What is flashed to a board, on a virtual one, and on this machine beside it.
    Board(Board),
}

/// How a virtual board is named: this and the board's name.
const BOARD: &str = "board:";

/// There is no such target.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoTarget {
    /// Neither of the words.
    #[error("there is no target {0}; there are host, qemu and board:NAME, as board:nucleo-g474re")]
    Word(String),
    /// No such board.
    #[error(transparent)]
    Board(#[from] NoBoard),
}

impl FromStr for Target {
    type Err = NoTarget;

    fn from_str(text: &str) -> Result<Self, NoTarget> {
        match text {
            "host" => Ok(Self::Host),
            "qemu" => Ok(Self::Qemu),
            _ => match text.strip_prefix(BOARD) {
                Some(name) => Ok(Self::Board(Board::find(name)?)),
                None => Err(NoTarget::Word(text.into())),
            },
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Host => f.write_str("host"),
            Self::Qemu => f.write_str("qemu"),
            Self::Board(board) => write!(f, "{BOARD}{board}"),
        }
    }
}

/// Number format of the servo, as the command line names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormatArgument {
    /// Single-precision floating point.
    F32,
    /// The scene's fixed-point format; a scene file's is I8F24.
    Fixed,
}

impl From<FormatArgument> for NumberFormat {
    fn from(format: FormatArgument) -> Self {
        match format {
            FormatArgument::F32 => Self::F32,
            FormatArgument::Fixed => Self::Fixed,
        }
    }
}

/// Arguments of `haptic run`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a program in firmware/src/bin, as damper_wall; or, on the host, a scene file, whose
    /// table human holds the device, and whose table simulation is for `haptic simulate`
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Where it runs: host, qemu (the emulated board), or board:NAME, which is what would be flashed to
    /// that board (nucleo-g474re, b-g431b-esc1, stm32f405) on a virtual one
    #[arg(long, default_value_t = Target::Host)]
    pub target: Target,
    /// Recorded counts (column `count`), one a tick, in place of the simulated device
    #[arg(long, value_name = "FILE.csv")]
    pub replay: Option<PathBuf>,
    /// Encoder counts a turn; the scene's own if left out
    #[arg(long, value_name = "N", value_parser = positive,
          allow_negative_numbers = true)]
    pub counts_per_rev: Option<f64>,
    /// Motor torque in N m at the converter's largest code; the scene's own if left out
    #[arg(long, value_name = "TORQUE", value_parser = positive,
          allow_negative_numbers = true)]
    pub full_scale: Option<f64>,
    /// Number format of the servo
    #[arg(long, value_enum, default_value_t = FormatArgument::F32)]
    pub format: FormatArgument,
    /// Ticks to run; a recording ends with its last row
    #[arg(long, value_name = "N",
          value_parser = RangedU64ValueParser::<usize>::new().range(1..=MOST_TICKS))]
    pub ticks: Option<usize>,
    /// Print a row a tick: tick,count,angle,torque,code,limit; the torque is the coupling's, and the
    /// motor applies its negative
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub answer: ForWhom,
}

/// Ticks of a run that nothing else limits: the script of the hand and some time to come to rest.
pub const TICKS: usize = 5000;

/// Most ticks of a run, which keeps all of them until its end: hours at a kilohertz, and half a gigabyte.
pub const MOST_TICKS: u64 = 10_000_000;

/// Torque in N m at full scale for a scene file that has no limit of its own.
const FULL_SCALE: f64 = 5.0;

/// Counts a turn for a scene file that does not say its encoder's step.
const COUNTS_PER_TURN: f64 = 65_536.0;

/// What is to be run, whatever it came from.
struct Question {
    name: String,
    scene: Scene,
    transducers: Transducers,
    script: Script,
    controller: Box<dyn Controller>,
    /// The program for the board, where there is one.
    program: Option<&'static Program>,
}

/// The answer as JSON.
#[derive(Serialize)]
struct Summary<'a> {
    scene: &'a str,
    target: String,
    format: &'a str,
    ticks: usize,
    peak_torque: f64,
    energy: Option<Energy>,
    codes_equal: Option<usize>,
    difference: Option<Difference>,
    instructions: Option<Instructions>,
}

/// Instructions a tick on the board.
#[derive(Serialize)]
struct Instructions {
    compute_mean: f64,
    compute_max: u64,
    interrupt_mean: f64,
    interrupt_max: u64,
}

/// Runs a scene and prints what came of it. The answer is no where a code of the board differs from
/// the host's.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let counts = arguments.replay.as_deref().map(replay::load).transpose()?;
    let mut question = question(arguments)?;
    let built = build(&question, arguments)?;
    let ticks = match &counts {
        Some(counts) => arguments.ticks.map_or(counts.len(), |ticks| ticks.min(counts.len())),
        None => arguments.ticks.unwrap_or(TICKS),
    };
    let input = match &counts {
        Some(counts) => Input::Recording(counts),
        None => Input::Hand(Box::new(SimulatedDevice::new(
            question.scene.device,
            question.script.clone(),
            question.scene.timing.period,
            &question.transducers,
        )?)),
    };
    let bar = progress::bar(ticks as u64, &question.name);
    let stepper = progress::stepper(&bar);
    let outcome = play(
        input,
        question.controller.as_mut(),
        built.beside(question.scene.timing.period),
        ticks,
        stepper,
    )?;
    bar.finish_and_clear();
    print(arguments, &question, &outcome)?;
    Ok(if outcome.run.difference.is_none() { Answer::Yes } else { Answer::No })
}

fn question(arguments: &Arguments) -> Result<Question, CommandError> {
    match Program::find(&arguments.scene) {
        Some(program) => of_program(program, arguments),
        None => of_file(arguments),
    }
}

fn of_program(program: &'static Program, arguments: &Arguments) -> Result<Question, CommandError> {
    let built_for = program.transducers;
    let transducers = Transducers {
        counts_per_turn: arguments.counts_per_rev.unwrap_or(built_for.counts_per_turn),
        full_scale_torque: arguments.full_scale.unwrap_or(built_for.full_scale_torque),
        ..built_for
    };
    if arguments.target != Target::Host && transducers != built_for {
        return Err(CommandError::OtherTransducers {
            program: program.name,
            counts_per_turn: built_for.counts_per_turn,
            full_scale: built_for.full_scale_torque,
        });
    }
    let format = arguments.format.into();
    Ok(Question {
        name: program.name.to_owned(),
        scene: program.scene,
        transducers,
        script: (program.script)(),
        controller: program.controller(format, &transducers)?,
        program: Some(program),
    })
}

/// A scene file, or the sentence that there is neither such a file nor such a program.
pub(super) fn scene_file(name: &str) -> Result<SceneFile, CommandError> {
    if !name.contains(['.', '/', '\\']) && name != "-" && !std::path::Path::new(name).exists() {
        return Err(CommandError::NoScene { name: name.to_owned(), programs: own::scenes() });
    }
    Ok(file::load(name)?)
}

/// The sensor and the motor of a scene file, as it says them or as they are given.
pub(super) fn transducers_of(
    file: &SceneFile,
    counts_per_turn: Option<f64>,
    full_scale: Option<f64>,
) -> Transducers {
    let from_step = file.encoder_step.map(|step| std::f64::consts::TAU / step);
    Transducers {
        counts_per_turn: counts_per_turn.or(from_step).unwrap_or(COUNTS_PER_TURN),
        counter: CounterWidth::Bits32,
        full_scale_torque: full_scale
            .or(file.full_scale)
            .or(file.scene.torque_limit)
            .unwrap_or(FULL_SCALE),
        largest_speed: Transducers::NO_HAND_IS_FASTER,
    }
}

/// What a hand does to show a scene file: the file's own hand, if it has one.
pub(super) fn script_of(file: &SceneFile) -> Script {
    let mut script = Script::push_and_let_go();
    script.hand = file.hand.unwrap_or(script.hand);
    script
}

fn of_file(arguments: &Arguments) -> Result<Question, CommandError> {
    let file = scene_file(&arguments.scene)?;
    let certified =
        file.scene.certify().map_err(|rejection| CommandError::Refused(Box::new(rejection)))?;
    let transducers = transducers_of(&file, arguments.counts_per_rev, arguments.full_scale);
    let controller = match arguments.format {
        FormatArgument::F32 => controller::<_, f32>(&certified, &transducers)?,
        FormatArgument::Fixed => controller::<_, fixed::types::I8F24>(&certified, &transducers)?,
    };
    for note in unused(&file, arguments.replay.is_some()) {
        writeln!(io::stderr(), "note: {note}")?;
    }
    let script = script_of(&file);
    let (name, scene) = (file.name, file.scene);
    Ok(Question { name, scene, transducers, script, controller, program: None })
}

/// What a run does not use of a scene file, as sentences: the servo runs on a rigid device that a
/// hand takes through its script, or on recorded counts.
fn unused(file: &SceneFile, is_replay: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if is_replay {
        if file.hand.is_some() {
            notes.push("[human] is not used: the counts are those of the recording".to_owned());
        }
    } else if !file.chain.is_rigid() || file.chain.actuator_lag() > 0.0 {
        let rigid = "the device runs as one rigid body, with all of its inertia and damping";
        notes.push(format!("{rigid}; `haptic simulate` has its masses and its amplifier's lag"));
    }
    if file.simulation.is_some() {
        let instead = if is_replay {
            "the counts are those of the recording".to_owned()
        } else {
            format!("here {}", script_of(file).story)
        };
        notes.push(format!("[simulation] is not used: {instead}; `haptic simulate` uses it"));
    }
    notes
}

/// What was built for a run.
enum Built {
    Nothing,
    Emulated(PathBuf),
    Virtual(Flashed),
}

/// A virtual board, and what goes to its flash.
pub(super) struct Flashed {
    program: PathBuf,
    board: Board,
    elf: PathBuf,
}

impl Flashed {
    /// Builds both, after setting up what is missing for that.
    pub(super) fn build(
        board: Board,
        name: &str,
        format: NumberFormat,
    ) -> Result<Self, CommandError> {
        let tools = Tools::CompilerAndVirtualBoard;
        let toolchain = toolchain::prepare(tools, |step| eprintln!("set-up: {step}"))?;
        let spinner = progress::spinner(&format!("building {name} and the virtual board"));
        let elf = toolchain.build_for(board, &[name], format)?.swap_remove(0).path;
        let program = toolchain.build_virtual_board()?;
        spinner.finish_and_clear();
        Ok(Self { program, board, elf })
    }

    /// Switches it on.
    pub(super) fn boot(&self) -> Result<VirtualBoard, VirtualBoardError> {
        VirtualBoard::boot(&self.program, self.board, &self.elf)
    }
}

impl Built {
    fn beside(&self, period: f64) -> Option<Beside<'_>> {
        match self {
            Self::Nothing => None,
            Self::Emulated(elf) => Some(Beside::Emulator(elf)),
            Self::Virtual(Flashed { program, board, elf }) => {
                Some(Beside::VirtualBoard { program, board: *board, elf, period })
            }
        }
    }
}

fn build(question: &Question, arguments: &Arguments) -> Result<Built, CommandError> {
    if arguments.target == Target::Host {
        return Ok(Built::Nothing);
    }
    let Some(program) = question.program else {
        return Err(CommandError::FileOnBoard { scene: question.name.clone() });
    };
    let format = arguments.format.into();
    if let Target::Board(board) = arguments.target {
        return Ok(Built::Virtual(Flashed::build(board, program.name, format)?));
    }
    let toolchain =
        toolchain::prepare(Tools::CompilerAndEmulator, |step| eprintln!("set-up: {step}"))?;
    let spinner = progress::spinner(&format!("building {}", program.name));
    let elf = toolchain.build_scene(program.name, format)?;
    spinner.finish_and_clear();
    Ok(Built::Emulated(elf))
}

fn print(
    arguments: &Arguments,
    question: &Question,
    outcome: &Outcome,
) -> Result<(), CommandError> {
    let mut out = io::BufWriter::new(io::stdout().lock());
    if arguments.csv {
        csv(&mut out, &outcome.run)?;
    } else if arguments.answer.json {
        json(&mut out, &summary(arguments, &question.name, outcome))?;
    } else if let (Target::Board(_), Some(program)) = (arguments.target, question.program) {
        let report = verdict::judge(program.name, &question.scene);
        write!(out, "{}", demo::section(program, &report, outcome))?;
    } else {
        write!(out, "{}", text(outcome))?;
    }
    out.flush()?;
    if let Some(difference) = &outcome.run.difference {
        eprintln!("{difference}");
    }
    Ok(())
}

fn summary<'a>(arguments: &Arguments, name: &'a str, outcome: &Outcome) -> Summary<'a> {
    let on_board = outcome.board.is_some();
    Summary {
        scene: name,
        target: arguments.target.to_string(),
        format: NumberFormat::from(arguments.format).name(),
        ticks: outcome.run.ticks.len(),
        peak_torque: outcome.run.peak_torque(),
        energy: outcome.energy,
        codes_equal: on_board.then_some(outcome.run.equal),
        difference: outcome.run.difference,
        instructions: outcome.board.as_ref().map(|board| Instructions {
            compute_mean: board.compute().mean,
            compute_max: board.compute().max,
            interrupt_mean: board.interrupt().mean,
            interrupt_max: board.interrupt().max,
        }),
    }
}

/// The rows of a run as CSV.
pub fn csv(out: &mut impl Write, run: &rig::Run) -> Result<(), io::Error> {
    rows(out, run).map_err(|error| match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    })
}

fn rows(out: &mut impl Write, run: &rig::Run) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(["tick", "count", "angle", "torque", "code", "limit"])?;
    for (number, tick) in run.ticks.iter().enumerate() {
        writer.write_record(&[
            number.to_string(),
            tick.count.to_string(),
            tick.angle.to_string(),
            tick.torque.to_string(),
            tick.code.to_string(),
            tick.limit.to_string(),
        ])?;
    }
    Ok(writer.flush()?)
}

/// What a run gave, for a person.
pub fn text(outcome: &Outcome) -> String {
    let run = &outcome.run;
    let mut rows = vec![
        ("ticks", run.ticks.len().to_string()),
        ("peak torque", format!("{} N m", significant(run.peak_torque(), 4))),
    ];
    if let Some(energy) = outcome.energy {
        let millijoule = |joule: f64| format!("{} mJ", significant(1e3 * joule, 4));
        rows.push(("energy the hand put in", millijoule(energy.given)));
        rows.push(("energy the hand got back", millijoule(energy.got_back)));
    }
    if let Some(board) = &outcome.board {
        rows.push(("codes equal", format!("{} of {}", run.equal, run.ticks.len())));
        let (compute, whole) = (board.compute(), board.interrupt());
        rows.push((
            "instructions per tick",
            format!(
                "{} to {} from count to code, {} on average; {} on average in the whole interrupt",
                compute.min,
                compute.max,
                significant(compute.mean, 3),
                significant(whole.mean, 3)
            ),
        ));
    }
    rows.iter().map(|(label, value)| format!("{label}: {value}\n")).collect()
}
