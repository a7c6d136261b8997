//! The program's commands, one module each.

pub mod certify;

use std::io;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use thiserror::Error;

use crate::file::FileError;

/// Certifies haptic scenes, runs them, and shows what they do.
#[derive(Debug, Parser)]
#[command(
    name = "haptic",
    version,
    after_help = "Exit status: 0 yes, 1 the answer is no, 2 the question was bad."
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Is a scene safe in every hand, and by how much?
    Certify(certify::Arguments),
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
    /// The answer could not be written.
    #[error("cannot write the answer: {0}")]
    Output(#[from] io::Error),
}

/// Runs one command and turns its answer into the exit status.
pub fn run(arguments: Arguments) -> ExitCode {
    let answer = match arguments.command {
        Command::Certify(arguments) => certify::run(&arguments),
    };
    match answer {
        Ok(Answer::Yes) => ExitCode::SUCCESS,
        Ok(Answer::No) => ExitCode::FAILURE,
        // Whoever reads the answer has seen enough of it: `haptic ... | head` is no error.
        Err(CommandError::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(error) => {
            complain(&error);
            ExitCode::from(2)
        }
    }
}

fn complain(error: &CommandError) {
    use std::io::{IsTerminal, Write};
    let stderr = io::stderr();
    let colour = stderr.is_terminal();
    let text = match error {
        CommandError::File(error) => error.report(colour),
        other => format!("error: {other}"),
    };
    // Nobody is left to be told if this fails.
    let _ = writeln!(stderr.lock(), "{text}");
}
