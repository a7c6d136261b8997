//! `haptic bench`: the cost of a certificate, a simulated step and a tick.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;
use comfy_table::Table;
use haptic_servo::certificate::Parameter;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Scene};

use super::file_program::FileProgram;
use super::shared_arguments::{DEFAULT_TICKS, JsonOption};
use super::status::{CommandError, CommandStatus};
use super::virtual_board_build::VirtualBoardBuild;
use crate::compare_run::{Backend, Input, RunOutcome, run_with_backend};
use crate::controller::{Controller, controller};
use crate::emulator::{EmulatorReport, InstructionStats};
use crate::file::{self, Format, SceneFile};
use crate::lockstep::SimulatedDevice;
use crate::program::{self, Program, damper_wall};
use crate::progress;
use crate::quantity::significant;
use crate::studies::bench::figure::{Bounds, Budget, Figure, Pair};
use crate::studies::bench::on_target::{self, live_set};
use crate::studies::bench::python::{JUDGES, PythonPeers, SIMULATOR};
use crate::studies::bench::steps::{in_c, step_time, steps_beside};
use crate::studies::bench::{self, CORE_CLOCK, Rounds};
use crate::text_table::table_of;
use crate::toolchain::{self, BoardModel, NumberFormat, Toolchain, Tools, TorqueOutput};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Print only the figures of this machine: verdicts, simulated steps, maps, compilation
    #[arg(long)]
    pub host: bool,
    /// Also measure numpy, slycot, python-control and scipy, in turns with this program; installs them from
    /// PyPI into the folder of builds
    #[arg(long)]
    pub peers: bool,
    /// Measure each time a few times only, for its order of magnitude
    #[arg(long)]
    pub quick: bool,
    #[command(flatten)]
    pub answer: JsonOption,
}

impl Arguments {
    fn rounds(&self) -> Rounds {
        if self.quick { Rounds::QUICK } else { Rounds::THOROUGH }
    }
}

/// Of a verdict on one core, with a lagging torque, and for a torque profile of 64 knots.
const VERDICT: Budget = Budget { source: "budget, one core", ..Budget::of(20.0, "us") };
const LAGGING: Budget = Budget { value: 15.0, ..VERDICT };
const PROFILE: Budget = Budget { value: 5.0, ..VERDICT };
/// Of a step of the exact simulation on one core.
const STEP: Budget = Budget { source: "budget, 100 M steps/s", ..Budget::of(10.0, "ns") };
/// Of the part of the passivity that a jitter of a hundredth of a period leaves, at least.
const JITTER: Budget = at_least(0.98, "of delta", "budget, at least");
/// Of the number of walls per second in a map.
const MAP: Budget = at_least(1e5, "1/s", "budget, a million in 10 s");
/// Of the time that a certificate may add to a compilation.
const COMPILATION: Budget = Budget::of(50.0, "ms");
/// Of a certificate on the target.
const CERTIFICATE: Budget =
    Budget { source: "budget, 20 ms at 170 MHz", ..Budget::of(3.4e6, "instructions") };
/// Of the servo's whole interrupt, including the accesses to encoder and DAC.
const INTERRUPT: Budget = Budget::of(150.0, "instructions");
/// Of the servo's share of a core.
const CORE: Budget = Budget::of(15.0, "%");
/// Ticks per second for the share of the CPU.
const TICK_RATE: f64 = 20e3;
/// Of a tick of the damper wall behind the matched coupling, in contact.
const MATCHED: Budget = Budget::of(50.0, "instructions");
/// Of an instant of a bridge's current loop, for a brushed and a brushless motor.
const INSTANTS: [(&str, Budget); 2] = [
    ("brushed", Budget::of(250.0, "instructions")),
    ("brushless", Budget::of(450.0, "instructions")),
];
/// Of what a host adds to a tick.
const BESIDE_HOST: Budget = Budget::of(40.0, "instructions");
/// A wall, and what a host may do beside it.
const WALL: &str = "name = \"wall\"\ndevice = { inertia = 2.2e-5, damping = 0.022 }\nservo = { period = 0.001 }\n\
    coupling = { stiffness = 44.0 }\n\
    environment = { type = \"damper-wall\", stiffness = 10.0, damping = 0.002, delay = 1 }\n\
    limits = { torque = 1.0, full_scale = 2.0, counts_per_turn = 61440 }\n";
const HOST: &str =
    "host = { energy = 0.05, power = 0.5, damping = 0.004, torque = 0.5, timeout = 20.0 }\n";
/// Of what a magnetic encoder adds to the servo's interrupt.
const READING: Budget = Budget::of(15.0, "instructions");
/// Of the free bytes of a motor board's flash with a wall on its bridge.
const FLASH_LEFT: Budget = at_least(40.0 * 1024.0, "bytes", "at least");

const fn at_least(value: f64, unit: &'static str, source: &'static str) -> Budget {
    Budget { value, unit, source, bounds: Bounds::AtLeast }
}

pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let figures = match arguments {
        Arguments { host: true, .. } => on_host(arguments)?,
        _ => everything(arguments)?,
    };
    arguments.answer.print(&figures, |figures| format!("{}\n", table(figures)))?;
    Ok(CommandStatus::Success)
}

/// The figures of this machine, and of the programs on the emulated board.
fn everything(arguments: &Arguments) -> Result<Vec<Figure>, CommandError> {
    let toolchain = toolchain::prepare(Tools::CompilerAndEmulator)?;
    let mut figures = on_host(arguments)?;
    let spinner = progress::spinner("building programs");
    let f32 = toolchain.build_scenes(program::NAMES, NumberFormat::F32)?;
    let fixed = toolchain.build_scenes(program::NAMES, NumberFormat::Fixed)?;
    let bare = toolchain.build_bare(program::NAMES)?;
    spinner.finish_and_clear();
    for (((program, f32), fixed), bare) in program::ALL.iter().zip(&f32).zip(&fixed).zip(&bare) {
        on_target(program, [(NumberFormat::F32, f32), (NumberFormat::Fixed, fixed)], &mut figures)?;
        live_sets(program.name, f32, &mut figures)?;
        figures.extend(memory(program, bare));
    }
    behind_matched(&toolchain, &mut figures)?;
    beside_host(&toolchain, &mut figures)?;
    about_profiles(&toolchain, &mut figures)?;
    about_bridges(&toolchain, &mut figures)?;
    figures.extend(about_encoders()?);
    Ok(figures)
}

/// What a host adds to a tick of the same wall at rest.
fn beside_host(toolchain: &Toolchain, figures: &mut Vec<Figure>) -> Result<(), CommandError> {
    let at_rest = |text: &str| {
        let file = file::parse("wall.toml", Format::Toml, text)?;
        let program = FileProgram::of(&file, "wall.toml", None, None)?;
        let elf = program.build(toolchain, None, NumberFormat::F32)?.path;
        let torque = file.host.map(|host| host.torque as f32);
        Ok::<_, CommandError>(on_target::at_rest(&elf, torque)?)
    };
    let (with, without) = (at_rest(&format!("{WALL}{HOST}"))?, at_rest(WALL)?);
    let (peers, whole) = (without.interrupt_instructions, with.interrupt_instructions);
    let changing = with.changed_instructions.unwrap_or(whole);
    let added = |with: u64, without: u64| with as f64 - without as f64;
    let name = |what| format!("host, f32: added to a tick, {what}");
    figures.extend([
        Figure::within(name("held torque"), added(whole.min, peers.min), &BESIDE_HOST),
        Figure::within(name("changing torque, most"), added(changing.max, peers.min), &BESIDE_HOST),
        Figure::alone(name("its command taken"), added(whole.max, peers.max), BESIDE_HOST.unit),
    ]);
    Ok(())
}

/// What the readings of magnetic encoders add to the servo's interrupt, which is the end of their transfer.
fn about_encoders() -> Result<Vec<Figure>, CommandError> {
    let on_virtual_board = |file: SceneFile, name: &str| {
        measured(&file, name, |program, input, servo| {
            let built =
                VirtualBoardBuild::of_file(BoardModel::NucleoG474re, program, NumberFormat::F32)?;
            let backend = Some(built.backend(file.scene.timing.period));
            Ok(run_with_backend(input, servo, backend, DEFAULT_TICKS, || {})?)
        })
    };
    let [(first, noise), ..] = bench::encoder::CHIPS;
    let counted = SceneFile { chip: None, ..bench::encoder::wall(first, noise)? };
    let counted = on_virtual_board(counted, "counted_wall.toml")?;
    let mut figures = Vec::new();
    for (chip, noise) in bench::encoder::CHIPS {
        let read = on_virtual_board(bench::encoder::wall(chip, noise)?, "magnetic_wall.toml")?;
        let name = format!("readings of {}: added to the interrupt", chip.name);
        figures.push(Figure::within(name, read.mean - counted.mean, &READING));
    }
    Ok(figures)
}

/// The instructions of the whole interrupt of a scene file's program, which runs on a board in the hand that
/// demonstrates the file.
fn measured(
    file: &SceneFile,
    name: &str,
    run: impl FnOnce(&FileProgram, Input, &mut dyn Controller) -> Result<RunOutcome, CommandError>,
) -> Result<InstructionStats, CommandError> {
    let program = FileProgram::of(file, name, None, None)?;
    let certified = file.scene.certify().map_err(|_| CommandError::of_rejected(file))?;
    let transducers = file.transducers(None, None);
    let mut servo = controller::<_, f32>(&certified, &transducers)?;
    let device = SimulatedDevice::new(&file.scene, file.demonstration(), &transducers)?;
    let outcome = run(&program, Input::Hand(Box::new(device)), servo.as_mut())?;
    let board = outcome.board.as_ref().map(|board| *board.interrupt());
    board.ok_or_else(|| CommandError::Failed("the board measured nothing".into()))
}

/// Ticks behind the matched coupling; no program has only a wall behind it.
fn behind_matched(toolchain: &Toolchain, figures: &mut Vec<Figure>) -> Result<(), CommandError> {
    let most = on_target::contact_instructions(&toolchain.build_harness("bench_programs")?)?;
    for (what, most) in ["", " and one lag"].into_iter().zip(most) {
        let name =
            format!("damper wall behind the matched coupling{what}, f32: tick, contact, most");
        figures.push(Figure::within(name, most.into(), &MATCHED));
    }
    Ok(())
}

/// Verdicts on torque profiles with more knots than those of the programs.
fn about_profiles(toolchain: &Toolchain, figures: &mut Vec<Figure>) -> Result<(), CommandError> {
    let most = on_target::verdict_instructions(&toolchain.build_harness("certify_server")?)?;
    for (what, most) in ["", " with its message"].into_iter().zip(most) {
        let name = format!("torque profile of 64 knots: verdict{what} on the target, most");
        figures.push(Figure::within(name, most as f64, &CERTIFICATE));
    }
    Ok(())
}

/// The additional work and memory of a board with its own bridge.
fn about_bridges(toolchain: &Toolchain, figures: &mut Vec<Figure>) -> Result<(), CommandError> {
    let servo = most_of_interrupts(figures);
    let most = on_target::instant_instructions(&toolchain.build_harness("bench_programs")?)?;
    for ((motor, budget), most) in INSTANTS.into_iter().zip(most.map(f64::from)) {
        let name = format!("current loop, {motor} motor");
        let instant = format!("{name}: instant, sample to compare values, most");
        figures.push(Figure::within(instant, most, &budget));
        let value = on_target::share_of_core(budget.value, INTERRUPT.value);
        let both = Budget { source: "the same of both budgets", ..Budget::of(value, "%") };
        let share = format!("{name}, at 40 kHz with a servo at 10 kHz: of 170 M instructions/s");
        figures.push(Figure::within(share, on_target::share_of_core(most, servo), &both));
    }
    let (board, name) = (BoardModel::BG431bEsc1, "bridge_wall");
    let spinner = progress::spinner("building programs");
    let built = toolchain.build_for(board, TorqueOutput::Bridge, &[name], NumberFormat::F32)?;
    spinner.finish_and_clear();
    if let Some(program) = built.first() {
        let (flash, value) = (program.sizes.flash() as f64, board.flash() as f64);
        let all = Budget { source: "the board's flash", ..Budget::of(value, "bytes") };
        figures.push(Figure::within(format!("{name}, {board}: flash"), flash, &all));
        let left = format!("{name}, {board}: flash left");
        figures.push(Figure::within(left, value - flash, &FLASH_LEFT));
    }
    Ok(())
}

/// The largest measured number of instructions of a program's whole interrupt.
fn most_of_interrupts(figures: &[Figure]) -> f64 {
    let interrupts =
        figures.iter().filter(|figure| figure.name.ends_with("f32: whole interrupt, most"));
    interrupts.map(|figure| figure.value).fold(0.0, f64::max)
}

/// Memory of a program without log, and the state of its servo.
fn memory(program: &Program, bare: &toolchain::Program) -> [Figure; 6] {
    let [float, fixed] = [NumberFormat::F32, NumberFormat::Fixed].map(program.state);
    let figures = [
        ("flash without log", bare.sizes.flash()),
        ("RAM without log", bare.sizes.ram()),
        ("state of the servo, f32", float.servo as u64),
        ("state of the servo, fixed", fixed.servo as u64),
        ("state of the environment, f32", float.environment as u64),
        ("state of the environment, fixed", fixed.environment as u64),
    ];
    figures.map(|(what, value)| {
        Figure::alone(format!("{}: {what}", program.name), value as f64, "bytes")
    })
}

fn on_host(arguments: &Arguments) -> Result<Vec<Figure>, CommandError> {
    let rounds = arguments.rounds();
    let progress = |what: &str| eprintln!("peers: {what}");
    let scenes = bench::scenes();
    let peers = arguments.peers.then(|| PythonPeers::start(&scenes, progress)).transpose()?;
    let spinner = progress::spinner("measuring this machine");
    let mut figures = beside_peers(rounds, &scenes, peers)?;
    figures.extend(lagging(rounds));
    let time = bench::verdict_time(&on_target::profiles(), rounds.own);
    let name = "verdict about a torque profile of 64 knots, median";
    figures.push(Figure::within(name, time, &PROFILE));
    let name = "verdict with [encoder], springs, walls and profiles";
    let pair = bench::encoder::verdicts(rounds.own);
    figures.push(Figure::beside(name, pair, "us", "the same without, at most 1.05"));
    figures.extend(maps(rounds));
    spinner.finish_and_clear();
    let spinner = progress::spinner("compiling certificates");
    for (name, latency) in [("", bench::AT_ONCE), (" with delay and lag", bench::LAGGING)] {
        let name = format!("certificate{name}, added to compilation");
        match compile_time(latency, rounds) {
            Ok(time) => figures.push(Figure::within(name, time, &COMPILATION)),
            Err(error) => eprintln!("{name}: not measured: {error}"),
        }
    }
    spinner.finish_and_clear();
    Ok(figures)
}

/// A verdict and a simulated step: beside their budgets, and again beside each peer of this run.
fn beside_peers(
    rounds: Rounds,
    scenes: &[Scene],
    mut peers: Option<PythonPeers>,
) -> Result<Vec<Figure>, CommandError> {
    let time = bench::verdict_time(scenes, rounds.own);
    let verdict = Figure::within("verdict, median", time, &VERDICT);
    let mut figures = vec![verdict.clone()];
    for name in JUDGES {
        if let Some(peers) = &mut peers {
            let measured = peers.verdicts(rounds.python, scenes, name);
            figures.push(verdict.again_beside(name, measured)?);
        }
    }
    let step = Figure::within("exact simulation, a step", step_time(rounds.own), &STEP);
    let in_c = in_c().and_then(|(mut peer, source)| {
        Ok((steps_beside(rounds.own, "C", &mut peer, ["values", "seconds"])?, source))
    });
    figures.extend([step.clone(), step.again_beside("C", in_c)?]);
    if let Some(peers) = &mut peers {
        figures.push(step.again_beside(SIMULATOR, peers.steps(rounds.python))?);
    }
    Ok(figures)
}

/// The cost of a verdict with a lagging torque, and the tightness of this verdict.
fn lagging(rounds: Rounds) -> [Figure; 3] {
    let time = bench::middle_verdict_time(&bench::lagging_scenes(), rounds.own);
    let at_rest = bench::at_rest::rendered_stiffness(&program::STIFFEST);
    let same = Pair { ours: at_rest, peers: bench::lagging_spring() };
    [
        Figure::within("verdict with delay and lag, degrees 0 to 8, median", time, &LAGGING),
        Figure::within(
            "certified spring at h = 0.01 T: index allowed",
            bench::spring_with_jitter(),
            &JITTER,
        ),
        Figure::beside(
            "undelayed_spring: stiffness at rest in closed loop, same latency",
            same,
            "N m/rad",
            "the certified spring",
        ),
    ]
}

/// Walls per second in a map: behind the standard coupling, and two samples late behind a coupling with `E'`
/// different from `E`.
fn maps(rounds: Rounds) -> Vec<Figure> {
    let name = "a map's walls judged, all cores";
    let scenes = [("standard coupling, delay 1", 44.0, 1), ("softer coupling, delay 2", 30.0, 2)];
    let figure = |(what, stiffness, delay): (&str, f64, usize)| {
        let environment = Wall::damped(22.0, 0.01, delay).alone();
        let coupling = Coupling::Spring { stiffness };
        let scene = Scene { coupling, environment, ..damper_wall::SCENE };
        let rate = bench::map_rate(&Scene { torque_limit: None, ..scene }, rounds.maps).ok()?;
        Some(Figure::within(format!("{name}: {what}"), rate, &MAP))
    };
    scenes.into_iter().filter_map(figure).collect()
}

/// Builds the library once and measures the time that a certified constant adds to a program that uses it.
fn compile_time(latency: &str, rounds: Rounds) -> io::Result<f64> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(&cargo)
        .current_dir(&workspace)
        .args(["build", "--package", "haptic-servo", "--lib"])
        .arg("--message-format=json")
        .output()?;
    let library = library(&output.stdout)
        .ok_or_else(|| io::Error::other(String::from_utf8_lossy(&output.stderr).into_owned()))?;
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let dependencies = library.parent().map(|folder| folder.join("deps")).unwrap_or_default();
    let rustc = Path::new(&rustc);
    bench::compile_time(rustc, &library, &dependencies, latency, rounds.compilations)
}

/// The path of the built library in cargo's messages.
fn library(messages: &[u8]) -> Option<PathBuf> {
    let messages = String::from_utf8_lossy(messages);
    let mut artifacts = messages.lines().filter_map(|line| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        (message["target"]["name"] == "haptic_servo").then_some(())?;
        let files = message["filenames"].as_array()?;
        files.iter().find_map(|file| {
            file.as_str().filter(|file| file.ends_with(".rlib")).map(PathBuf::from)
        })
    });
    artifacts.next_back()
}

fn on_target(
    program: &Program,
    builds: [(NumberFormat, &PathBuf); 2],
    figures: &mut Vec<Figure>,
) -> Result<(), CommandError> {
    let name = program.name;
    for (format, elf) in builds {
        let spinner = progress::spinner(&format!("{name} in {format}"));
        let mut controller = program.controller(format, &program.transducers)?;
        let outcome = run_with_backend(
            Input::Hand(Box::new(program.device())),
            controller.as_mut(),
            Some(Backend::Emulator(elf)),
            DEFAULT_TICKS,
            || {},
        )?;
        spinner.finish_and_clear();
        let Some(board) = outcome.emulated() else { continue };
        let groups = [("contact", board.contact_instructions), ("free", board.free_instructions)];
        for (state, stats) in groups {
            let Some(stats) = stats else { continue };
            let name = format!("{name}, {format}: tick, count to code, {state}, most");
            figures.push(Figure::alone(name, stats.max as f64, "instructions"));
        }
        let has_budget = name == "damper_wall" && format == NumberFormat::F32;
        interrupt(&format!("{name}, {format}"), &board, has_budget, figures);
        if format == NumberFormat::F32 {
            let name = format!("{name}: certificate on the target");
            figures.push(Figure::within(name, board.certify_instructions as f64, &CERTIFICATE));
        }
    }
    Ok(())
}

/// The servo's interrupt and its parts. The parts are measured separately, outside the interrupt, where the
/// compiler can share less between them.
fn interrupt(name: &str, board: &EmulatorReport, has_budget: bool, figures: &mut Vec<Figure>) {
    let whole = board.interrupt_instructions.max as f64;
    let figure =
        |what: &str, value: f64| Figure::alone(format!("{name}: {what}"), value, INTERRUPT.unit);
    let bounded = |figure: Figure| match has_budget {
        true => Figure::within(figure.name, figure.value, &INTERRUPT),
        false => figure,
    };
    let mean = board.interrupt_instructions.mean;
    figures.push(bounded(figure("whole interrupt, mean", mean)));
    figures.push(bounded(figure("whole interrupt, most", whole)));
    let parts = [
        ("of it the tick, count to code, mean", board.compute_instructions.mean),
        ("of it the energy monitor, mean", board.energy_instructions.mean),
        ("of it the frame, mean", board.frame_instructions.mean),
    ];
    let rest = parts.iter().fold(mean, |rest, (_, part)| rest - part);
    let rest = ("of it time, state, requests, registers, mean", rest);
    let around = ("lockstep around it, mean", board.lockstep_instructions.mean);
    let others = parts.into_iter().chain([rest, around]);
    figures.extend(others.map(|(what, mean)| figure(what, mean)));
    let name = format!("{name}: a 170 MHz core at 20 kHz, a cycle an instruction");
    figures.push(Figure::within(name, 100.0 * whole * TICK_RATE / CORE_CLOCK, &CORE));
}

/// Cost of a set that the board certifies, and of a refused one.
fn live_sets(name: &str, elf: &Path, figures: &mut Vec<Figure>) -> Result<(), CommandError> {
    for coupling in [LIVE_COUPLING, 2.0 * LIVE_COUPLING] {
        let set = live_set(elf, &[(Parameter::CouplingStiffness, coupling)])?;
        let name = format!("{name}: live set, {}", if set.taken { "taken" } else { "refused" });
        let below = format!("{name}, below the servo");
        figures.push(Figure::within(below, set.instructions as f64, &CERTIFICATE));
        let asked = format!("{name}, whole interrupt with its requests, most");
        figures.push(Figure::alone(asked, set.interrupt as f64, "instructions"));
        if let Some(left) = set.stack_left {
            figures.push(Figure::alone(format!("{name}, stack left"), left.into(), "bytes"));
        }
    }
    Ok(())
}

/// The standard coupling of the programs' device in N m/rad, which all of them are certified with.
const LIVE_COUPLING: f64 = 44.0;

fn table(figures: &[Figure]) -> Table {
    fn number(value: Option<f64>) -> String {
        value.map_or_else(String::new, |value| significant(value, 4))
    }
    table_of(
        figures,
        &[
            ("figure", false, |figure| figure.name.clone()),
            ("value", true, |figure| number(Some(figure.value))),
            ("unit", false, |figure| figure.unit.to_owned()),
            ("against", true, |figure| number(figure.against)),
            ("ratio", true, |figure| number(figure.ratio)),
            ("met", false, |figure| {
                figure.met.map_or("", |met| if met { "yes" } else { "MISSED" }).to_owned()
            }),
            ("against what", false, |figure| figure.source.clone()),
        ],
    )
}
