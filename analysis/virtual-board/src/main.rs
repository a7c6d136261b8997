//! A virtual board for another program, in lockstep with the process at standard input and output:
//! `virtual-board BOARD PROGRAM.elf` for a program that drives a DAC, and with a motor behind it,
//! `WINDING RESISTANCE INDUCTANCE TORQUE_CONSTANT SUPPLY CAPACITANCE`, for a program that drives the board's
//! own bridge: `brushed` or the number of pole pairs, ohm, H, N m/A, V, and F or `sinks` for a supply that takes
//! energy back.
//!
//! All numbers are little-endian. At the end of each sample the board writes the sample, and waits for the
//! reply:
//!
//! | board | bytes | | world | bytes |
//! |---|---|---|---|---|
//! | 1 | 1 | | counts that the encoder turned by | 4 |
//! | code of the DAC, 65535 for none | 2 | | 1: a magnetic encoder's transfers fail from now on | 1 |
//! | 1: the amplifier is on | 1 | | length of what follows | 2 |
//! | length of what follows | 2 | | bytes for the serial port | |
//! | bytes that the serial port sent | | | | |
//!
//! With a bridge, the world gets the motor's torque at the end of each period of the modulation, so that the
//! shaft moves within a period of the servo, as its back-EMF and the count of the current loop do:
//!
//! | board | bytes | | world | bytes |
//! |---|---|---|---|---|
//! | 2 | 1 | | counts that the encoder turned by | 4 |
//! | mean torque in N m, a double | 8 | | angle in rad, a double | 8 |
//! | length in s, a double | 8 | | speed in rad/s, a double | 8 |
//! | | | | 1: the transfers fail from now on | 1 |
//!
//! The message of a sample then comes at the beginning of the servo's period. Its code is the servo's, which
//! the current loop follows from there on; its fourth byte is 1 while the servo drives the gates, and 2 while
//! an alignment does.
//!
//! Once the input ends, the board writes a 0, then how many there were and the least, the most and
//! the sum of the instructions from count to code and of the servo's whole interrupt (8 bytes each),
//! then the number of resets (4), and the rest is the log, line by line. A bridge's code is in
//! memory, and nothing is counted up to it.
//!
//! A board that cannot continue writes the reason to standard error, and ends with a failure.

mod host_link;
mod wired_motor;

use std::io::{self, BufWriter, Write};
use std::process::ExitCode;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use virtual_board::bridge_memory::BridgeMemory;
use virtual_board::chip::Chip;
use virtual_board::device::{Device, Motion};
use virtual_board::machine::{ENCODER, Machine};
use virtual_board::magnetic_encoder::MagneticEncoder;
use virtual_board::meter::InstructionStats;

use host_link::{Drive, HostLink};

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [board, elf, motor @ ..] = arguments.as_slice() else {
        return Err("usage: virtual-board BOARD PROGRAM.elf [MOTOR]".into());
    };
    let Some(chip) = Chip::find(board) else {
        let names = Chip::BOARDS.map(|chip| chip.name).join(", ");
        return Err(format!("there is no virtual board {board}; there are {names}").into());
    };
    let host = Arc::new(Mutex::new(HostLink::new()));
    let mut machine = if motor.is_empty() {
        let mut machine = Machine::boot(elf.as_ref(), chip, Box::new(DacPlant(host.clone())))?;
        connect_encoder(&mut machine)?;
        while step(&mut machine, &host)?.is_none() {}
        machine
    } else {
        let mut machine = Machine::boot(elf.as_ref(), chip, Box::new(Shaft(host.clone())))?;
        let memory = wire(&mut machine, motor)?;
        connect_encoder(&mut machine)?;
        while bridge_step(&mut machine, &memory, &host)?.is_none() {}
        machine
    };
    Ok(report(&mut machine)?)
}

/// Connects a motor to the bridge; returns the addresses of the program's state.
fn wire(machine: &mut Machine, motor: &[String]) -> Result<BridgeMemory, Failure> {
    let Ok(words) = motor.try_into() else {
        let wanted = "WINDING RESISTANCE INDUCTANCE TORQUE_CONSTANT SUPPLY CAPACITANCE";
        return Err(format!("a motor has six words, {wanted}, and not {}", motor.len()).into());
    };
    let (motor, supply) = wired_motor::parse(words)?;
    let board = machine.board_mut();
    if board.chip().gates.is_none() {
        return Err(format!("the board {} has no bridge", board.chip().name).into());
    }
    let circuit = &mut board.power_stage.circuit;
    (circuit.motor, circuit.supply) = (Some(motor), supply);
    BridgeMemory::of(machine.image()).ok_or_else(|| "the program does not drive the bridge".into())
}

/// Connects the magnetic encoder that the program reads, if it reads one, with its zero at the device's.
fn connect_encoder(machine: &mut Machine) -> Result<(), Failure> {
    const NAME_BYTES: usize = 8;
    let Some(setup) = machine.image().symbol(ENCODER) else { return Ok(()) };
    let bytes = machine.core().memory(setup, NAME_BYTES).unwrap_or_default();
    let name = String::from_utf8_lossy(&bytes);
    let name = name.trim_end_matches('\0');
    let chip = MagneticEncoder::find(name, 0);
    let mut chip =
        chip.ok_or_else(|| format!("there is no virtual chip {name:?} for this program"))?;
    chip.is_prompt = true;
    machine.board_mut().magnetic = Some(chip);
    Ok(())
}

fn locked(host: &Mutex<HostLink>) -> MutexGuard<'_, HostLink> {
    host.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs a sample, with the bytes of the serial port; returns the end once the host has closed its end.
fn step(machine: &mut Machine, host: &Mutex<HostLink>) -> Result<Option<()>, Failure> {
    machine.run_samples(1)?;
    carry_bytes(machine, &mut locked(host));
    Ok(locked(host).end().transpose()?)
}

/// The same up to the beginning of a period of the servo, where its code is taken over.
fn bridge_step(
    machine: &mut Machine,
    memory: &BridgeMemory,
    host: &Mutex<HostLink>,
) -> Result<Option<()>, Failure> {
    machine.run_samples(1)?;
    if let Some(end) = locked(host).end() {
        return Ok(Some(end?));
    }
    let is_on = machine.board().power_stage.timer.is_on();
    let drive = match memory.is_aligning(machine.core()) {
        Some(true) => Drive::Aligning,
        _ if is_on => Drive::On,
        _ => Drive::Off,
    };
    let turned = locked(host).sample(memory.code(machine.core()), drive);
    machine.board_mut().turn_encoder(turned);
    carry_bytes(machine, &mut locked(host));
    Ok(locked(host).end().transpose()?)
}

fn carry_bytes(machine: &mut Machine, host: &mut HostLink) {
    let board = machine.board_mut();
    board.send(&std::mem::take(&mut host.to_board));
    host.from_board.extend(board.serial.take_sent());
}

/// Writes the measurements to standard output.
fn report(machine: &mut Machine) -> io::Result<()> {
    let mut output = BufWriter::new(io::stdout());
    output.write_all(&[0])?;
    let meter = &machine.board().meter;
    for stats in [meter.compute(), meter.interrupt()] {
        let InstructionStats { count, least, most, sum } = stats;
        for number in [count, least, most, sum] {
            output.write_all(&number.to_le_bytes())?;
        }
    }
    let resets = u32::try_from(machine.resets().len()).unwrap_or(u32::MAX);
    output.write_all(&resets.to_le_bytes())?;
    for line in machine.log() {
        writeln!(output, "{line}")?;
    }
    output.flush()
}

/// The device behind a DAC, which the host simulates.
struct DacPlant(Arc<Mutex<HostLink>>);

impl Device for DacPlant {
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32 {
        locked(&self.0).sample(code, if amplifier { Drive::On } else { Drive::Off })
    }

    fn readings_fail(&self) -> bool {
        locked(&self.0).readings_fail
    }
}

/// The shaft of the bridge's motor, which the host simulates.
struct Shaft(Arc<Mutex<HostLink>>);

impl Device for Shaft {
    fn sample(&mut self, _: Option<u16>, _: bool) -> i32 {
        0
    }

    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        locked(&self.0).turn(torque, seconds)
    }

    fn readings_fail(&self) -> bool {
        locked(&self.0).readings_fail
    }
}
