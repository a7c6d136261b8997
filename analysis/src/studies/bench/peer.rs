//! A peer: another program that does the same work and measures its time, a line for each request.

use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use thiserror::Error;

/// The reason why there is no peer in this run.
#[derive(Debug, Error)]
pub enum PeerError {
    /// Its compiler, interpreter or package is missing.
    #[error("{0}")]
    Unavailable(String),
    /// It has ended, or cannot be reached.
    #[error("a peer of the benchmark ended: {0}")]
    Ended(#[from] io::Error),
    /// It answered something else, or computes other numbers: its work is not equal.
    #[error("a peer of the benchmark answered {0}")]
    Wrong(String),
}

/// The beginning of the answer of a peer whose package is missing.
const UNAVAILABLE: &str = "unavailable: ";

/// A running peer.
#[derive(Debug)]
pub struct Peer {
    child: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts a program and sends it the line that describes the work.
    ///
    /// # Errors
    /// If it cannot be started.
    pub fn start(command: &mut Command, work: &str) -> Result<Self, PeerError> {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (mut requests, answers) = pipes.ok_or_else(|| io::Error::other("without pipes"))?;
        writeln!(requests, "{work}")?;
        Ok(Self { child, requests, answers: BufReader::new(answers) })
    }

    /// The answer to a request.
    ///
    /// # Errors
    /// If the peer has ended, or lacks a package.
    pub fn ask(&mut self, request: &str) -> Result<String, PeerError> {
        writeln!(self.requests, "{request}")?;
        let mut answer = String::new();
        if self.answers.read_line(&mut answer)? == 0 {
            return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
        }
        let answer = answer.trim_end();
        match answer.strip_prefix(UNAVAILABLE) {
            Some(why) => Err(PeerError::Unavailable(why.to_owned())),
            None => Ok(answer.to_owned()),
        }
    }

    /// The numbers of an answer.
    ///
    /// # Errors
    /// As of [`Self::ask`]; also if it has something else than numbers.
    pub fn numbers(&mut self, request: &str) -> Result<Vec<f64>, PeerError> {
        let answer = self.ask(request)?;
        let numbers: Result<_, _> = answer.split_whitespace().map(str::parse).collect();
        numbers.map_err(|_| PeerError::Wrong(format!("{answer:?} to {request:?}")))
    }

    /// The first number of an answer.
    ///
    /// # Errors
    /// As of [`Self::numbers`]; also if there is none.
    pub fn number(&mut self, request: &str) -> Result<f64, PeerError> {
        let first = self.numbers(request)?.first().copied();
        first.ok_or_else(|| PeerError::Wrong(format!("no number to {request:?}")))
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It waits for requests, and has nothing to lose.
        self.child.kill().ok();
        self.child.wait().ok();
    }
}
