//! A peer: another program that does the same work and measures its time, a line for each request.

use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::studies::error::StudyError;

/// The beginning of the answer of a peer whose package is missing.
const UNAVAILABLE: &str = "unavailable: ";

#[derive(Debug)]
pub struct Peer {
    child: Child,
    requests: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts a program and sends it the line that describes the work.
    pub fn start(command: &mut Command, work: &str) -> Result<Self, StudyError> {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (mut requests, answers) = pipes.ok_or_else(|| io::Error::other("without pipes"))?;
        writeln!(requests, "{work}")?;
        Ok(Self { child, requests, answers: BufReader::new(answers) })
    }

    pub fn ask(&mut self, request: &str) -> Result<String, StudyError> {
        writeln!(self.requests, "{request}")?;
        let mut answer = String::new();
        if self.answers.read_line(&mut answer)? == 0 {
            return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
        }
        let answer = answer.trim_end();
        match answer.strip_prefix(UNAVAILABLE) {
            Some(why) => Err(StudyError::NoPeer(why.to_owned())),
            None => Ok(answer.to_owned()),
        }
    }

    pub fn numbers(&mut self, request: &str) -> Result<Vec<f64>, StudyError> {
        let answer = self.ask(request)?;
        let numbers: Result<_, _> = answer.split_whitespace().map(str::parse).collect();
        numbers.map_err(|_| StudyError::WrongPeer(format!("{answer:?} to {request:?}")))
    }

    pub fn number(&mut self, request: &str) -> Result<f64, StudyError> {
        let first = self.numbers(request)?.first().copied();
        first.ok_or_else(|| StudyError::WrongPeer(format!("no number to {request:?}")))
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It waits for requests, and has nothing to lose.
        self.child.kill().ok();
        self.child.wait().ok();
    }
}
