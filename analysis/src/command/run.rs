//! `haptic run`: runs a scene tick by tick on the host, on the emulated board or on a virtual board.

use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use clap::builder::RangedU64ValueParser;
use haptic_model::host::{HostLaw, HostRun, HostTick};
use haptic_servo::host::HostTorque;
use haptic_servo::number::{Format, Number};
use haptic_servo::scene::Scene;
use haptic_servo::servo::{OutputTiming, Transducers};
use serde::Serialize;

use super::building::{emulated, set_up};
use super::file_program::{FileProgram, dropped_refused};
use super::file_scene::{hand_trajectory, scene_file};
use super::outcome::{section, text};
use super::shared_arguments::{DEFAULT_TICKS, JsonOption, MAX_TICKS, json};
use super::status::{CommandError, CommandStatus};
use super::value_parsers::{counts, positive};
use super::virtual_board_build::VirtualBoardBuild;
use crate::bridge_run::{ShaftInput, run_on_bridge};
use crate::chart::budget::BudgetRuns;
use crate::compare_run::{Backend, Input, RunError, RunOutcome, run_with_backend, status};
use crate::controller::{Controller, controller};
use crate::counts_csv;
use crate::device::Energy;
use crate::disturbance::Disturbance;
use crate::file::SceneFile;
use crate::hand::HandTrajectory;
use crate::host_run::BesideHost;
use crate::lockstep::{Difference, SimulatedDevice};
use crate::missed::Missed;
use crate::program::Program;
use crate::progress;
use crate::shaft::{HandHeldShaft, RecordedShaft};
use crate::simulation::SimulationError;
use crate::tick_gaps::TickGaps;
use crate::toolchain::{BoardModel, NumberFormat, Tools};
use crate::verdict::{self, Verdict, VerdictReport, judge_file};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// On this machine.
    Host,
    /// On the emulated board and on this machine: every code is compared.
    Qemu,
    /// The flashed program on a virtual board, and on this machine.
    Board(BoardModel),
}

/// The prefix of a virtual board's name.
const BOARD: &str = "board:";

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "host" => Ok(Self::Host),
            "qemu" => Ok(Self::Qemu),
            _ => match text.strip_prefix(BOARD).map(BoardModel::find) {
                Some(board) => board.map(Self::Board).map_err(|unknown| unknown.to_string()),
                None => Err(format!(
                    "there is no target {text}; there are host, qemu and board:NAME, as \
                     board:nucleo-g474re"
                )),
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

#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of a program in firmware/src/bin, for example damper_wall, or a scene file. Its table `human` is
    /// the hand; of its table `simulation` a run reads `dropped`
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Target: host, qemu (the emulated board), or board:NAME (the program as flashed, on a virtual
    /// board: nucleo-g474re, b-g431b-esc1, feather-stm32f405; with a motor, aligned and armed, where the program
    /// is for the board's own bridge)
    #[arg(long, default_value_t = Target::Host)]
    pub target: Target,
    /// Replay recorded counts, one for each tick (column `count`), instead of simulating the device. Ticks
    /// that are missing by the column `tick` or `time` are counted and named
    #[arg(long, value_name = "FILE.csv")]
    pub replay: Option<PathBuf>,
    /// Encoder counts per turn; default: those of the scene
    #[arg(long, value_name = "N", value_parser = counts,
          allow_hyphen_values = true)]
    pub counts_per_rev: Option<f64>,
    /// Motor torque in N m at the largest code of the DAC; default: that of the scene
    #[arg(long, value_name = "TORQUE", value_parser = positive,
          allow_hyphen_values = true)]
    pub full_scale: Option<f64>,
    /// Number format of the servo
    #[arg(long, value_enum, default_value_t = NumberFormat::F32)]
    pub format: NumberFormat,
    /// Number of ticks; default: 5000, or those of 5 s; a recording ends with its last row
    #[arg(long, value_name = "N",
          value_parser = RangedU64ValueParser::<usize>::new().range(1..=MAX_TICKS))]
    pub ticks: Option<usize>,
    /// Add the torques of a host that wants energy, within the budget of the scene: pump, noise, late-spring,
    /// square
    #[arg(long, value_name = "LAW", conflicts_with = "replay")]
    pub host: Option<HostLaw>,
    /// Print one row for each tick: tick,count,angle,torque,code,limit. The torque is the coupling
    /// torque; the motor applies its negative. With --host also wanted,given (N m), level,taken,budget (J)
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    #[command(flatten)]
    pub answer: JsonOption,
}

/// Set-up of a run, from a program or from a scene file.
struct RunSetup {
    name: String,
    report: VerdictReport,
    scene: Scene,
    transducers: Transducers,
    trajectory: HandTrajectory,
    /// Friction and cogging of the simulated motor.
    disturbance: Disturbance,
    /// Readings of the encoder that fail.
    dropped: Missed,
    controller: Box<dyn Controller>,
    program: RunProgram,
    /// What a host may do.
    budget: Option<HostTorque>,
    /// Whether the supply of a board's own bridge takes no energy back.
    stores: bool,
}

/// The program for a board.
enum RunProgram {
    Named(&'static Program),
    /// Of a scene file, if it runs on a board.
    OfFile(Option<FileProgram>),
}

#[derive(Serialize)]
struct Summary<'a> {
    scene: &'a str,
    verdict: Verdict,
    on_board: Option<Verdict>,
    target: String,
    format: &'a str,
    ticks: usize,
    /// Ticks that a replayed recording lacks; `None` where it has neither ticks nor times.
    replay_gaps: Option<TickGaps>,
    peak_torque: f64,
    energy: Option<Energy>,
    codes_equal: Option<usize>,
    difference: Option<Difference>,
    instructions: Option<Instructions>,
    #[serde(skip_serializing_if = "Option::is_none")]
    host: Option<HostSummary>,
}

/// What a host wanted, and what the hand took.
#[derive(Serialize)]
struct HostSummary {
    law: &'static str,
    /// Part of the wanted torque that was refused, and the ticks in which some was.
    refused: f64,
    limited_ticks: usize,
    /// The largest part of the budget that was taken, and the time in s of that.
    most_of_budget: f64,
    most_at: f64,
    /// Time in s, energy taken in J, budget in J.
    over_time: Vec<[f64; 3]>,
}

#[derive(Serialize)]
struct Instructions {
    compute_mean: Option<f64>,
    compute_max: Option<u64>,
    interrupt_mean: f64,
    interrupt_max: u64,
}

/// Runs a scene and prints the result. The status is negative if a board rejects the scene, though it is certified
/// alone, or if a code of the board differs from the host's.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let mut setup = setup(arguments)?;
    let period = setup.scene.timing.period;
    let recording = arguments.replay.as_deref().map(|path| counts_csv::load(path, period));
    let recording = recording.transpose()?;
    let gaps = recording.as_ref().and_then(|recording| recording.gaps);
    if let Some(gaps) = gaps.filter(|gaps| !gaps.is_none()) {
        writeln!(
            io::stderr(),
            "note: {gaps}; the replay plays the rows as successive ticks, so the motion jumps there"
        )?;
    }
    let counts = recording.map(|recording| recording.counts);
    if let Some(law) = arguments.host {
        // Refused before anything is built.
        let host = setup.host((law, true), arguments.format)?;
        host.servo(setup.controller.as_mut(), OutputTiming::Simultaneous)?;
    }
    let ticks = match &counts {
        Some(counts) => arguments.ticks.map_or(counts.len(), |ticks| ticks.min(counts.len())),
        None => arguments.ticks.unwrap_or_else(|| ticks_of_hand(period)),
    };
    if counts.is_none() {
        setup.check_dropped(arguments, ticks)?;
    }
    let built = build(&setup, arguments)?;
    let bar = progress::bar(ticks as u64, &setup.name);
    let stepper = progress::stepper(&bar);
    let outcome = match arguments.host {
        Some(law) => ran_beside_host(&mut setup, arguments, (law, true), &built, ticks, stepper)?,
        None => ran(&mut setup, &built, counts.as_deref(), ticks, stepper)?,
    };
    bar.finish_and_clear();
    print(arguments, &setup, &outcome, gaps)?;
    Ok(CommandStatus::of(setup.report.passes() && outcome.run.difference.is_none()))
}

/// As many ticks as a hand's trajectory takes, and as a program's demonstration has at least; a run keeps all.
fn ticks_of_hand(period: f64) -> usize {
    const LENGTH: f64 = 5.0;
    const MOST: usize = 1_000_000;
    ((LENGTH / period).ceil() as usize).clamp(DEFAULT_TICKS, MOST)
}

/// Runs it: with a hand, or with recorded counts.
fn ran(
    setup: &mut RunSetup,
    built: &Built,
    counts: Option<&[i32]>,
    ticks: usize,
    progress: impl FnMut(),
) -> Result<RunOutcome, CommandError> {
    let RunSetup { scene, transducers, trajectory, disturbance, dropped, .. } = setup;
    let controller = setup.controller.as_mut();
    if let Built::Virtual(flashed) = built
        && let Some((board, current_loop)) = flashed.boot_bridge()?
    {
        let input = match counts {
            Some(counts) => {
                ShaftInput::Recording(RecordedShaft::new(counts, transducers, current_loop))
            }
            None => {
                let hand = trajectory.clone();
                let shaft = HandHeldShaft::new(scene, hand, transducers, current_loop)?;
                let shaft = shaft.with_disturbance(*disturbance).failing(*dropped);
                ShaftInput::Hand(Box::new(shaft))
            }
        };
        let outcome = run_on_bridge(input, controller, board, scene, ticks, progress);
        return Ok(outcome.map_err(RunError::from)?);
    }
    let input = match counts {
        Some(counts) => Input::Recording(counts),
        None => {
            let device = SimulatedDevice::new(scene, trajectory.clone(), transducers)?;
            let device = device.with_disturbance(*disturbance).failing(*dropped);
            Input::Hand(Box::new(device))
        }
    };
    let backend = built.backend(scene.timing.period);
    Ok(run_with_backend(input, controller, backend, ticks, progress)?)
}

/// Runs a scene with a host and its tank, and without the tank; the scene's name comes with the runs.
pub fn beside_host(scene: &str, law: HostLaw) -> Result<(String, BudgetRuns), CommandError> {
    let arguments = Arguments {
        scene: scene.to_owned(),
        target: Target::Host,
        replay: None,
        counts_per_rev: None,
        full_scale: None,
        format: NumberFormat::F32,
        ticks: None,
        host: Some(law),
        csv: false,
        answer: JsonOption { json: false },
    };
    let file = match Program::find(scene) {
        Some(_) => None,
        None => Some(scene_file(scene)?),
    };
    let fresh = || match file.clone() {
        Some(file) => of_file(file, &arguments),
        None => setup(&arguments),
    };
    let run = |has_tank| {
        let mut setup = fresh()?;
        let ticks = ticks_of_hand(setup.scene.timing.period);
        let law = (law, has_tank);
        ran_beside_host(&mut setup, &arguments, law, &Built::Nothing, ticks, || {})
    };
    let runs = [run(true)?, run(false)?];
    let RunSetup { name, trajectory, .. } = fresh()?;
    Ok((name, BudgetRuns { runs, hand: trajectory }))
}

/// Runs it in a hand with a host beside it, and its tank or none.
fn ran_beside_host(
    setup: &mut RunSetup,
    arguments: &Arguments,
    law: (HostLaw, bool),
    built: &Built,
    ticks: usize,
    progress: impl FnMut(),
) -> Result<RunOutcome, CommandError> {
    let beside = setup.host(law, arguments.format)?;
    let RunSetup { scene, transducers, trajectory, disturbance, .. } = setup;
    let controller = setup.controller.as_mut();
    if let Built::Virtual(flashed) = built
        && let Some((board, current_loop)) = flashed.boot_bridge()?
    {
        let shaft = HandHeldShaft::new(scene, trajectory.clone(), transducers, current_loop)?;
        let shaft = shaft.with_disturbance(*disturbance);
        return Ok(beside.run_on_bridge(board, controller, shaft, ticks, progress)?);
    }
    let device = SimulatedDevice::new(scene, trajectory.clone(), transducers)?;
    let device = device.with_disturbance(*disturbance);
    Ok(match built.backend(beside.scene.timing.period) {
        None => beside.run(controller, device, ticks, progress).map_err(RunError::from)?,
        Some(backend) => beside.run_on(backend, controller, device, ticks, progress)?,
    })
}

impl RunSetup {
    /// Refuses readings that fail more often than the scene allows, or where the board has none that fail as on the
    /// host. Beside a host the certificate allows none.
    fn check_dropped(&self, arguments: &Arguments, ticks: usize) -> Result<(), CommandError> {
        let Scene { timing, latency, .. } = &self.scene;
        let allowed = latency.encoder.dropped;
        let leaves_out = latency.encoder.leaves_out(timing.period, timing.worst_period);
        if let Some(sample) = self.dropped.fault(allowed, ticks) {
            let time = sample as f64 * timing.period;
            return Err(SimulationError::Readings { sample, time, allowed }.into());
        }
        match (&self.program, arguments.target) {
            (RunProgram::OfFile(Some(program)), Target::Board(_))
                if self.dropped != Missed::None =>
            {
                program.check_dropped(leaves_out || program.bridge.is_some())?;
                if leaves_out {
                    let why = "this scene leaves such ticks out, and a run compares the code of each tick";
                    return Err(dropped_refused(why));
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The host beside the scene, with its tank or without.
    fn host(
        &self,
        (law, has_tank): (HostLaw, bool),
        format: NumberFormat,
    ) -> Result<BesideHost, CommandError> {
        let Some(budget) = self.budget else {
            return Err(CommandError::NoHost { scene: self.name.clone() });
        };
        if self.report.verdict != Verdict::Certified {
            return Err(CommandError::FileRefused { why: self.report.message.clone() });
        }
        let format = match format {
            NumberFormat::F32 => Format::F32,
            NumberFormat::Fixed => <fixed::types::I8F24 as Number>::FORMAT,
        };
        let &Self { scene, transducers, stores, .. } = self;
        Ok(BesideHost { scene, transducers, budget, law, has_tank, format, stores })
    }
}

fn setup(arguments: &Arguments) -> Result<RunSetup, CommandError> {
    match Program::find(&arguments.scene) {
        Some(program) => of_program(program, arguments),
        None => {
            let file = scene_file(&arguments.scene)?;
            let setup = of_file(file.clone(), arguments)?;
            for note in unused(&file, arguments) {
                writeln!(io::stderr(), "note: {note}")?;
            }
            Ok(setup)
        }
    }
}

fn of_program(program: &'static Program, arguments: &Arguments) -> Result<RunSetup, CommandError> {
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
    let format = arguments.format;
    Ok(RunSetup {
        name: program.name.to_owned(),
        report: verdict::judge(program.name, &program.scene),
        scene: program.scene,
        transducers,
        trajectory: (program.trajectory)(),
        disturbance: Disturbance::default(),
        dropped: Missed::None,
        controller: program.controller(format, &transducers)?,
        program: RunProgram::Named(program),
        budget: program.host,
        stores: program.bridge.as_ref().is_some_and(|bridge| bridge.bus().is_some()),
    })
}

fn of_file(file: SceneFile, arguments: &Arguments) -> Result<RunSetup, CommandError> {
    let certified = file.scene.certify().map_err(|_| CommandError::of_rejected(&file))?;
    let (counts, full_scale) = (arguments.counts_per_rev, arguments.full_scale);
    let is_on_board = arguments.target != Target::Host;
    let program = is_on_board
        .then(|| FileProgram::of(&file, &arguments.scene, counts, full_scale))
        .transpose()?;
    let transducers = file.transducers(counts, full_scale);
    let controller = match arguments.format {
        NumberFormat::F32 => controller::<_, f32>(&certified, &transducers)?,
        NumberFormat::Fixed => controller::<_, fixed::types::I8F24>(&certified, &transducers)?,
    };
    let (report, trajectory) = (judge_file(&file, Format::F64), hand_trajectory(&file));
    let disturbance = file.disturbance();
    let dropped = file.dropped();
    let stores = file.supply.is_some_and(|supply| supply.stores());
    let (scene, budget) = (file.scene, file.host);
    let program = RunProgram::OfFile(program);
    Ok(RunSetup {
        name: file.name,
        report,
        scene,
        transducers,
        trajectory,
        disturbance,
        dropped,
        controller,
        program,
        budget,
        stores,
    })
}

/// The parts of a scene file that a run does not use, as text: the servo runs on a rigid device in a hand's
/// trajectory, with the currents of a bridge's motor, or on recorded counts.
fn unused(file: &SceneFile, arguments: &Arguments) -> Vec<String> {
    let (mut notes, is_replay) = (Vec::new(), arguments.replay.is_some());
    if is_replay {
        if file.hand.is_some() {
            notes.push("[human] is not used: the counts are those of the recording".to_owned());
        }
    } else if !file.chain.is_rigid() {
        let rigid = "the device runs as one rigid body, with all of its inertia and damping";
        notes.push(format!("{rigid}; `haptic simulate` includes its masses"));
    }
    if file.simulation.is_some() {
        let instead = if is_replay {
            "the counts are those of the recording".to_owned()
        } else {
            format!("here {}", hand_trajectory(file).description)
        };
        let drops = !is_replay && file.dropped() != Missed::None;
        let but = if drops { " but for `dropped`" } else { "" };
        notes.push(format!("[simulation]{but} is not used: {instead}; `haptic simulate` uses it"));
    }
    let encoder = file.scene.latency.encoder;
    let misreads = is_replay && (!encoder.is_ideal() || encoder.steps() > 1.0);
    if file.host.is_some() && arguments.host.is_none() {
        notes.push("[host] is not used without --host; `haptic simulate` uses it".to_owned());
    }
    if misreads {
        notes.push("[encoder] is not used; `haptic simulate` uses it".to_owned());
    }
    notes
}

/// Programs built for a run.
enum Built {
    Nothing,
    Emulated(PathBuf),
    Virtual(VirtualBoardBuild),
}

impl Built {
    fn backend(&self, period: f64) -> Option<Backend<'_>> {
        match self {
            Self::Nothing => None,
            Self::Emulated(elf) => Some(Backend::Emulator(elf)),
            Self::Virtual(flashed) => Some(flashed.backend(period)),
        }
    }
}

fn build(setup: &RunSetup, arguments: &Arguments) -> Result<Built, CommandError> {
    let format = arguments.format;
    Ok(match (arguments.target, &setup.program) {
        (Target::Host, _) | (_, RunProgram::OfFile(None)) => Built::Nothing,
        (Target::Board(board), RunProgram::Named(program)) => {
            Built::Virtual(VirtualBoardBuild::build(board, program, format)?)
        }
        (Target::Board(board), RunProgram::OfFile(Some(file))) => {
            Built::Virtual(VirtualBoardBuild::of_file(board, file, format)?)
        }
        (Target::Qemu, RunProgram::Named(program)) => {
            Built::Emulated(emulated(program.name, format)?)
        }
        (Target::Qemu, RunProgram::OfFile(Some(file))) => {
            let toolchain = set_up(Tools::CompilerAndEmulator)?;
            Built::Emulated(file.build(&toolchain, None, format)?.path)
        }
    })
}

fn print(
    arguments: &Arguments,
    setup: &RunSetup,
    outcome: &RunOutcome,
    gaps: Option<TickGaps>,
) -> Result<(), CommandError> {
    let mut out = io::BufWriter::new(io::stdout().lock());
    if arguments.csv {
        rows(&mut out, outcome)?;
    } else if arguments.answer.json {
        json(&mut out, &summary(arguments, setup, outcome, gaps))?;
    } else if let (Target::Board(_), &RunProgram::Named(program)) =
        (arguments.target, &setup.program)
    {
        write!(out, "{}", section(program, &setup.report, outcome))?;
    } else {
        let VerdictReport { summary, .. } = &setup.report;
        write!(out, "verdict: {}, {summary}\n{}", setup.report.verdict_in_words(), text(outcome))?;
    }
    out.flush()?;
    if let Some(difference) = &outcome.run.difference {
        eprintln!("{difference}");
    }
    Ok(())
}

fn summary<'a>(
    arguments: &Arguments,
    setup: &'a RunSetup,
    outcome: &RunOutcome,
    gaps: Option<TickGaps>,
) -> Summary<'a> {
    let on_board = outcome.board.is_some();
    Summary {
        scene: &setup.name,
        verdict: setup.report.verdict,
        on_board: setup.report.on_board,
        target: arguments.target.to_string(),
        format: arguments.format.as_str(),
        ticks: outcome.run.ticks.len(),
        replay_gaps: gaps,
        peak_torque: outcome.run.peak_torque(),
        energy: outcome.energy,
        codes_equal: on_board.then_some(outcome.run.equal),
        difference: outcome.run.difference,
        instructions: outcome.board.as_ref().map(|board| Instructions {
            compute_mean: board.compute().map(|compute| compute.mean),
            compute_max: board.compute().map(|compute| compute.max),
            interrupt_mean: board.interrupt().mean,
            interrupt_max: board.interrupt().max,
        }),
        host: outcome.host.as_ref().map(host_summary),
    }
}

fn host_summary(host: &HostRun) -> HostSummary {
    let ((refused, limited_ticks), (most_of_budget, most_at)) = (host.refused(), host.most());
    let row = |tick| [host.time(tick), host.taken[tick], host.budget_at(tick)];
    let over_time = host.rows().map(row).collect();
    let law = host.law.as_str();
    HostSummary { law, refused, limited_ticks, most_of_budget, most_at, over_time }
}

/// The rows of a run as CSV.
fn rows(out: &mut impl Write, outcome: &RunOutcome) -> Result<(), CommandError> {
    let mut writer = csv::Writer::from_writer(out);
    let host = outcome.host.as_ref();
    let header = ["tick", "count", "angle", "torque", "code", "limit"];
    let of_host = host.map_or(&[][..], |_| &["wanted", "given", "level", "taken", "budget"]);
    writer.write_record(header.iter().chain(of_host))?;
    for (number, tick) in outcome.run.ticks.iter().enumerate() {
        let mut row = vec![
            number.to_string(),
            tick.count.to_string(),
            tick.angle.to_string(),
            tick.torque.to_string(),
            tick.code.to_string(),
            status(tick).as_str().to_owned(),
        ];
        if let Some(host) = host {
            let HostTick { wanted, given, level } = host.ticks[number];
            let (taken, budget) = (host.taken[number], host.budget_at(number));
            row.extend([wanted, given, level, taken, budget].map(|number| number.to_string()));
        }
        writer.write_record(&row)?;
    }
    Ok(writer.flush()?)
}
