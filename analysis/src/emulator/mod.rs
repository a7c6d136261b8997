//! A scene's program on the emulated board, in lockstep with this process.
//!
//! For each tick the board takes one count and returns one DAC code, through two pipes in the emulator's own
//! folder; the board's log comes through the emulator's standard output. A guest that does not answer within
//! [`TIMEOUT`] is an error, and the emulator is always ended.

mod client;
mod pipes;
pub mod plant_thread;
mod report;

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use haptic_model::board::client::frame;
use haptic_servo::board::lockstep_protocol::{TickInput, TickOutput};
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::ToBoard;
use tempfile::TempDir;

pub use client::Client;
pub use report::{Calibration, CertificateBits, EmulatorReport, InstructionStats};

use crate::toolchain::{QEMU, emulator};
use pipes::Pipes;

/// The arguments of the emulated board. With `icount` each instruction takes 32 ns of the board's time,
/// independently of the host's load.
const BOARD: [&str; 12] = [
    "-machine",
    "netduinoplus2",
    "-display",
    "none",
    "-monitor",
    "none",
    "-serial",
    "unix:serial,server=on,wait=off",
    "-icount",
    "shift=5,sleep=off",
    "-semihosting-config",
    "enable=on,target=native",
];

/// Default timeout of the board for one answer. Its start takes at most a second; the rest is for a busy
/// host.
pub const TIMEOUT: Duration = Duration::from_secs(60);

/// Ticks within which a servo must have opened its clamp: more than the fading of any scene.
const LONGEST_FADING: usize = 100_000;

/// A running emulator.
pub struct Emulator {
    guest: Guest,
    /// Number of the last tick.
    number: u16,
}

/// Errors of an emulated board.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum EmulatorError {
    #[error("{QEMU} could not be started: {0}; `cargo demo` installs it or says how")]
    Start(#[source] io::Error),
    #[error("the pipe to the emulated board: {0}")]
    Pipe(#[source] io::Error),
    #[error("{path}: {source}")]
    Program { path: PathBuf, source: io::Error },
    #[error("the emulated board has not answered for {} s, {what}; its log: {log}", .after.as_secs())]
    Silent { what: &'static str, after: Duration, log: String },
    #[error("the emulator ended with {status}, {what}; its log: {log}")]
    Ended { status: ExitStatus, what: &'static str, log: String },
    #[error(
        "the servo of the emulated board was told to arm, but is not running after \
         {LONGEST_FADING} ticks; at a high rate it may have no time for its serial port: \
         `--target board:NAME` runs the flashed program at each rate"
    )]
    NotArmed,
    #[error("the emulated board's serial port: {0}")]
    Serial(#[source] io::Error),
    #[error("malformed reply from the emulated board: its program has another version")]
    NoReply,
    #[error(
        "the emulated board has no benchmark program for this scene: it has programs for a spring \
         or a damper wall at zero, a one-sided damper wall anywhere, and free mode, each one \
         sample late"
    )]
    NoBenchProgram,
    #[error("the board's log has no number {key} in a line of {line}; the log: {log}")]
    NoNumber { line: String, key: String, log: String },
}

impl Emulator {
    /// Starts a scene's program. A program that refuses to run is detected at the first
    /// [`exchange`](Self::exchange).
    pub fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        Ok(Self { guest: Guest::boot(elf)?, number: 0 })
    }

    /// The same with another timeout.
    #[must_use]
    pub fn with_timeout(mut self, timeout: Duration) -> Self {
        self.guest.timeout = timeout;
        self
    }

    /// One tick, in time: the board gets the encoder's raw count and returns its DAC code.
    pub fn exchange(&mut self, raw_count: i32) -> Result<u16, EmulatorError> {
        Ok(self.tick(TickInput { count: raw_count.cast_unsigned(), missed: 0 })?.code)
    }

    /// One tick: the board gets its input and returns its output.
    pub fn tick(&mut self, input: TickInput) -> Result<TickOutput, EmulatorError> {
        // Never 0, which is a board's number before the first input.
        self.number = self.number.checked_add(1).unwrap_or(1);
        let mut request = &input.to_bytes(self.number)[..];
        loop {
            let mut answer = [0; TickOutput::BYTES];
            self.guest.exchange(request, &mut answer)?;
            match TickOutput::from_bytes(answer) {
                Some((output, number)) if number == self.number => return Ok(output),
                // A board that faulted reports the tick again.
                Some(_) => request = &[],
                None => return Err(EmulatorError::NoReply),
            }
        }
    }

    /// The board's serial port: a socket, until the board ends.
    pub fn port(&self) -> PathBuf {
        self.guest.folder.path().join("serial")
    }

    /// Arms the servo and holds the device still at zero until its clamp is open.
    /// Returns the connection to its serial port.
    pub fn arm_and_wait(&mut self) -> Result<UnixStream, EmulatorError> {
        self.arm_and_observe(|_| ())
    }

    /// The same; `see` is called with the output of each tick.
    pub fn arm_and_observe(
        &mut self,
        mut see: impl FnMut(TickOutput),
    ) -> Result<UnixStream, EmulatorError> {
        const AT_REST: TickInput = TickInput { count: 0, missed: 0 };
        // The port is open after the first tick.
        see(self.tick(AT_REST)?);
        // Over the serial port, like any host. Kept until the board has answered, so that the next client does
        // not read this answer.
        let mut port = UnixStream::connect(self.port()).map_err(EmulatorError::Serial)?;
        port.write_all(&frame(&ToBoard::Arm { id: 0 })).map_err(EmulatorError::Serial)?;
        for _ in 0..LONGEST_FADING {
            let output = self.tick(AT_REST)?;
            see(output);
            if output.state == State::Running {
                return Ok(port);
            }
        }
        Err(EmulatorError::NotArmed)
    }

    /// Ends the run and returns the board's measurements and log.
    pub fn finish(self) -> Result<EmulatorReport, EmulatorError> {
        EmulatorReport::read(self.guest.finish()?)
    }

    /// Ends a program without a scene, and returns its log.
    pub fn end(self) -> Result<Vec<String>, EmulatorError> {
        self.guest.finish()
    }
}

/// The emulator's process with its pipes and folder; ends it when dropped.
struct Guest {
    process: Child,
    pipes: Option<Pipes>,
    log: Option<JoinHandle<Vec<String>>>,
    folder: TempDir,
    timeout: Duration,
}

impl Guest {
    fn boot(elf: &Path) -> Result<Self, EmulatorError> {
        let program = |source| EmulatorError::Program { path: elf.into(), source };
        let path = elf.canonicalize().map_err(program)?;
        let folder = TempDir::with_prefix("haptic-").map_err(EmulatorError::Pipe)?;
        let pipes = Pipes::make(folder.path()).map_err(EmulatorError::Pipe)?;
        let errors = File::create(folder.path().join(ERRORS)).map_err(EmulatorError::Pipe)?;
        let mut process = Command::new(emulator())
            .args(BOARD)
            .arg("-kernel")
            .arg(path)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(errors)
            .spawn()
            .map_err(EmulatorError::Start)?;
        let log = process.stdout.take().map(follow);
        Ok(Self { process, pipes: Some(pipes), log, folder, timeout: TIMEOUT })
    }

    /// Sends bytes to the board and waits until it has filled `answer`.
    fn exchange(&mut self, request: &[u8], answer: &mut [u8]) -> Result<(), EmulatorError> {
        const WHAT: &str = "in the middle of a run";
        let pipes = self.pipes.as_mut().expect("the pipes are open until the run is finished");
        let process = &mut self.process;
        let mut ended = || process.try_wait().map(|status| status.is_some());
        match pipes.exchange(request, answer, self.timeout, &mut ended) {
            Ok(()) => Ok(()),
            Err(error) if error.kind() == io::ErrorKind::TimedOut => Err(self.silent(WHAT)),
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Err(self.ended(WHAT)),
            Err(error) => Err(EmulatorError::Pipe(error)),
        }
    }

    /// Closes the pipe of requests, which ends the program, and returns its log.
    fn finish(mut self) -> Result<Vec<String>, EmulatorError> {
        const WHAT: &str = "at the end of a run";
        self.pipes = None;
        match self.wait().map_err(EmulatorError::Pipe)? {
            None => Err(self.silent(WHAT)),
            Some(status) if !status.success() => Err(self.ended(WHAT)),
            Some(_) => Ok(self.take_log()),
        }
    }

    /// Waits for the process for a limited time.
    fn wait(&mut self) -> io::Result<Option<ExitStatus>> {
        let deadline = Instant::now() + self.timeout;
        loop {
            match self.process.try_wait()? {
                None if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(1)),
                status => return Ok(status),
            }
        }
    }

    /// The error of a board that does not answer.
    fn silent(&mut self, what: &'static str) -> EmulatorError {
        // Its log is complete only once it has ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
        EmulatorError::Silent { what, after: self.timeout, log: self.last_words() }
    }

    /// The error of an emulator that has closed its end of a pipe.
    fn ended(&mut self, what: &'static str) -> EmulatorError {
        match self.wait() {
            Ok(Some(status)) => EmulatorError::Ended { status, what, log: self.last_words() },
            Ok(None) => self.silent(what),
            Err(error) => EmulatorError::Pipe(error),
        }
    }

    fn take_log(&mut self) -> Vec<String> {
        let unread = |_| vec!["the log could not be read".into()];
        self.log.take().map_or(Vec::new(), |log| log.join().unwrap_or_else(unread))
    }

    /// The output of board and emulator for an error's text.
    fn last_words(&mut self) -> String {
        let mut words = self.take_log();
        let errors = std::fs::read_to_string(self.folder.path().join(ERRORS)).unwrap_or_default();
        // The emulator's message, without the contents of all registers after it.
        words.extend(errors.lines().take(2).map(str::to_owned));
        if words.is_empty() { "empty".into() } else { words.join(" | ") }
    }
}

/// Reads a log until the program ends: it must be read while the program runs, because a full pipe would stop
/// the board.
fn follow(mut output: impl Read + Send + 'static) -> JoinHandle<Vec<String>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // Bytes before an error of the pipe are still a log.
        let _ = output.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect()
    })
}

/// File of the emulator's own messages, in its folder.
const ERRORS: &str = "errors";

impl Drop for Guest {
    fn drop(&mut self) {
        // Both fail only if the process has already ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
