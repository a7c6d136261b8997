//! The program's commands, one module each.

pub mod advise;
pub mod bench;
pub mod certify;
pub mod chart;
pub mod common;
pub mod demo;
pub mod design;
pub mod device;
pub mod failures;
pub mod flash;
pub mod identify;
pub mod new;
mod own;
pub mod report;
pub mod run;
pub mod schema;
pub mod scope;
pub mod simulate;
pub mod stability;
pub mod tune;
pub mod twin;
pub mod worst_hand;

use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use firmware::certificate::Rejection;
use thiserror::Error;

use crate::chart::ChartError;
use crate::emulator::EmulatorError;
use crate::file::FileError;
use crate::identify::IdentifyError;
use crate::identify::port::PortError;
use crate::link::{Address, LinkError};
use crate::quantity::significant;
use crate::recorded::RecordedError;
use crate::scenario::ScenarioError;
use crate::simulation::SimulationError;
use crate::table::TableError;
use crate::terminal;
use crate::toolchain::{BuildError, SetupError};
use crate::twin::TwinError;
use crate::virtual_board::VirtualBoardError;

/// Certifies haptic scenes, runs them, and shows what they do.
#[derive(Debug, Parser)]
#[command(name = "haptic", version)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What every help ends with.
const EXIT_STATUS: &str = "\
Exit status: 0 success; 1 negative verdict: rejected, undecided, unstable, different, or not possible; \
2 invalid input or failure";

impl Arguments {
    /// Those that the program was started with; says what is wrong with them, and ends it.
    pub fn of_program() -> Self {
        // One rule for all output: clap's own one colours a terminal without colours where `CI` is set.
        let colour = match terminal::has_colour(io::stdout().is_terminal()) {
            true => clap::ColorChoice::Always,
            false => clap::ColorChoice::Never,
        };
        let matches = with_exit_status(Self::command()).color(colour).try_get_matches();
        let found = matches.and_then(|matches| Self::from_arg_matches(&matches));
        found.unwrap_or_else(|error| refuse(&error))
    }
}

/// Ends the program with a help that was asked for, or with what is wrong with its arguments, which
/// clap does not break into lines.
fn refuse(error: &clap::Error) -> ! {
    let rendered = error.render();
    let text = |is_terminal| match terminal::has_colour(is_terminal) {
        true => rendered.ansi().to_string(),
        false => rendered.to_string(),
    };
    if !error.use_stderr() {
        let text = text(io::stdout().is_terminal());
        let said = io::stdout().write_all(text.as_bytes()).map(|()| Answer::Yes);
        std::process::exit(status(said.map_err(CommandError::Output)).into());
    }
    let text = text(io::stderr().is_terminal());
    // Nobody is left to be told if this fails.
    let _ = write!(io::stderr(), "{}", terminal::wrapped(&text, terminal::error_width(), 2));
    std::process::exit(error.exit_code())
}

fn with_exit_status(command: clap::Command) -> clap::Command {
    let after = match command.get_after_help() {
        Some(own) => format!("{own}\n\n{EXIT_STATUS}"),
        None => EXIT_STATUS.to_owned(),
    };
    command.after_help(after).mut_subcommands(with_exit_status)
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Is a scene safe in every hand, and by how much?
    Certify(certify::Arguments),
    /// How much passivity does a device have, rigid or a chain of masses?
    Device(device::Arguments),
    /// What are inertia, damping and passivity of a device that was measured?
    Identify(identify::Arguments),
    /// Begin a scene of your own, as a copy of another one.
    New(new::Arguments),
    /// Build a scene's program for a board and flash it.
    Flash(flash::Arguments),
    /// Run a scene tick by tick: on this machine, on the emulated board, or as flashed on a virtual one.
    Run(run::Arguments),
    /// Set up, build, certify and run all scenes on the emulated board, and draw what they did.
    Demo(demo::Arguments),
    /// Draw scenes: Nyquist curves, maps, limits, traces.
    Chart(chart::Arguments),
    /// Write one page about a scene: verdict, numbers, assumptions, pictures.
    Report(report::Arguments),
    /// Measure what a certificate and a tick cost.
    Bench(bench::Arguments),
    /// Show or change the parameters of a running board; it refuses what it cannot certify.
    Tune(tune::Arguments),
    /// Watch a running board, tune it, or record it.
    ///
    /// In the view t opens a line for new parameters (stiffness = 20), A arms, d disarms, q quits. Torque
    /// is the coupling torque, as in every other trace; the motor applies its negative.
    Scope(scope::Arguments),
    /// Be a board without hardware, in a simulated hand, for tune and scope to be tried on.
    Twin(twin::Arguments),
    /// What would a scene do, certified or not?
    Simulate(simulate::Arguments),
    /// Does the motion of this device in this hand die away?
    Stability(stability::Arguments),
    /// How far may one go, and what does it take? Answers are scenes that certify.
    Design(design::Arguments),
    /// How little is enough for a scene: which number format, which model of its device?
    Advise(advise::Arguments),
    /// In which passive hand does a scene oscillate?
    WorstHand(worst_hand::Arguments),
    /// What may a scene file say? Prints a JSON schema, an example, or the reference of its keys.
    Schema(schema::Arguments),
    /// Where do other methods fail, and what did the certificate say before?
    Failures(failures::Arguments),
}

/// The answer of a command that could be asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Exit status 0.
    Yes,
    /// Exit status 1: rejected, undecided, unstable, different.
    No,
}

/// Why a command has no answer; exit status 2.
#[derive(Debug, Error)]
pub enum CommandError {
    /// A bad scene file.
    #[error(transparent)]
    File(#[from] FileError),
    /// A record that identifies nothing.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// A board whose sweep gives no record.
    #[error(transparent)]
    Sweep(#[from] PortError),
    /// No program and no file of that name.
    #[error("there is no scene {name}: the programs are {programs}, and there is no such file")]
    NoScene {
        /// What was asked for.
        name: String,
        /// The programs that there are.
        programs: String,
    },
    /// No program of that name, where only a program will do.
    #[error("there is no scene {name}: the programs are {programs}")]
    NoProgram {
        /// What was asked for.
        name: String,
        /// The programs that there are.
        programs: String,
    },
    /// A scene file has no program for a twin.
    #[error(
        "{file} is a file, and a twin runs a scene's program by its name: the programs are {programs}; \
         `cargo haptic new NAME` begins one"
    )]
    FileOnTwin {
        /// The file.
        file: String,
        /// The programs that there are.
        programs: String,
    },
    /// A scene file has no program for the board.
    #[error(
        "{scene} is a scene file, which runs on the host only; a scene on the board is a program \
         of its own, in firmware/src/bin: `cargo haptic new NAME` begins one"
    )]
    FileOnBoard {
        /// The scene.
        scene: String,
    },
    /// A program for the board has its transducers built in.
    #[error(
        "the program {program} is built for {counts_per_turn} counts a turn and {full_scale} N m \
         at full scale; change its TRANSDUCERS, or run it on the host"
    )]
    OtherTransducers {
        /// The program.
        program: &'static str,
        /// Its encoder's counts a turn.
        counts_per_turn: f64,
        /// Its motor's torque at full scale in N m.
        full_scale: f64,
    },
    /// The certificate refuses the scene; exit status 1, for the question was good.
    #[error("{0}")]
    Refused(Box<Rejection>),
    /// The servo cannot be built of the certified scene.
    #[error(transparent)]
    Servo(#[from] firmware::servo::BuildError),
    /// An angle does not fit the servo's number format.
    #[error("the device's angle: {0}")]
    Angle(#[from] firmware::number::OutOfRange),
    /// A number of the scene does not fit the number format.
    #[error(transparent)]
    Number(#[from] crate::number::DoesNotFit),
    /// A bad recording.
    #[error(transparent)]
    Replay(#[from] TableError),
    /// A bad record of a run.
    #[error(transparent)]
    Recorded(#[from] RecordedError),
    /// The machine cannot build or run programs for the board.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A program does not build.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A program could not be flashed.
    #[error(transparent)]
    Probe(#[from] crate::toolchain::probe::ProbeError),
    /// A run failed.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The emulated board failed.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The emulated board computes something else.
    #[error(
        "in {format} the torque of the emulated board is not that of this machine at tick {tick}: \
         its program is of another version"
    )]
    Differs {
        /// The number format.
        format: &'static str,
        /// The tick, counted from 0.
        tick: usize,
    },
    /// A set could not be measured on the emulated board.
    #[error(transparent)]
    Live(#[from] crate::bench::live::LiveError),
    /// A picture could not be drawn.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// No map can be drawn.
    #[error(transparent)]
    Map(#[from] crate::map::MapError),
    /// The scene is certified at no sample rate, however soft its wall.
    #[error(
        "{scene}: no stiffness is certified at any of these sample rates; its damping alone, or \
         what its canceller takes away, is more than the device has"
    )]
    NoStiffness {
        /// Name of the scene.
        scene: String,
    },
    /// One file cannot have the pictures of all topics.
    #[error("{}: one picture shows one topic; name one of {topics}", picture.display())]
    NoTopic {
        /// The file.
        picture: PathBuf,
        /// What there is.
        topics: String,
    },
    /// A table has no such panel.
    #[error("there is no {what} `{word}`; there are {there}")]
    NoPanel {
        /// Case or error.
        what: &'static str,
        /// What was asked for.
        word: String,
        /// What there is.
        there: String,
    },
    /// A table that is to be drawn has not been measured.
    #[error(
        "{}: there is no such table; --draw-only reads the tables from the folder of -o, or the kept \
         ones without -o", table.display()
    )]
    NothingKept {
        /// The table's file.
        table: PathBuf,
    },
    /// A picture that does not show all of a run; exit status 1, for it shows the rest.
    #[error(
        "the run grows beyond what a picture can show: sample {sample} and all after it are left \
         out"
    )]
    LeftOut {
        /// The first sample, counted from 0, that is not shown.
        sample: usize,
    },
    /// The date of a page is none.
    #[error(transparent)]
    Date(#[from] crate::date::NoDate),
    /// A page's file must be called one.
    #[error("{path}: the name of a page must end in .html")]
    NoPage {
        /// The file.
        path: PathBuf,
    },
    /// A file or folder could not be written.
    #[error("{path}: {source}")]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A scene that cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A simulated device that leaves; exit status 1, for what it does is the answer.
    #[error(
        "the motion runs away: from sample {sample} on, at {} s, the device is more than {} rad from \
         its zero; the loop is most likely not stable (`haptic stability`)",
        significant(*.time, 6), significant(*.farthest, 6)
    )]
    RanAway {
        /// The angle in rad that it has left behind.
        farthest: f64,
        /// The first sample, counted from 0, that is farther.
        sample: usize,
        /// When that is in s.
        time: f64,
    },
    /// A case of failure could not be shown.
    #[error(transparent)]
    Failure(#[from] crate::failures::FailureError),
    /// Models of a device that cannot be compared.
    #[error(transparent)]
    Model(#[from] crate::model::ModelError),
    /// A design asks for what the environment does not have.
    #[error("the environment of {scene} has no {quantity}")]
    NoSuchQuantity {
        /// Name of the scene.
        scene: String,
        /// What was asked for.
        quantity: &'static str,
    },
    /// A parameter was given two values.
    #[error(transparent)]
    Twice(#[from] crate::link::change::Twice),
    /// A board cannot be talked to.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Nobody can be listened to there.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: Address,
        /// Why.
        source: io::Error,
    },
    /// A board without hardware has ended by itself.
    #[error(transparent)]
    Twin(#[from] TwinError),
    /// A virtual board that did not start.
    #[error(transparent)]
    VirtualBoard(#[from] VirtualBoardError),
    /// The answer could not be written.
    #[error("cannot write the answer: {0}")]
    Output(#[from] io::Error),
}

impl CommandError {
    /// Whether the question was good and this is its answer.
    fn is_a_no(&self) -> bool {
        matches!(
            self,
            Self::Refused(_)
                | Self::LeftOut { .. }
                | Self::RanAway { .. }
                | Self::Simulation(SimulationError::Overflow { .. })
        )
    }
}

/// Runs one command and turns its answer into the exit status.
pub fn execute(arguments: Arguments) -> ExitCode {
    let answer = match arguments.command {
        ref command if let Some(scene) = own::scene_of(command) => own::hand_over(&scene),
        Command::Certify(arguments) => certify::run(&arguments),
        Command::Device(arguments) => device::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Flash(arguments) => flash::run(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Chart(arguments) => chart::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Tune(arguments) => tune::run(&arguments),
        Command::Scope(arguments) => scope::run(&arguments),
        Command::Twin(arguments) => twin::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Stability(arguments) => stability::run(&arguments),
        Command::Design(arguments) => design::run(&arguments),
        Command::Advise(arguments) => advise::run(&arguments),
        Command::WorstHand(arguments) => worst_hand::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Failures(arguments) => failures::run(&arguments),
    };
    status(answer).into()
}

/// The exit status of an answer, all of which must have been written.
fn status(answer: Result<Answer, CommandError>) -> u8 {
    let written = || io::stdout().flush().map_err(CommandError::Output);
    match answer.and_then(|answer| written().map(|()| answer)) {
        Ok(Answer::Yes) => 0,
        Ok(Answer::No) => 1,
        // Whoever reads the answer has seen enough of it: `haptic ... | head` is no error.
        Err(CommandError::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => 0,
        Err(error) => {
            complain(&error);
            if error.is_a_no() { 1 } else { 2 }
        }
    }
}

/// A time on the command line.
fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().map_err(|_| format!("`{text}` is no number of seconds"))?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(duration) if !duration.is_zero() => Ok(duration),
        _ => Err(format!("`{text}` must be a number of seconds greater than 0")),
    }
}

fn complain(error: &CommandError) {
    let stderr = io::stderr();
    let (colour, width) = (terminal::has_colour(stderr.is_terminal()), terminal::error_width());
    let text = match error {
        CommandError::File(error) => error.report_within(colour, width),
        other => terminal::wrapped(&format!("error: {other}"), width, 7),
    };
    // Nobody is left to be told if this fails.
    let _ = writeln!(stderr.lock(), "{text}");
}
