//! Simulated boards: as threads of a test, and as processes of the program.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::process::{Child, Output, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use analysis::board_sim::{Pacing, SimulatedBoard};
use analysis::link::{Address, Link};
use analysis::lockstep::PlantIo;
use analysis::program::Program;
use tempfile::TempDir;

use super::{haptic, program};

/// A board that is a thread, and the folder with its socket.
pub struct Rig {
    pub board: SimulatedBoard,
    pub folder: TempDir,
}

impl Rig {
    /// The board of a program just after it is switched on.
    pub fn start(program: &str, device: impl PlantIo + Send + 'static, pacing: Pacing) -> Self {
        let folder = TempDir::new().unwrap();
        let address = Address::Unix(folder.path().join("board"));
        let program = Program::find(program).unwrap();
        let board = program.listen(Box::new(device), &address, pacing).unwrap();
        Self { board, folder }
    }

    pub fn port(&self) -> String {
        self.board.address().to_string()
    }

    pub fn link(&self) -> Link {
        Link::open(self.board.address()).unwrap()
    }

    /// Runs a command of the program with its port.
    pub fn haptic(&self, arguments: &[&str]) -> Output {
        with_port(&self.port(), arguments)
    }
}

fn with_port(port: &str, arguments: &[&str]) -> Output {
    let (command, rest) = arguments.split_first().unwrap();
    haptic(&[&[*command, "--port", port], rest].concat())
}

/// A device that is held still at a count.
pub struct Still(pub i32);

impl PlantIo for Still {
    fn count(&mut self) -> Option<i32> {
        Some(self.0)
    }

    fn hold(&mut self, _: u16) {}
}

/// The codes that a motor receives.
#[derive(Clone, Default)]
pub struct Codes(Arc<Mutex<Received>>);

#[derive(Default)]
struct Received {
    ticks: u64,
    last: u16,
    seen: BTreeSet<u16>,
}

impl Codes {
    pub fn receive(&self, code: u16) {
        let mut codes = self.0.lock().unwrap();
        codes.ticks += 1;
        codes.last = code;
        codes.seen.insert(code);
    }

    /// All since they were last forgotten.
    pub fn seen(&self) -> BTreeSet<u16> {
        self.0.lock().unwrap().seen.clone()
    }

    pub fn forget(&self) {
        self.0.lock().unwrap().seen.clear();
    }

    /// The code after this many more ticks.
    pub fn after(&self, ticks: u64) -> u16 {
        let (start, end) = (Instant::now(), self.0.lock().unwrap().ticks + ticks);
        loop {
            let codes = self.0.lock().unwrap();
            if codes.ticks >= end {
                return codes.last;
            }
            drop(codes);
            assert!(start.elapsed() < Duration::from_secs(60), "the board has ended");
            std::thread::yield_now();
        }
    }
}

/// A process that ends with the test.
pub struct Running(pub Child);

impl Running {
    /// Starts the program; returns the first line that it prints, too.
    pub fn start(arguments: &[&str]) -> (Self, String) {
        let mut child = program(arguments).stdout(Stdio::piped()).spawn().unwrap();
        let (mut line, mut said) = (String::new(), BufReader::new(child.stdout.take().unwrap()));
        said.read_line(&mut line).unwrap();
        child.stdout = Some(said.into_inner());
        (Self(child), line.trim().to_owned())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A board that is a process of the program, and where it listens.
pub struct BoardProcess {
    pub running: Running,
    pub port: String,
    _folder: TempDir,
}

impl BoardProcess {
    /// The board of a scene's program, with more options.
    pub fn start(scene: &str, options: &[&str]) -> Self {
        let folder = TempDir::new().unwrap();
        let port = format!("unix:{}", folder.path().join("board").display());
        let running = Self::at(&port, scene, options);
        Self { running, port, _folder: folder }
    }

    /// The same at a port.
    pub fn at(port: &str, scene: &str, options: &[&str]) -> Running {
        let arguments = [&["board-sim", scene, "--port", port], options].concat();
        let (running, said) = Running::start(&arguments);
        assert_eq!(said, format!("{scene} listens on {port}"));
        running
    }

    /// Runs a command of the program with its port.
    pub fn haptic(&self, arguments: &[&str]) -> Output {
        with_port(&self.port, arguments)
    }
}
