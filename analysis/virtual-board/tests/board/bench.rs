//! A virtual board with everything around it that a test looks at.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock};
use std::thread;

use analysis::link::{Message, frame};
use analysis::program::Program;
use analysis::toolchain::{BoardModel, NumberFormat, Tools, TorqueOutput, prepare};
use haptic_servo::dac::DacCode;
use haptic_servo::fault::Fault;
use haptic_servo::wire::message::{
    FaultCode, Id, LONGEST_TO_HOST, Outcome, PreviousFault, Status, ToBoard,
};
use haptic_servo::wire::{CHECKSUM, Decoder};
use virtual_board::board::{Event, VirtualBoard};
use virtual_board::chip::Chip;
use virtual_board::device::{Device, FixedDevice};
use virtual_board::machine::Machine;
use virtual_board::peripheral::pins::Level;

use crate::device::Pins;

/// The code that gives no torque.
pub const MID_SCALE: u16 = DacCode::MID_SCALE.get();

/// Does a test on both chips at the same time; gives what each gave.
pub fn on_both<T: Send>(test: impl Fn(&'static Chip) -> T + Sync) -> [T; 2] {
    let test = &test;
    thread::scope(|scope| {
        let begin = |chip: &'static Chip| {
            let thread = thread::Builder::new().name(chip.name.into());
            thread.spawn_scoped(scope, move || test(chip)).unwrap()
        };
        Chip::ALL.map(begin).map(|thread| thread.join().expect("it was not so on this chip"))
    })
}

/// The file of a program for a chip. All of them are built when the first is asked for.
pub fn program(chip: &'static Chip, name: &'static str) -> &'static PathBuf {
    static FILES: OnceLock<HashMap<(&str, &str), PathBuf>> = OnceLock::new();
    let files = FILES.get_or_init(|| {
        let build = |chip: &'static Chip| {
            let names: Vec<_> = Program::every().map(|program| program.name).collect();
            let built = build(chip, &names);
            names.into_iter().zip(built).map(move |(name, path)| ((chip.name, name), path))
        };
        Chip::ALL.into_iter().flat_map(build).collect()
    });
    &files[&(chip.name, name)]
}

/// The files of some programs for any chip, whose torque is the DAC's.
pub fn build(chip: &'static Chip, names: &[&str]) -> Vec<PathBuf> {
    build_for(chip, TorqueOutput::Dac, names)
}

/// The same with any output.
pub fn build_for(chip: &'static Chip, output: TorqueOutput, names: &[&str]) -> Vec<PathBuf> {
    let toolchain = prepare(Tools::Compiler);
    let toolchain = toolchain.unwrap_or_else(|error| panic!("{error}"));
    let board = BoardModel::find(chip.name).unwrap();
    let built = toolchain.build_for(board, output, names, NumberFormat::F32);
    built.unwrap_or_else(|error| panic!("{error}")).into_iter().map(|built| built.path).collect()
}

/// A board with its power on, the device at its pins, and a host at its serial port.
pub struct Bench {
    /// The board.
    pub machine: Machine,
    pins: Arc<Mutex<Pins>>,
    decoder: Decoder<{ LONGEST_TO_HOST + CHECKSUM }>,
    last_id: Id,
}

impl Bench {
    /// Switches a board on that has a program in its flash.
    pub fn boot(
        chip: &'static Chip,
        name: &'static str,
        device: impl Device + Send + 'static,
    ) -> Self {
        Self::boot_file(chip, program(chip, name), device)
    }

    /// The same with a program's file.
    pub fn boot_file(
        chip: &'static Chip,
        file: &Path,
        device: impl Device + Send + 'static,
    ) -> Self {
        let pins = Arc::new(Mutex::new(Pins::of(device)));
        let mut machine = Machine::boot(file, chip, Box::new(pins.clone())).unwrap();
        machine.board_mut().events = Some(Vec::new());
        Self { machine, pins, decoder: Decoder::new(), last_id: 0 }
    }

    /// The same with a device that stands still, armed and run until the scene is felt: the clamp is
    /// open.
    pub fn running(chip: &'static Chip, name: &'static str) -> Self {
        /// More than the tenth of a second in which it opens.
        const OPEN: u64 = 110;
        let mut bench = Self::boot(chip, name, FixedDevice);
        bench.armed();
        bench.run(OPEN);
        bench
    }

    /// The board.
    pub fn board(&self) -> &VirtualBoard {
        self.machine.board()
    }

    /// The board, to do something to it from outside.
    pub fn board_mut(&mut self) -> &mut VirtualBoard {
        self.machine.board_mut()
    }

    /// Instructions since power-on.
    pub fn now(&self) -> u64 {
        self.board().now
    }

    /// Whether the outputs of the power stage are on.
    pub fn is_on(&self) -> bool {
        self.board().power_stage.timer.is_on()
    }

    /// Turns the encoder in one sample, after those that are still to come.
    pub fn turn(&mut self, counts: i32) {
        self.pins().turns.push_back(counts);
    }

    /// What the DAC put out in the last sample.
    pub fn last_code(&self) -> Option<u16> {
        self.pins().samples.last().and_then(|sample| sample.code)
    }

    /// The device at the pins.
    pub fn pins(&self) -> MutexGuard<'_, Pins> {
        self.pins.lock().unwrap()
    }

    /// Instructions in a period of the servo: a thousandth of a second in all programs, as nearly as
    /// the timer can pace it.
    pub fn period(&self) -> u64 {
        let board = self.board();
        board.tick_timer.period(board.clock.timer_divider())
    }

    /// Runs so many samples.
    pub fn run(&mut self, samples: u64) {
        self.machine.run_samples(samples).unwrap_or_else(|error| panic!("{error}"));
    }

    /// Runs some samples at a time until something is so, at most so many; whether it is.
    pub fn run_until(&mut self, step: u64, most: u64, is_so: impl Fn(&mut Self) -> bool) -> bool {
        (0..most / step).any(|_| {
            let is_so = is_so(self);
            if !is_so {
                self.run(step);
            }
            is_so
        })
    }

    /// Runs so many instructions.
    pub fn run_for(&mut self, instructions: u64) {
        self.machine.run_for(instructions).unwrap_or_else(|error| panic!("{error}"));
    }

    /// Runs to the next update of the pacing timer, which comes before the next instruction.
    pub fn run_to_update(&mut self) {
        let board = self.board();
        let due = board.tick_timer.due().unwrap();
        self.run_for(due - board.now);
    }

    /// Turns the encoder by some counts, and runs to where the code for that is written and waits for its
    /// trigger, in the servo's interrupt.
    pub fn run_to_waiting_code(&mut self, turn: i32) {
        self.turn(turn);
        self.run_to_update();
        let waits =
            |board: &VirtualBoard| board.dac.output().is_some_and(|code| code != board.dac.held());
        while !waits(self.machine.board()) {
            self.run_for(1);
        }
    }

    /// What happened at the pins so far, with the time.
    pub fn events(&self) -> &[(u64, Event)] {
        self.machine.board().events.as_deref().unwrap()
    }

    /// Codes that were put out after a time, each where it differs from the one before.
    pub fn torques_after(&self, from: u64) -> impl Iterator<Item = u16> {
        self.events().iter().filter_map(move |&(at, event)| match event {
            Event::Torque(code) if at > from => code,
            _ => None,
        })
    }

    /// When the amplifier's line was first not high from a time on; none where it still is.
    pub fn amplifier_off(&self, from: u64) -> Option<u64> {
        let off = |(at, event): &(u64, Event)| match event {
            Event::Amplifier(level) if *level != Level::High && *at >= from => Some(*at),
            _ => None,
        };
        self.events().iter().find_map(off)
    }

    /// When the amplifier's line was first high, if it ever was.
    pub fn amplifier_on(&self) -> Option<u64> {
        let on =
            |(at, event): &(u64, Event)| (*event == Event::Amplifier(Level::High)).then_some(*at);
        self.events().iter().find_map(on)
    }

    /// Address and size of what a program has under a name, of which this is the end.
    pub fn symbol(&self, end: &str) -> (u32, u32) {
        self.machine.image().symbol_ending(end).unwrap_or_else(|| panic!("there is no {end}"))
    }

    /// Says something to the board.
    pub fn say(&mut self, message: &ToBoard) {
        self.board_mut().send(&frame(message));
    }

    /// What the board has said since the last time.
    pub fn hear(&mut self) -> Vec<Message> {
        let bytes = self.board_mut().serial.take_sent();
        bytes.into_iter().filter_map(|byte| self.decoder.push(byte)).collect()
    }

    /// Asks, and runs until the board gives an answer that is wanted.
    pub fn ask<T>(&mut self, question: &ToBoard, wanted: impl Fn(Message) -> Option<T>) -> T {
        /// Samples: a second.
        const TIMEOUT: u32 = 1000;
        self.hear();
        self.say(question);
        for _ in 0..TIMEOUT {
            self.run(1);
            if let Some(answer) = self.hear().into_iter().find_map(&wanted) {
                return answer;
            }
        }
        panic!("the board does not answer {question:?}")
    }

    /// How the board says that it is.
    pub fn status(&mut self) -> Status {
        self.ask(&ToBoard::Status, |message| match message {
            Message::Status(status) => Some(status),
            _ => None,
        })
    }

    /// The fault that the board says it has.
    pub fn fault(&mut self) -> Option<Fault> {
        self.status().fault.and_then(FaultCode::fault)
    }

    /// Asks for something; gives the outcome.
    pub fn request(&mut self, message: impl FnOnce(Id) -> ToBoard) -> Outcome {
        self.last_id = self.last_id.wrapping_add(1);
        let id = self.last_id;
        self.ask(&message(id), |message| match message {
            Message::Answer { id: answered, outcome } if answered == id => Some(outcome),
            _ => None,
        })
    }

    /// Asks for the amplifier to be switched on.
    pub fn arm(&mut self) -> Outcome {
        self.request(|id| ToBoard::Arm { id })
    }

    /// Has it switched on; gives the tick in which it was.
    pub fn armed(&mut self) -> usize {
        // The port is open before the first sample.
        self.run(1);
        assert_eq!(self.arm(), Outcome::Done);
        // On at the end of the sample that began with that tick.
        let on = self.pins().samples.iter().position(|sample| sample.amplifier);
        on.expect("the amplifier is on") - 1
    }

    /// What the board says that stopped it before it was last started.
    pub fn previous_fault(&mut self) -> Option<PreviousFault> {
        // The next message shows that there is none.
        let mut previous_fault = None;
        self.say(&ToBoard::Hello);
        for _ in 0..20 {
            self.run(1);
            for message in self.hear() {
                match message {
                    Message::PreviousFault(record) => previous_fault = Some(record),
                    Message::Board(_) => return previous_fault,
                    _ => {}
                }
            }
        }
        panic!("the board does not greet")
    }

    /// The log so far, as lines.
    pub fn log(&mut self) -> Vec<String> {
        self.machine.log()
    }
}
