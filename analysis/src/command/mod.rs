//! The program's commands, one module each.

mod advise;
mod batch;
mod bench;
mod board_sim;
mod building;
mod certify;
mod chart;
mod demo;
mod design;
mod device;
mod explore;
mod failures;
mod file_program;
mod file_scene;
mod flash;
mod identify;
mod new;
mod outcome;
mod output_file;
mod rebuild_with_scene;
mod run;
mod schema;
mod scope;
mod serve;
mod shared_arguments;
mod simulate;
mod stability;
mod status;
mod tune;
mod value_parsers;
mod virtual_board_build;
mod worst_hand;

use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use status::{CommandError, CommandStatus};

use crate::terminal;
use crate::text_width;

/// Certifies haptic scenes, runs them, and draws their behaviour.
#[derive(Debug, Parser)]
#[command(name = "haptic", version)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_STATUS: &str = "\
Exit status: 0 success; 1 negative verdict: rejected, undecided, unstable, different, or not possible; \
2 invalid input or failure";

impl Arguments {
    /// The arguments of the program; an error in them ends the program with a message.
    pub fn of_program() -> Self {
        // One rule for all output: clap's own rule colours a terminal without colours if `CI` is set.
        let colour = match terminal::has_colour(io::stdout().is_terminal()) {
            true => clap::ColorChoice::Always,
            false => clap::ColorChoice::Never,
        };
        let command = with_exit_status(Self::command());
        let help = help_in_groups(&command);
        let matches = command.help_template(help).color(colour).try_get_matches();
        let found = matches.and_then(|matches| Self::from_arg_matches(&matches));
        found.unwrap_or_else(|error| refuse(&error))
    }
}

/// Ends the program with the requested help, or with the error in its arguments, which clap does
/// not wrap.
fn refuse(error: &clap::Error) -> ! {
    let rendered = error.render();
    let text = |is_terminal| match terminal::has_colour(is_terminal) {
        true => rendered.ansi().to_string(),
        false => rendered.to_string(),
    };
    if !error.use_stderr() {
        let text = text(io::stdout().is_terminal());
        let said = io::stdout().write_all(text.as_bytes()).map(|()| CommandStatus::Success);
        std::process::exit(status(said.map_err(CommandError::Output)).into());
    }
    let text = text(io::stderr().is_terminal());
    // If this fails, no other output is possible.
    let _ = write!(io::stderr(), "{}", text_width::wrapped(&text, terminal::error_width(), 2));
    std::process::exit(error.exit_code())
}

fn with_exit_status(command: clap::Command) -> clap::Command {
    let after = match command.get_after_help() {
        Some(own) => format!("{own}\n\n{EXIT_STATUS}"),
        None => EXIT_STATUS.to_owned(),
    };
    command.after_help(after).mut_subcommands(with_exit_status)
}

/// Declares the commands in groups, each with its module.
macro_rules! commands {
    ($($group:literal: $($(#[$attribute:meta])* $name:ident($module:ident),)*)*) => {
        /// What to do.
        #[derive(Debug, Subcommand)]
        pub enum Command {
            $($($(#[$attribute])* $name($module::Arguments),)*)*
        }

        impl Command {
            fn run(&self) -> Result<CommandStatus, CommandError> {
                match self {
                    $($(Self::$name(arguments) => $module::run(arguments),)*)*
                }
            }
        }

        /// The groups of the help with the number of their commands.
        const GROUPS: &[(&str, usize)] = &[$(($group, [$(stringify!($name)),*].len())),*];
    };
}

commands! {
    "Design":
    /// Certify a scene: verdict, margin, assumptions and remedies.
    Certify(certify),
    /// Find the largest stiffness, the smallest device damping, the longest period or the lowest rate
    /// that certifies.
    Design(design),
    /// Find the cheapest number format, or the simplest device model, that is accurate enough.
    Advise(advise),
    /// Write a scene into one HTML page: to change it, see what changes, hold it, and send it on.
    Explore(explore),
    "Device":
    /// Compute the passivity of a device, rigid or a chain of masses.
    Device(device),
    /// Identify a device from a measurement: inertia, damping, passivity, lag and delay.
    Identify(identify),
    "Board":
    /// Run a scene's servo tick by tick: on this machine, the emulated board or a virtual board.
    Run(run),
    /// Build the program of a scene or of a scene file for a board and flash it.
    Flash(flash),
    /// Show or change the parameters of a running board, arm it or disarm it.
    Tune(tune),
    /// Show, tune or record a running board.
    ///
    /// Keys: t opens a line for new parameters (stiffness = 20), A arms, d disarms, q quits. The
    /// torque is the coupling torque, as in every trace; the motor applies its negative.
    Scope(scope),
    /// Serve a running board to a page in a browser: to tune, arm, watch and record it there.
    ///
    /// Prints the address of the page, on this machine alone, with a token that is new each time. The page is
    /// that of `haptic explore`; one page at a time has the board.
    Serve(serve),
    /// Simulate a board with device and hand, to try `tune` and `scope` without hardware.
    #[command(name = "board-sim", alias = "twin")]
    BoardSim(board_sim),
    "Analysis":
    /// Simulate a scene sample by sample, certified or not.
    Simulate(simulate),
    /// Compute the spectral radius of the loop and its critical stiffness.
    Stability(stability),
    /// Search for a passive hand in which a scene oscillates.
    WorstHand(worst_hand),
    /// Draw charts: Nyquist curves, Bode charts, maps, limits, traces.
    Chart(chart),
    /// Show loops that other methods judge wrongly, with the verdict of the certificate.
    Failures(failures),
    "Project":
    /// Copy a scene's program, or write that of a scene file, to begin a program of your own.
    New(new),
    /// Print the JSON schema of scene files, a commented example, or the reference of all keys.
    Schema(schema),
    /// Install the tools, certify all scenes, run them on the emulated board, and draw them.
    Demo(demo),
    /// Measure the cost of a certificate, a simulated step and a tick.
    Bench(bench),
}

/// The template of the program's help, with its commands in groups: clap itself has one list of them.
fn help_in_groups(command: &clap::Command) -> String {
    let mut commands = command.get_subcommands();
    let mut list = String::new();
    for (group, count) in GROUPS {
        list += &format!("{group}\n");
        for command in commands.by_ref().take(*count) {
            let about = command.get_about().map(ToString::to_string).unwrap_or_default();
            list += &format!("  {:<11} {about}\n", command.get_name());
        }
    }
    let list = text_width::wrapped(&list, terminal::output_width(), 14);
    format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\nCommands:\n{list}\nOptions:\n{{options}}{{after-help}}\n"
    )
}

impl Command {
    /// The name of a scene whose program the command may need.
    fn program(&self) -> Option<&str> {
        match self {
            Self::Run(arguments) => Some(&arguments.scene),
            // It would only be asked for its device.
            Self::Flash(arguments) if !arguments.example_device => Some(&arguments.scene),
            Self::BoardSim(arguments) => Some(&arguments.scene),
            Self::Advise(arguments) if arguments.format.is_some() => arguments.scene.as_deref(),
            _ => None,
        }
    }
}

/// Runs one command and turns its result into the exit status.
pub fn execute(arguments: Arguments) -> ExitCode {
    let command = arguments.command;
    let missing = command.program().filter(|scene| rebuild_with_scene::needs_rebuild(scene));
    status(missing.map_or_else(|| command.run(), rebuild_with_scene::rebuild_and_exec)).into()
}

/// The exit status of a result whose output is completely written.
fn status(answer: Result<CommandStatus, CommandError>) -> u8 {
    let written = || io::stdout().flush().map_err(CommandError::Output);
    match answer.and_then(|answer| written().map(|()| answer)) {
        Ok(CommandStatus::Success) => 0,
        Ok(CommandStatus::NegativeVerdict) => 1,
        // The reader closed the pipe, as in `haptic ... | head`: no error.
        Err(CommandError::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => 0,
        Err(error) => {
            print_error(&error);
            if error.is_negative_verdict() { 1 } else { 2 }
        }
    }
}

fn print_error(error: &CommandError) {
    let stderr = io::stderr();
    let (colour, width) = (terminal::has_colour(stderr.is_terminal()), terminal::error_width());
    let text = match error {
        CommandError::File(error) => error.report_within(colour, width),
        other => text_width::wrapped(&format!("error: {other}"), width, 7),
    };
    // If this fails, no other output is possible.
    let _ = writeln!(stderr.lock(), "{text}");
}
